#include "envmap/projection/matching_size.h"

#include <algorithm>
#include <cmath>

#include "envmap/base/bounds.h"
#include "envmap/projection/visit.h"

namespace envmap {

int matching_size(Projection from, int size, Projection to) {
  check_range(limits::level_height, size);
  const auto span = [](Projection p) { return visit(p, [](auto q) { return decltype(q)::span; }); };
  return std::max(1, int(std::lround(size * span(to) / span(from))));
}

}  // namespace envmap

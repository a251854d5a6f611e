#include "envmap/maths/check_direction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "envmap/base/error.h"

namespace envmap {

Direction checked_direction(std::string_view field, const Direction& d) {
  if (is_unit(d)) return d;
  const double largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
  if (!(largest > 0 && std::isfinite(d.x) && std::isfinite(d.y) && std::isfinite(d.z)))
    throw UsageError(
        fmt::format("{} must be a finite direction other than 0, not ({:g}, {:g}, {:g})", field, d.x, d.y, d.z));
  const Direction scaled = d / largest;  // Whose square is neither 0 nor infinite.
  return scaled / glm::length(scaled);
}

}  // namespace envmap

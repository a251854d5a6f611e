#include "envmap/sample/point.h"

#include <algorithm>

namespace envmap {

Colour nearest(const PaddedLevel& level, const Location<double>& at) {
  const int i = std::clamp(int(at.u * level.width()), 0, level.width() - 1);
  const int j = std::clamp(int(at.v * level.height()), 0, level.height() - 1);
  return *level.texel(at.face, i, j);
}

void sample_nearest(const PaddedLevel& level, std::span<const Location<double>> at, std::span<Colour> out) {
  for (std::size_t k = 0; k < at.size(); ++k) out[k] = nearest(level, at[k]);
}

}  // namespace envmap

#include "envmap/sample/point.h"

#include <algorithm>

namespace envmap {

Colour nearest(const PaddedLevel& level, const Location<double>& at) {
  const int i = std::clamp(int(at.u * level.width()), 0, level.width() - 1);
  const int j = std::clamp(int(at.v * level.height()), 0, level.height() - 1);
  return *level.texel(at.face, i, j);
}

Colour bicubic(const PaddedLevel& level, const Location<double>& at) {
  const double x = at.u * level.width() - 0.5, y = at.v * level.height() - 0.5;
  const double left = std::floor(x), top = std::floor(y);
  const std::array<float, 4> wx = catmull_rom<float>(x - left), wy = catmull_rom<float>(y - top);
  const Colour* rows = level.texel(at.face, int(left) - 1, int(top) - 1);
  Colour sum(0);
  for (std::size_t j = 0; j < 4; ++j) {
    const Colour* c = rows + std::ptrdiff_t(j) * level.stride();
    sum += wy[j] * (wx[0] * c[0] + wx[1] * c[1] + wx[2] * c[2] + wx[3] * c[3]);
  }
  const Colour* a = rows + level.stride() + 1;
  const Colour* b = a + level.stride();
  return glm::clamp(sum, glm::min(glm::min(a[0], a[1]), glm::min(b[0], b[1])),
                    glm::max(glm::max(a[0], a[1]), glm::max(b[0], b[1])));
}

void sample_nearest(const PaddedLevel& level, std::span<const Location<double>> at, std::span<Colour> out) {
  for (std::size_t k = 0; k < at.size(); ++k) out[k] = nearest(level, at[k]);
}

void sample_bicubic(const PaddedLevel& level, std::span<const Location<double>> at, std::span<Colour> out) {
  for (std::size_t k = 0; k < at.size(); ++k) out[k] = bicubic(level, at[k]);
}

}  // namespace envmap

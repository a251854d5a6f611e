#include "envmap/sample/bicubic.h"

#include <array>
#include <cmath>

namespace envmap {
namespace {

// Weights of the texels at -1, 0, 1 and 2 for a place t beyond the one at 0.
std::array<float, 4> catmull_rom(double t) {
  const double t2 = t * t, t3 = t2 * t;
  return {float(0.5 * (-t3 + 2 * t2 - t)), float(0.5 * (3 * t3 - 5 * t2 + 2)),
          float(0.5 * (-3 * t3 + 4 * t2 + t)), float(0.5 * (t3 - t2))};
}

}  // namespace

Colour bicubic(const PaddedLevel& level, const Location<double>& at) {
  const double x = at.u * level.width() - 0.5, y = at.v * level.height() - 0.5;
  const double left = std::floor(x), top = std::floor(y);
  const std::array<float, 4> wx = catmull_rom(x - left), wy = catmull_rom(y - top);
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

void sample_bicubic(const PaddedLevel& level, std::span<const Location<double>> at, std::span<Colour> out) {
  for (std::size_t k = 0; k < at.size(); ++k) out[k] = bicubic(level, at[k]);
}

}  // namespace envmap

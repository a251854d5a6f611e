#include "envmap/sample/point.h"

#include <algorithm>

namespace envmap {

Colour nearest(const PaddedLevel& level, const Location<double>& at) {
  const int i = std::clamp(int(at.u * level.width()), 0, level.width() - 1);
  const int j = std::clamp(int(at.v * level.height()), 0, level.height() - 1);
  return *level.texel(at.face, i, j);
}

namespace {

// Of 4 x 4 texels, at a place (x, y) beyond the second of the second row.
template <class T>
Rgb<T> catmull_rom_sum(const Colour* rows, std::ptrdiff_t stride, double x, double y) {
  const std::array<T, 4> wx = catmull_rom<T>(x), wy = catmull_rom<T>(y);
  Rgb<T> sum(0);
  for (std::size_t j = 0; j < 4; ++j) {
    const Colour* c = rows + std::ptrdiff_t(j) * stride;
    sum += wy[j] * (wx[0] * Rgb<T>(c[0]) + wx[1] * Rgb<T>(c[1]) + wx[2] * Rgb<T>(c[2]) + wx[3] * Rgb<T>(c[3]));
  }
  return sum;
}

}  // namespace

Colour bicubic(const PaddedLevel& level, const Location<double>& at) {
  const double x = at.u * level.width() - 0.5, y = at.v * level.height() - 0.5;
  const double left = std::floor(x), top = std::floor(y);
  const Colour* rows = level.texel(at.face, int(left) - 1, int(top) - 1);
  Colour sum = catmull_rom_sum<float>(rows, level.stride(), x - left, y - top);
  if (!std::isfinite(sum.x + sum.y + sum.z))  // A part of the sum is beyond the largest float.
    sum = Colour(catmull_rom_sum<double>(rows, level.stride(), x - left, y - top));
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

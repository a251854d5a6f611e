#include "envmap/scenes/render/rays/texture_sample.h"

#include <array>
#include <cmath>

#include "envmap/map/image_view.h"

namespace envmap {
namespace {

// IEC 61966-2-1.
float linear(int code) {
  const double c = code / 255.0;
  return float(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
}

glm::vec4 decoded(const Texture& t, int i, int j) {
  static const auto curve = [] {
    std::array<float, 256> table;
    for (int k = 0; k < 256; ++k) table[k] = linear(k);
    return table;
  }();
  const glm::u8vec4 code = ImageView<const glm::u8vec4>(t.texels, t.width, t.height)(i, j);
  if (!t.srgb) return glm::vec4(code) / 255.0F;
  return {curve[code.x], curve[code.y], curve[code.z], float(code.w) / 255.0F};
}

int wrapped(Texture::Wrap wrap, double k, int size) {
  if (!std::isfinite(k)) return 0;
  if (wrap == Texture::Wrap::clamp) return int(std::min(std::max(k, 0.0), size - 1.0));
  const double period = wrap == Texture::Wrap::mirror ? 2.0 * size : size;
  const int inside = int(std::min(k - period * std::floor(k / period), period - 1));
  return inside < size ? inside : 2 * size - 1 - inside;
}

}  // namespace

glm::vec4 texture_at(const Texture& t, const glm::vec2& coordinates) {
  const double x = double(coordinates.x) * t.width - 0.5, y = double(coordinates.y) * t.height - 0.5;
  const double left = std::floor(x), top = std::floor(y);
  const int i0 = wrapped(t.wrap_u, left, t.width), i1 = wrapped(t.wrap_u, left + 1, t.width);
  const int j0 = wrapped(t.wrap_v, top, t.height), j1 = wrapped(t.wrap_v, top + 1, t.height);
  const auto fx = float(x - left), fy = float(y - top);
  return glm::mix(glm::mix(decoded(t, i0, j0), decoded(t, i1, j0), fx),
                  glm::mix(decoded(t, i0, j1), decoded(t, i1, j1), fx), fy);
}

}  // namespace envmap

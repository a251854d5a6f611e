#include "envmap/scenes/render/rays/texture_sample.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "envmap/base/parallel.h"
#include "envmap/map/image_view.h"
#include "envmap/sample/pyramid.h"

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

// @param texel (column, row) -> colour of a level of `width` x `height` texels.
glm::vec4 bilinear_at(const Texture& t, int width, int height, const Vec2<double>& at, auto&& texel) {
  const double x = at.x * width - 0.5, y = at.y * height - 0.5;
  const double left = std::floor(x), top = std::floor(y);
  const int i0 = wrapped(t.wrap_u, left, width), i1 = wrapped(t.wrap_u, left + 1, width);
  const int j0 = wrapped(t.wrap_v, top, height), j1 = wrapped(t.wrap_v, top + 1, height);
  const auto fx = float(x - left), fy = float(y - top);
  return glm::mix(glm::mix(texel(i0, j0), texel(i1, j0), fx), glm::mix(texel(i0, j1), texel(i1, j1), fx), fy);
}

glm::vec4 nearest_at(const Texture& t, const Vec2<double>& at) {
  return decoded(t, wrapped(t.wrap_u, std::floor(at.x * t.width), t.width),
                 wrapped(t.wrap_v, std::floor(at.y * t.height), t.height));
}

// The texels along one side that texel k of the half as fine level covers, and how far.
struct Covered {
  int first = 0, count = 0;
  float parts[3] = {};

  Covered(int k, int fine, int coarse) {
    const double scale = double(fine) / coarse, low = scale * k, high = low + scale;
    first = int(low);
    for (int i = first; i < high && i < fine && count < 3; ++i)
      parts[count++] = float((std::min(high, i + 1.0) - std::max(low, double(i))) / scale);
  }
};

// @param texel (column, row) -> colour of the finer level.
std::vector<glm::vec4> halved(int width, int height, auto&& texel) {
  const int w = std::max(1, width / 2), h = std::max(1, height / 2);
  std::vector<glm::vec4> out(std::size_t(w) * std::size_t(h), glm::vec4(0));
  parallel_for(h, [&](int j) {
    const Covered rows(j, height, h);
    for (int i = 0; i < w; ++i) {
      const Covered columns(i, width, w);
      glm::vec4& sum = out[std::size_t(j) * std::size_t(w) + std::size_t(i)];
      for (int b = 0; b < rows.count; ++b)
        for (int a = 0; a < columns.count; ++a)
          sum += rows.parts[b] * columns.parts[a] * texel(columns.first + a, rows.first + b);
    }
  });
  return out;
}

}  // namespace

glm::vec4 texture_at(const Texture& t, const glm::vec2& coordinates) {
  return bilinear_at(t, t.width, t.height, Vec2<double>(coordinates), [&](int i, int j) { return decoded(t, i, j); });
}

TextureSampler::TextureSampler(const SceneGraph& scene, TextureFilter filter) : scene_(scene), filter_(filter) {
  if (!reads_levels(filter)) return;
  for (const Texture& t : scene.textures) {
    std::vector<Level>& levels = levels_.emplace_back();
    for (int w = t.width, h = t.height; w > 1 || h > 1; w = levels.back().width, h = levels.back().height) {
      std::vector<glm::vec4> texels = levels.empty() ? halved(w, h, [&](int i, int j) { return decoded(t, i, j); })
                                                     : halved(w, h, [&fine = levels.back().texels, w](int i, int j) {
                                                         return fine[std::size_t(j) * std::size_t(w) + std::size_t(i)];
                                                       });
      levels.push_back({std::max(1, w / 2), std::max(1, h / 2), std::move(texels)});
    }
  }
}

glm::vec4 TextureSampler::bilinear(int texture, int level, const Vec2<double>& at) const {
  const Texture& t = scene_.textures[std::size_t(texture)];
  if (level == 0) return bilinear_at(t, t.width, t.height, at, [&](int i, int j) { return decoded(t, i, j); });
  const Level& l = levels_[std::size_t(texture)][std::size_t(level) - 1];
  return bilinear_at(t, l.width, l.height, at,
                     [&](int i, int j) { return l.texels[std::size_t(j) * std::size_t(l.width) + std::size_t(i)]; });
}

glm::vec4 TextureSampler::trilinear(int texture, double lod, const Vec2<double>& at) const {
  const double level = std::clamp(lod, 0.0, double(levels_[std::size_t(texture)].size()));
  const int fine = int(level);
  const auto part = float(level - fine);
  const glm::vec4 below = bilinear(texture, fine, at);
  return part > 0 ? glm::mix(below, bilinear(texture, fine + 1, at), part) : below;
}

glm::vec4 TextureSampler::operator()(int texture, const TextureFootprint& f) const {
  const Texture& t = scene_.textures[std::size_t(texture)];
  const Vec2<double> at(f.at), size(t.width, t.height);
  if (filter_ == TextureFilter::nearest) return nearest_at(t, at);
  if (filter_ == TextureFilter::bilinear) return bilinear(texture, 0, at);
  const Jacobian texels{size * f.across, size * f.down};
  // A plane that is seen along itself has no end within the pixel: its mean is the coarsest level.
  const double extent = glm::length(texels.du) + glm::length(texels.dv);
  if (!(extent < 1e9)) return trilinear(texture, 64, at);
  const Probes plan = filter_ == TextureFilter::ewa         ? ewa_plan(texels)
                      : filter_ == TextureFilter::trilinear ? trilinear_plan(texels)
                                                            : nearest_level_plan(texels);
  glm::vec4 sum(0);
  for (int b = 0; b < plan.down; ++b)
    for (int a = 0; a < plan.across; ++a)
      sum += trilinear(texture, plan.lod,
                       at + ((a + 0.5) / plan.across - 0.5) * f.across + ((b + 0.5) / plan.down - 0.5) * f.down);
  return sum / float(plan.across * plan.down);
}

}  // namespace envmap

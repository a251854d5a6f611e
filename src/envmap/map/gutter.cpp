#include "envmap/map/gutter.h"

#include <algorithm>
#include <cmath>

#include "envmap/sample/sample.h"

namespace envmap {
namespace {

struct GutterTexel {
  int face, i, j;
  Location<double> source;
};

// Is the texel's centre part of the image? If not, is it near enough to be read?
enum class Place { image, gutter, unread };

Place place(const Level& level, int i, int j) {
  const bool inside = i >= 0 && j >= 0 && i < level.width() && j < level.height();
  if (!on_disc(level.projection())) return inside ? Place::image : Place::gutter;
  const double n = level.height(), s = (2 * i + 1) / n - 1, t = 1 - (2 * j + 1) / n, r = std::sqrt(s * s + t * t);
  if (r <= 1 && inside) return Place::image;
  // A tap lies at most sqrt(2) x gutter texels from the place it is read for; a texel is 2/n wide.
  return r <= 1 + (2 * std::numbers::sqrt2 * Level::gutter) / n && r < 2 ? Place::gutter : Place::unread;
}

std::vector<GutterTexel> gutter_texels(const Level& level) {
  constexpr int g = Level::gutter;
  const int w = level.width(), h = level.height();
  std::vector<GutterTexel> found;
  visit(level.projection(), [&](auto p) {
    using P = decltype(p);
    const auto consider = [&](int face, int i, int j) {
      if (place(level, i, j) != Place::gutter) return;
      const auto beyond = P::direction(face, (i + 0.5) / w, (j + 0.5) / h);
      found.push_back({face, i, j, P::locate(beyond)});
    };
    for (int face = 0; face < level.faces(); ++face)
      for (int j = -g; j < h + g; ++j) {
        // Only a disc has gutter texels away from the ends of an inner row.
        const bool whole = P::on_disc || j < 0 || j >= h;
        for (int i = -g; i < w + g; ++i) {
          if (!whole && i == 0) i = w;
          consider(face, i, j);
        }
      }
  });
  return found;
}

// The image texel nearest to a location: the value to start from.
Colour nearest_image_texel(const Level& level, const Location<double>& at) {
  int i = std::clamp(static_cast<int>(at.u * level.width()), 0, level.width() - 1);
  int j = std::clamp(static_cast<int>(at.v * level.height()), 0, level.height() - 1);
  while (place(level, i, j) != Place::image) {
    const int ci = (level.width() - 1) / 2, cj = (level.height() - 1) / 2;
    if (i == ci && j == cj) break;
    i += (i < ci) - (i > ci);
    j += (j < cj) - (j > cj);
  }
  return *level.texel(at.face, i, j);
}

}  // namespace

void fill_gutter(Level& level) {
  const std::vector<GutterTexel> texels = gutter_texels(level);
  std::vector<Colour> values(texels.size());
  const auto store = [&] {
    for (std::size_t k = 0; k < texels.size(); ++k) *level.texel(texels[k].face, texels[k].i, texels[k].j) = values[k];
  };
  for (std::size_t k = 0; k < texels.size(); ++k) values[k] = nearest_image_texel(level, texels[k].source);
  store();
  const int rounds = on_disc(level.projection()) ? 8 : 4;
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t k = 0; k < texels.size(); ++k) values[k] = bilinear(level, texels[k].source);
    store();
  }
}

}  // namespace envmap

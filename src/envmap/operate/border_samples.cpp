#include "envmap/operate/border_samples.h"

#include <algorithm>

#include "envmap/base/parallel.h"
#include "envmap/sample/point.h"

namespace envmap {

Level to_cell_centres(const Level& border) {
  if (border.width() < 2 || border.height() < 2) return border.clone();
  Level level(border.projection(), border.height(), border.width());
  const double sx = (level.width() - 1.0) / level.width(), sy = (level.height() - 1.0) / level.height();
  parallel_for(level.faces() * level.height(), [&](int k) {
    const int face = k / level.height(), j = k % level.height();
    const double y = (j + 0.5) * sy;
    const int top = std::min(int(y), level.height() - 2);
    const float fy = float(y - top);
    for (int i = 0; i < level.width(); ++i) {
      const double x = (i + 0.5) * sx;
      const int left = std::min(int(x), level.width() - 2);
      const float fx = float(x - left);
      const Colour *a = border.texel(face, left, top), *b = a + border.stride();
      *level.texel(face, i, j) = (1 - fy) * ((1 - fx) * a[0] + fx * a[1]) + fy * ((1 - fx) * b[0] + fx * b[1]);
    }
  });
  return level;
}

Level to_border(const Level& level) {
  const PaddedLevel centres(level);
  const int w = centres.width(), h = centres.height();
  Level border(centres.projection(), h, w);
  const auto place = [](int i, int n) { return n > 1 ? i / (n - 1.0) : 0.5; };
  parallel_for(centres.faces() * h, [&](int k) {
    const int face = k / h, j = k % h;
    for (int i = 0; i < w; ++i) *border.texel(face, i, j) = bicubic(centres, {face, place(i, w), place(j, h)});
    if (centres.projection() != Projection::latlong || h == 1 || (j > 0 && j < h - 1)) return;
    Rgb<double> sum(0);
    for (const Colour& c : border.row(face, j)) sum += Rgb<double>(c);
    std::ranges::fill(border.row(face, j), Colour(sum / double(w)));
  });
  return border;
}

}  // namespace envmap

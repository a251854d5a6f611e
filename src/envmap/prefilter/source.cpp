#include "envmap/prefilter/source.h"

#include <algorithm>

#include "envmap/base/parallel.h"
#include "envmap/operate/convert.h"

namespace envmap::prefiltering {

std::optional<EnvironmentMap> source_cube(const EnvironmentMap& map) {
  if (map.projection() == Projection::cube || map.projection() == Projection::latlong) return std::nullopt;
  return convert(map, {.to = {Projection::cube}, .filter = Filter::area});
}

Level refined(const Level& level) {
  constexpr int least = 128;  // Rows of a latlong map: texels below 1.5 degrees.
  const int wanted = level.projection() == Projection::latlong ? least : least / 2;
  const int parts = std::max(1, (wanted + level.height() - 1) / level.height());
  Level out(level.projection(), parts * level.height(), parts * level.width());
  for_each_row(out.faces(), out.height(), {}, [&](int face, int row) {
    const std::span<Colour> to = out.row(face, row);
    for (int i = 0; i < out.width(); ++i) to[i] = *level.texel(face, i / parts, row / parts);
  });
  return out;
}

}  // namespace envmap::prefiltering

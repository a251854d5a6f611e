#include "envmap/prefilter/source.h"

#include "envmap/base/parallel.h"
#include "envmap/operate/convert.h"

namespace envmap::prefiltering {

std::optional<EnvironmentMap> source_cube(const EnvironmentMap& map) {
  if (map.projection() == Projection::cube || map.projection() == Projection::latlong) return std::nullopt;
  return convert(map, {.to = {Projection::cube}, .filter = Filter::area});
}

std::optional<Level> refined(const Level& level) {
  const int rows = level.projection() == Projection::latlong ? 128 : 64;  // Texels of 1.4 degrees.
  const int parts = (rows + level.height() - 1) / level.height();
  if (parts == 1) return std::nullopt;
  Level out(level.projection(), parts * level.height(), parts * level.width());
  for_each_row(out.faces(), out.height(), {}, [&](int face, int row) {
    const std::span<Colour> to = out.row(face, row);
    for (int i = 0; i < out.width(); ++i) to[i] = *level.texel(face, i / parts, row / parts);
  });
  return out;
}

}  // namespace envmap::prefiltering

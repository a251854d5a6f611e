// Conversion to a cube, division of large texels, and the least radiance of a source.
#include "envmap/prefilter/source_cube.h"

#include <cmath>

#include "envmap/base/parallel.h"
#include "envmap/operate/convert.h"

namespace envmap::prefiltering {

std::optional<EnvironmentMap> source_cube(const EnvironmentMap& map, const Progress& progress) {
  if (map.projection() == Projection::cube || map.projection() == Projection::latlong) return std::nullopt;
  return convert(map, {.to = {Projection::cube}, .filter = Filter::area}, {.progress = progress});
}

std::optional<Level> refined(const Level& level, double texel) {
  const int parts = std::max(1, int(std::ceil(pi / texel / rows_between_poles(level))));
  if (parts == 1) return std::nullopt;
  Level out(level.projection(), parts * level.height(), parts * level.width());
  for_each_row(out.faces(), out.height(), {}, [&](int face, int row) {
    const std::span<Colour> to = out.row(face, row);
    for (int i = 0; i < out.width(); ++i) to[i] = *level.texel(face, i / parts, row / parts);
  });
  return out;
}

Colour min_radiance_of(const Level& source) {
  Colour least(std::numeric_limits<float>::max());
  for (const Colour& row : map_rows<Colour>(source.height(), [&](int j) {
         Colour c(std::numeric_limits<float>::max());
         for (int face = 0; face < source.faces(); ++face)
           for (const Colour& texel : source.row(face, j)) c = glm::min(c, texel);
         source.trim();
         return c;
       }))
    least = glm::min(least, row);
  return least;
}

}  // namespace envmap::prefiltering

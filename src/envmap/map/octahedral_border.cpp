#include "envmap/map/octahedral_border.h"

#include <algorithm>

#include "envmap/projection/octahedron.h"

namespace envmap {

Level with_border(const Level& map, int border) {
  const int n = map.height();
  Level texture(map.projection(), n + 2 * border);
  for (int j = 0; j < texture.height(); ++j)
    for (int i = 0; i < texture.width(); ++i) {
      const auto [from_i, from_j] = octahedron::wrapped_texel(i - border, j - border, n);
      *texture.texel(0, i, j) = *map.texel(0, from_i, from_j);
    }
  return texture;
}

Level without_border(const Level& texture, int border) {
  Level map(texture.projection(), texture.height() - 2 * border);
  for (int j = 0; j < map.height(); ++j)
    std::ranges::copy(texture.row(0, j + border).subspan(std::size_t(border), std::size_t(map.width())),
                      map.row(0, j).begin());
  return map;
}

}  // namespace envmap

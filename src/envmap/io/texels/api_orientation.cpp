#include "envmap/io/texels/api_orientation.h"

#include <algorithm>

namespace envmap {

Rows in_api_orientation(const Rows& rows) {
  Rows turned = rows;
  turned.fill = [rows](int face, int row, std::span<Colour> out) {
    rows.fill(face, is_y_face(face) ? rows.size - 1 - row : row, out);
    if (!is_y_face(face)) std::ranges::reverse(out);
  };
  return turned;
}

}  // namespace envmap

#include "envmap/map/mirrored_rows.h"

#include <algorithm>

namespace envmap {

// A cube with Z negated: its two faces change places, and images of the others are mirrored, left to right but for the
// faces of Y, which have Z up there.
Rows mirrored_rows(const Rows& rows, MirroredAxis mirror) {
  if (mirror == MirroredAxis::none) return rows;
  if (mirror == MirroredAxis::x) return with_x_negated(rows);
  Rows turned = rows;
  turned.fill = [rows](int face, int row, std::span<Colour> out) {
    const bool upside_down = face == 2 || face == 3;
    rows.fill(face >= 4 ? 9 - face : face, upside_down ? rows.size - 1 - row : row, out);
    if (!upside_down) std::ranges::reverse(out);
  };
  return turned;
}

}  // namespace envmap

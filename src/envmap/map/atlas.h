/// @file
/// One image of all faces of a map in some layout, or of one face, a band of rows at a time.
#pragma once

#include <span>
#include <vector>

#include "envmap/map/layout.h"
#include "envmap/map/rows.h"

namespace envmap {

struct Atlas {
  const Rows& rows;
  Grid grid;
  int face = -1;           ///< The only face shown, or -1 for all of them.
  int wide = 0, high = 0;  ///< Of the image, where it reaches further right and down than the faces do.
  Colour background{0};    ///< Where no face lies.

  [[nodiscard]] int width() const { return wide > 0 ? wide : (face < 0 ? grid.columns : 1) * rows.width(); }
  [[nodiscard]] int height() const { return high > 0 ? high : (face < 0 ? grid.rows : 1) * rows.size; }
  [[nodiscard]] double texels() const { return 1.0 * width() * height(); }

  /// Image rows [begin, end) into `out`, `width()` texels each. Runs in parallel.
  void gather(int begin, int end, std::span<Colour> out) const;
};

/// Which rows of the faces the image rows show: `size` for each face, in face order, true or false.
std::vector<char> shown_rows(const Grid& grid, int size, const RowRange& rows);

/// The rows wanted, `size` flags for each face; the others stay black. Empty: all.
Rows some_rows(Rows rows, const std::vector<char>& wanted);

/// The other way: image rows [begin, end), `width` texels each, into the faces.
void scatter(std::span<const Colour> rows, int width, int begin, int end, const Grid& grid, Level& level);

}  // namespace envmap

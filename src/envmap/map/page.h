/// @file
/// One image of all faces of a map in some layout, or of one face, a band of rows at a time.
#pragma once

#include <span>

#include "envmap/map/layout.h"
#include "envmap/map/rows.h"

namespace envmap {

struct Page {
  const Rows& rows;
  Grid grid;
  int face = -1;  ///< The only face shown, or -1 for all of them.

  [[nodiscard]] int face_width() const { return rows.size * aspect(rows.projection); }
  [[nodiscard]] int width() const { return face < 0 ? grid.columns * face_width() : face_width(); }
  [[nodiscard]] int height() const { return face < 0 ? grid.rows * rows.size : rows.size; }

  /// Image rows [begin, end) into `out`, `width()` texels each; 0 where no face lies. Runs in parallel.
  void gather(int begin, int end, std::span<Colour> out) const;
};

/// The other way: image rows [begin, end) of a whole grid into the faces.
void scatter(std::span<const Colour> rows, int begin, int end, const Grid& grid, Level& level);

}  // namespace envmap

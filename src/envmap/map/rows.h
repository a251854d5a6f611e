/// @file
/// A map that is made row by row as it is needed: what a writer takes, so that no result need be in memory whole.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "envmap/base/export.h"
#include "envmap/map/environment_map.h"

namespace ENVMAP_EXPORT envmap {

struct Rows {
  Projection projection;
  int size;  ///< Height of a face.
  Forward forward;
  /// Fills row `row` of a face, `out.size()` = its width. Called from many threads at once; always gives the same. Rows
  /// that the library makes throw UsageError where the row or the length is another.
  std::function<void(int face, int row, std::span<Colour> out)> fill;
  int columns = 0;  ///< Width of a face where that is not size x aspect: see Level.

  [[nodiscard]] int width() const { return columns > 0 ? columns : size * aspect(projection); }
};

/// Rows of an image, from `begin` on and before `end`.
struct RowRange {
  int begin, end;
};

/// The rows of a level, which must outlive them. A level that is given away lives as long as its rows.
Rows rows_of(const Level& level, Forward forward);
Rows rows_of(Level&& level, Forward forward);

/// The rows of level 0 of a map, and those of all its levels. A map that is given away lives as long as its rows.
Rows rows_of(const EnvironmentMap& map);
Rows rows_of(EnvironmentMap&& map);
std::vector<Rows> all_rows_of(const EnvironmentMap& map);
std::vector<Rows> all_rows_of(EnvironmentMap&& map);

/// The rows of the map with x of its images negated: columns reversed, and the faces of X of a cube exchanged.
Rows with_x_negated(const Rows& rows);

/// @throws UsageError where the rows cannot be made: no function, or a size out of its range.
void check_rows(const Rows& rows);

/// All rows, made in parallel.
Level level_of(const Rows& rows);

}  // namespace envmap

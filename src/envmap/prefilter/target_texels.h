/// @file
/// The texels that a method sets: their directions, the rows that are wanted, and the bound of the error of each.
#pragma once

#include <span>
#include <vector>

#include "envmap/base/parallel.h"
#include "envmap/base/run.h"
#include "envmap/map/environment_map.h"
#include "envmap/operate/measure.h"
#include "envmap/sample/target_grid.h"

namespace envmap::prefiltering {

struct TargetTexels {
  const Target& target;
  std::span<const char> rows;  ///< Flags of the rows that are wanted, `size` for each face; empty: all.
  Level& out;                  ///< Has the projection and size of the target.
  /// The bounds by index_of(): relative to the texel, or to the floor (error_floor.h). Infinite: unknown.
  std::span<float> bounds;
  const Progress& progress;

  [[nodiscard]] bool wants(int face, int row) const {
    return rows.empty() || rows[std::size_t(face * out.height() + row)] != 0;
  }

  /// Calls set(directions in the frame of the source, texels, bounds) for each wanted row, rows in parallel.
  template <class Set>
  void each_row(Set&& set) const {
    for_each_row(out.faces(), out.height(), progress, [&](int face, int row) {
      if (!wants(face, row)) return;
      const Columns in = columns(target.to, target.size, row);
      std::vector<Direction> directions(in.count());
      texel_directions(target.to, target.size, face, row, in.first, directions);
      rotate(target.to_source, directions);
      set(directions, in.of(out.row(face, row)), in.of(bounds.subspan(index_of(out, {face, 0, row}))));
    });
  }
};

}  // namespace envmap::prefiltering

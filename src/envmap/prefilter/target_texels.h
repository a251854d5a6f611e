/// @file
/// A map in the making: where its texels look, which are wanted, and what each may be off.
#pragma once

#include <span>
#include <vector>

#include "envmap/base/parallel.h"
#include "envmap/base/run.h"
#include "envmap/map/environment_map.h"
#include "envmap/operate/measure.h"
#include "envmap/sample/target_grid.h"

namespace envmap::prefiltering {

struct Making {
  const Target& target;
  std::span<const char> rows;  ///< Flags of the rows that are wanted, `size` for each face; empty: all.
  Level& out;                  ///< Of the projection and size of the target.
  /// Of texels by index_of(), relative to the texel or to 0.001 x the mean of the source if larger. Infinite: unknown.
  std::span<float> bounds;
  const Progress& progress;

  [[nodiscard]] bool wants(int face, int row) const {
    return rows.empty() || rows[std::size_t(face * out.height() + row)] != 0;
  }

  /// Calls set(directions in the frame of the source, texels, bounds) for each row that is wanted.
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

/// @file
/// A map that is made row by row as it is needed: what a writer takes, so that no result need be in memory whole.
#pragma once

#include <functional>
#include <span>

#include "envmap/map/environment_map.h"

namespace envmap {

struct Rows {
  Projection projection;
  int size;  ///< Height of a face.
  Forward forward;
  /// Fills row `row` of a face, `out.size()` = its width. Called from many threads at once; always gives the same.
  std::function<void(int face, int row, std::span<Colour> out)> fill;
};

/// The rows of level 0 of a map, which must outlive them.
Rows rows_of(const EnvironmentMap& map);

}  // namespace envmap

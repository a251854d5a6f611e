/// @file
/// Levels of a source for multilevel summation: its light as point sources on latlong grids, each half as fine as the
/// one before.
///
/// The grids are the adjoint of Lagrange interpolation: a texel is integrated against the basis of the finest grid, and
/// a grid against the basis of the next (Brandt and Lubrecht 1990, "Multilevel matrix multiplication and fast solution
/// of integral equations"). So the sum of a kernel over a grid is the sum over the source of the kernel interpolated
/// from that grid.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <vector>

#include "envmap/map/environment_map.h"
#include "envmap/prefilter/multilevel/node_grid.h"
#include "envmap/prefilter/source_cube.h"

namespace envmap::prefiltering {

/// Whether grids can be made of a map. A coarse level of a latlong map that is not twice as wide as high has none.
inline bool serves_multilevel(const Level& source) {
  return source.projection() == Projection::cube || source.width() == 2 * source.height();
}

/// Rows of the finest grid that repays its cost for so many outputs. A narrower part of a lobe sees few texels, whose
/// sum is quicker.
inline int finest_rows(const Level& source, double outputs = 0) {
  const double product = 512.0 * rows_between_poles(source) * std::max(1.0, outputs / 1e5);
  return std::clamp(int(std::bit_ceil(unsigned(std::sqrt(product)))), 256, 2048);
}

/// Rows of the coarsest grid, about. All numbers of rows are 8 to 15 times a power of two.
inline constexpr int least_rows = 64;

/// Grids of `finest` rows, of half as many, and so on down to least_rows.
class SourceGrids {
 public:
  /// @param source a cube or latlong map. @param unit that radiance is counted in, above 0. @param min_radiance left
  /// out (source_cube.h).
  SourceGrids(const Level& source, double unit, const Colour& min_radiance, int finest);

  [[nodiscard]] const NodeGrid& grid(int rows) const {
    return grids_[std::size_t(std::countr_zero(unsigned(grids_.front().rows / rows)))];
  }

 private:
  std::vector<NodeGrid> grids_;  // Grids from the finest on.
};

}  // namespace envmap::prefiltering

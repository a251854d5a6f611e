/// @file
/// The source of prefix sums: levels of cells with the moments of their light, and prefix sums of the moments along
/// rows of cells. Cells are stored as floats, prefix sums in double.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "envmap/base/large_pages.h"
#include "envmap/map/environment_map.h"
#include "envmap/prefilter/prefix_sums/horizon_cells.h"

namespace envmap::prefiltering {

/// Light of one cell less PrefixSumSource::min_radiance(), of channels c = 0, 1, 2, in units of the mean: first moments
/// m[3 k + c] of the face's axis k, the flux m[9 + c], and the least radiance m[12 + c] (0 in rows at a pole).
struct alignas(64) CellLight {
  float m[16];
};

template <class Grid>
class PrefixSumSource {
 public:
  /// @param source a cube or latlong map of 4 rows or more. @param mean of its radiance.
  /// @param min_radiance left out, see min_radiance(). @param rows about the most rows of cells of a face that sums
  /// start from. @param fewest the least. @param order of moments, 1 to 3.
  PrefixSumSource(const Level& source, double mean, const Colour& min_radiance, int rows, int fewest, int order);

  struct Cells {
    typename Grid::Cells grid;
    std::unique_ptr<CellLight[]> light;  ///< Ordered by face, row and column.
    [[nodiscard]] const CellLight& cell(int face, int row, int column) const {
      return light[std::size_t(face * grid.down.count() + row) * std::size_t(grid.across.count()) +
                   std::size_t(column)];
    }
  };

  [[nodiscard]] int order() const { return order_; }
  /// Frees pages of texels that the scratch file holds: Level::trim().
  void trim() const { source_.trim(); }
  [[nodiscard]] const Grid& grid() const { return grid_; }
  /// Levels from the finest on. The side of cells doubles from level to level.
  [[nodiscard]] std::span<const Cells> levels() const { return levels_; }
  /// The side of a cell in radians, about.
  [[nodiscard]] double side(std::size_t level) const {
    return (Grid::faces == 1 ? pi : 0.5 * pi) / levels_[level].grid.down.count();
  }
  /// The finest level with prefix sums: sums start from this level or a coarser one.
  [[nodiscard]] std::size_t base() const { return levels_.size() - prefixes_.size(); }

  /// Moments x, y, z, of order 2 also xx, yy, zz, xy, xz, yz, and of order 3 xxx, xxy, xxz, xyy, xyz, yyy, yyz (the
  /// other three follow from x^2 + y^2 + z^2 = 1), of three channels each.
  using Sums = std::array<double, 48>;
  /// Adds the moments of cells [first, last) of a row of a level from base() on. Columns wrap.
  void add(std::size_t level, int face, int row, int first, int last, Sums& sums) const;
  /// Prefetches the prefix sums that add() reads.
  void prefetch(std::size_t level, int face, int row, int first, int last) const;
  /// Least radiance of each channel, in units of the mean. Cells, sums and radiance() leave it out (source_cube.h).
  [[nodiscard]] Flux min_radiance() const { return Flux(min_radiance_) * unit_; }
  /// Radiance of a texel, in units of the mean.
  [[nodiscard]] Flux radiance(int face, int row, int column) const {
    return Flux(*source_.texel(face, column, row) - min_radiance_) * unit_;
  }

 private:
  using CellSum = std::array<double, 15>;                    // A cell before it is rounded.
  using Prefixes = std::vector<double, LargePages<double>>;  // Ordered by face, row of cells, border, moment, channel.
  struct Rows;
  void set_band(int band);
  void set_coarser_cells(std::size_t level);
  [[nodiscard]] Prefixes coarser(std::size_t level) const;
  [[nodiscard]] std::size_t prefix_place(std::size_t level, int face, int row) const;
  void add_row(int face, int row, std::span<const typename Grid::Row> texels, Rows& rows);
  void close_row(std::size_t level, int face, int row, Rows& rows);
  [[nodiscard]] std::size_t stride() const { return order_ == 1 ? 9 : order_ == 2 ? 27 : 48; }

  const Level& source_;
  Colour min_radiance_;
  double unit_;
  int order_;
  Grid grid_;
  std::vector<Cells> levels_;
  std::vector<Prefixes> prefixes_;  // The prefix sums of each level from base() on.
};

extern template class PrefixSumSource<LatlongGrid>;
extern template class PrefixSumSource<CubeGrid>;

}  // namespace envmap::prefiltering

/// @file
/// The source of the sums at the horizon: its cells with their moments, and prefix sums along rows of cells.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "envmap/base/large_pages.h"
#include "envmap/map/environment_map.h"
#include "envmap/prefilter/prefix_sums/horizon_cells.h"

namespace envmap::prefiltering {

/// Light of one cell beyond HingeSource::darkest(), of channels c = 0, 1, 2, in units of the mean: first moments m[3 k
/// + c] of the face's axis k, the flux m[9 + c], and the least radiance m[12 + c] (0 in rows at a pole).
struct alignas(64) HingeCell {
  float m[16];
};

template <class Grid>
class HingeSource {
 public:
  /// @param source a cube or latlong map of 4 rows or more. @param mean of its radiance.
  /// @param darkest left out, see darkest(). @param rows of cells of a face that sums start from at most, about.
  /// @param fewest the same at least. @param order of moments, 1 to 3.
  HingeSource(const Level& source, double mean, const Colour& darkest, int rows, int fewest, int order);

  struct Cells {
    typename Grid::Cells grid;
    std::unique_ptr<HingeCell[]> light;  ///< By face, row and column.
    [[nodiscard]] const HingeCell& cell(int face, int row, int column) const {
      return light[std::size_t(face * grid.down.count() + row) * std::size_t(grid.across.count()) +
                   std::size_t(column)];
    }
  };

  [[nodiscard]] int order() const { return order_; }
  /// Leaves texels to the scratch file: Level::trim().
  void trim() const { source_.trim(); }
  [[nodiscard]] const Grid& grid() const { return grid_; }
  /// From the finest on. Each has cells of twice the side of the level before.
  [[nodiscard]] std::span<const Cells> levels() const { return levels_; }
  /// About, in radians.
  [[nodiscard]] double side(std::size_t level) const {
    return (Grid::faces == 1 ? pi : 0.5 * pi) / levels_[level].grid.down.count();
  }
  /// The first of those that sums may start from, which have prefix sums.
  [[nodiscard]] std::size_t base() const { return levels_.size() - prefixes_.size(); }

  /// Moments x, y, z, of order 2 also xx, yy, zz, xy, xz, yz, and of order 3 xxx, xxy, xxz, xyy, xyz, yyy, yyz (the
  /// other three follow from x^2 + y^2 + z^2 = 1), of three channels each.
  using Sums = std::array<double, 48>;
  /// Adds those of cells [first, last) of a row of a level from base() on. Columns may run on beyond the last.
  void add(std::size_t level, int face, int row, int first, int last, Sums& sums) const;
  /// Brings what add() reads into the cache.
  void prefetch(std::size_t level, int face, int row, int first, int last) const;
  /// Least radiance of each channel, in units of the mean. It comes from everywhere, so its integral is known in closed
  /// form, and a constant map stays constant to the last bit. Cells, sums and radiance() leave it out.
  [[nodiscard]] Flux darkest() const { return Flux(darkest_) * unit_; }
  /// In units of the mean.
  [[nodiscard]] Flux radiance(int face, int row, int column) const {
    return Flux(*source_.texel(face, column, row) - darkest_) * unit_;
  }

 private:
  using Sum = std::array<double, 15>;                        // A cell before it is rounded.
  using Prefixes = std::vector<double, LargePages<double>>;  // By face, row of cells, border, moment and channel.
  struct Rows;
  void set_band(int band);
  void set_coarser_cells(std::size_t level);
  [[nodiscard]] Prefixes coarser(std::size_t level) const;
  [[nodiscard]] std::size_t prefix_place(std::size_t level, int face, int row) const;
  void add_row(int face, int row, std::span<const typename Grid::Row> texels, Rows& rows);
  void close_row(std::size_t level, int face, int row, Rows& rows);
  [[nodiscard]] std::size_t stride() const { return order_ == 1 ? 9 : order_ == 2 ? 27 : 48; }

  const Level& source_;
  Colour darkest_;
  double unit_;
  int order_;
  Grid grid_;
  std::vector<Cells> levels_;
  std::vector<Prefixes> prefixes_;  // Of each level from base() on.
};

extern template class HingeSource<LatlongGrid>;
extern template class HingeSource<CubeGrid>;

}  // namespace envmap::prefiltering

/// @file
/// How much each texel of a level counts for in an integral over a polygon.
#pragma once

#include <span>
#include <vector>

#include "envmap/maths/vector.h"

namespace envmap {

/// Weights of texels in the integral of their bilinear reconstruction over a polygon, exactly.
///
/// By Green's theorem the integral is a sum over the polygon's sides: each stands for what lies to its right, with the
/// sign of the way it goes, as in scan converters with exact area coverage (Catmull 1978, "A hidden-surface algorithm
/// with anti-aliasing"). A side is cut at the borders of cells, which are the squares between four texel centres, and
/// adds to each cell's moments; the cells to the right in the row get theirs by a running sum.
class Coverage {
 public:
  /// @param points a closed polygon that does not cross itself, in texels,
  /// with texel centres at whole numbers below 2^30.
  void cover(std::span<const Point2> points);

  /// Texels of a row, from the first that a side may count for to the last.
  struct Run {
    int row, first, count;
  };
  /// What was covered, row by row.
  [[nodiscard]] std::span<const Run> runs() const { return runs_; }

  /// Weights of these texels, one run after another, none of them negative. Their sum is the integral of the density.
  /// @param densities at the texels' centres, taken as linear over each cell.
  std::span<const double> weights(std::span<const double> densities);

 private:
  // Integrals over a part of a cell, the unit square; and what its sides give to each cell to the right of it.
  struct Cell {
    double one = 0, x = 0, xx = 0, y = 0, xy = 0, xxy = 0, yy = 0, xyy = 0;
    double beyond = 0, beyond_y = 0, beyond_yy = 0;
  };

  // Cells of a row that sides pass through.
  struct Reach {
    int first, last;
  };

  void clear(int across, int down);
  void find_runs(int top);
  void add_side(const Point2& a, const Point2& b);
  void add_in_row(int row, const Point2& a, const Point2& b);
  void add_piece(Cell& cell, const Point2& a, const Point2& b);

  int left_ = 0;               // In texels.
  int across_ = 0, down_ = 0;  // Of cells.
  double sign_ = 1;            // -1 where the polygon goes round the other way.
  std::vector<Cell> cells_;    // Zero where no side passes through: a long polygon touches few of those round it.
  std::vector<Reach> reach_;
  std::vector<Run> runs_;
  std::vector<double> weights_;
};

}  // namespace envmap

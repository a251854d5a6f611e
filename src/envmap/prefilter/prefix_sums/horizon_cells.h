/// @file
/// The cells of a source as the horizon of an output direction cuts them, for latlong maps and cube faces.
///
/// On both, t = n.d = L / r with r > 0 and L a (nearly) linear function of two coordinates (x,y):
///   cube     x and y are the face's own s and t, r^2 = 1 + x^2 + y^2, L is linear
///   latlong  x is the longitude, y = cot(polar angle), r^2 = 1 + y^2, L = n_z y + |n_xy| cos(x - x_n)
/// and the solid angle is dx dy / r^3. So the horizon L = 0 is a straight line, the integral of t+ is that of L+ / r^4,
/// and the integral of t+^2 is that of L+^2 / r^5. A latlong row that touches a pole has no finite y: only the range of
/// t over its cells is known.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "envmap/maths/vector.h"
#include "envmap/projection/cube.h"
#include "envmap/projection/latlong.h"

namespace envmap::prefiltering {

/// An output direction in the frame of a face: (right, up, forward) of a cube face, (column 0, a quarter turn on, pole)
/// of a latlong map.
struct FaceDirection {
  double x, y, z;
  double longitude = 0;  ///< Latlong: of the direction, in [-pi, pi].
};

/// The part of a cell's geometry that is the same for every output direction.
struct CellShape {
  double near = 1, far = 1;  ///< Largest and least 1 / r.
  double solid_angle = 0;
  std::array<double, 3> mean{};  ///< Mean direction; latlong: sine of the polar angle, 0 and height.
  double centre = 0, half = 0;   ///< Latlong: y of the middle, half the extent.
  /// Area / (r^4 solid_angle) by the r of the middle, and the largest relative difference of r^-4.
  double weight1 = 0, variation1 = 0;
  double weight2 = 0, variation2 = 0;  ///< Like weight1 and variation1, for r^-5.
  bool polar = false;  ///< The row touches a pole: centre and half are of cos(polar angle), far is a sine.
};

/// L over one cell: a plane with values middle +- (across + down), but for `bend` at most. `uniform`: the mean of t
/// over the cell.
struct CellView {
  double middle, across, down, bend, uniform;
};

/// x^4 or x^5.
inline double power(double x, int n) { return n == 4 ? x * x * x * x : x * x * x * x * x; }
/// The largest relative difference of a power of 1 / r. @param near,far the largest and least 1 / r, over the middle's.
inline double variation(double near, double far, int n) { return std::max(power(near, n) - 1, 1 - power(far, n)); }

/// Columns of a row that are wholly above the horizon, [first, last), and columns that it may cut, [cut, first) and
/// [last, end). On latlong maps numbers from `count` on wrap to the first columns.
struct RowSpan {
  int cut, first, last, end;
};

/// A texel or a part of one, the finest cells of all: integrals over it, and L as in CellView.
struct PartView {
  double solid_angle, first, second, third;  ///< Integrals of 1, t, t^2 and t^3.
  double middle, across, down, bend;
  /// Area / r^4 and / r^5 by the r of the middle, and the variation of these powers.
  double weight1, variation1, weight2, variation2;
  bool polar;  ///< middle, across, down are of t in the place of L.
};

/// A divided part of a texel: four parts, but three at the pole of a latlong map, of which one touches the pole.
template <class Part>
struct Division {
  std::array<Part, 4> parts;
  std::size_t count;
};

/// Borders of cells of `side` texels along an edge of `texels`, of which the last may be smaller.
struct CellEdges {
  int texels, side, cells;
  CellEdges(int of_texels, int of_side)
      : texels(of_texels), side(of_side), cells((of_texels + of_side - 1) / of_side) {}
  [[nodiscard]] int count() const { return cells; }
  [[nodiscard]] int first(int k) const { return k * side; }
  [[nodiscard]] int end(int k) const { return std::min((k + 1) * side, texels); }
};

/// Numbers of moments up to an order: 1, x, y, z, xx, yy, zz, xy, xz, yz, xxx, xxy, xxz, xyy, xyz, yyy, yyz.
inline constexpr std::array<std::size_t, 4> moment_counts{1, 4, 10, 17};

/// Light of a block of texels: moments of three channels, and the least radiance.
struct BlockMoments {
  std::array<std::array<double, 3>, moment_counts.back()> moments{};
  Colour least{std::numeric_limits<float>::max()};
};

class LatlongGrid {
 public:
  LatlongGrid(int width, int height);
  static constexpr int faces = 1;
  static FaceDirection seen(int /*face*/, const Direction& n);
  /// A row of texels, to be added to blocks. @param order of the moments, 1 to 3.
  struct Row {
    const LatlongGrid* grid;
    // Integrals of sin(polar angle) times 1, cos, sin, ...
    double o = 0, c = 0, s = 0, cc = 0, cs = 0, ss = 0, ssc = 0, sss = 0;
    void add(std::span<const Colour> texels, int first, int order, BlockMoments& block) const;
  };
  [[nodiscard]] Row row(int row, int order) const;

  struct Column {
    double cosine, sine;                     // Of the longitude of the middle.
    double level, steep, bend, twist, mean;  // Means and ranges of cos and sin over the column, see cells().
    double width;
  };
  struct Cells {
    CellEdges across, down;
    std::vector<Column> columns;
    std::vector<CellShape> rows;
    std::vector<double> slopes;  // y of the borders of rows, from the first pole to the other.

    [[nodiscard]] const CellShape& shape(int row, int /*column*/) const { return rows[std::size_t(row)]; }
    [[nodiscard]] double solid_angle(int row, int column) const {
      return rows[std::size_t(row)].solid_angle * columns[std::size_t(column)].width;
    }
    [[nodiscard]] CellView view(const FaceDirection& n, int row, int column) const;
    /// @param angles of the borders of the row, see border_angles().
    [[nodiscard]] RowSpan span(const FaceDirection& n, const double* angles, int row) const;
    [[nodiscard]] int wrapped(int column) const { return column < across.cells ? column : column - across.cells; }
  };
  [[nodiscard]] Cells cells(int side) const;

  struct Part {
    const LatlongGrid* grid;
    double sine, cosine;  // Of the polar angle in the middle.
    double level, turn;   // |n_xy| cos and sin of the longitude from n.
    int down, across;     // Number of halvings each way.
    int pole;             // 1 or -1 where the part touches one.
    [[nodiscard]] PartView view(const FaceDirection& n) const;
    [[nodiscard]] Division<Part> divided() const;
  };
  [[nodiscard]] Part texel(const FaceDirection& n, int row, int column) const;

 private:
  struct Halving {
    double sine_down, cosine_down, sine_across, cosine_across;  // Of half the height and width of a part.
    double sine_node, cosine_node;                              // Of a Gauss point's distance from the middle.
    double across;
  };
  int width_, height_;
  std::vector<Halving> halvings_;
  std::vector<std::array<double, 2>> rows_, columns_;  // Cosine and sine of the middles of texels.
  // Integrals over a column of cos, sin, cos^2, cos sin, cos^3 and cos^2 sin of the longitude.
  std::vector<std::array<double, 6>> across_;
};

class CubeGrid {
 public:
  CubeGrid(int width, int height);
  static constexpr int faces = 6;
  static FaceDirection seen(int face, const Direction& n) {
    const Cube::Axes& a = Cube::axes[std::size_t(face)];
    return {glm::dot(n, a.right), glm::dot(n, a.up), glm::dot(n, a.forward)};
  }
  struct Row {
    std::vector<std::array<double, moment_counts.back()>> moments;
    void add(std::span<const Colour> texels, int first, int order, BlockMoments& block) const;
  };
  [[nodiscard]] Row row(int row, int order) const;

  struct Cells {
    CellEdges across, down;
    std::vector<CellShape> shapes;
    std::vector<double> slopes;  // None.

    [[nodiscard]] const CellShape& shape(int row, int column) const {
      return shapes[std::size_t(row) * std::size_t(across.count()) + std::size_t(column)];
    }
    [[nodiscard]] double solid_angle(int row, int column) const { return shape(row, column).solid_angle; }
    [[nodiscard]] CellView view(const FaceDirection& n, int row, int column) const;
    [[nodiscard]] RowSpan span(const FaceDirection& n, const double* angles, int row) const;
    [[nodiscard]] int wrapped(int column) const { return column; }
  };
  [[nodiscard]] Cells cells(int side) const;

  struct Part {
    double x, y, half;
    [[nodiscard]] PartView view(const FaceDirection& n) const;
    [[nodiscard]] Division<Part> divided() const;
  };
  [[nodiscard]] Part texel(const FaceDirection& /*n*/, int row, int column) const {
    const double half = 1.0 / size_;
    return {(2 * column + 1) * half - 1, 1 - (2 * row + 1) * half, half};
  }

 private:
  int size_;
};

/// t over longitudes within `across` of a middle, in a row at a pole. @param level,turn |n_xy| cos and sin of the
/// longitude from n.
/// @param z n_z. @param centre,half of cos(polar angle). @param sine,cosine of half the extent across.
/// @param most sin(polar angle).
inline void set_polar(CellView& view, double z, double centre, double half, double level, double turn, double sine,
                      double cosine, double most) {
  const double spread = std::abs(turn) * sine + std::abs(level) * (1 - cosine);
  const double low = std::min(0.0, level - spread) * most, high = std::max(0.0, level + spread) * most;
  view.middle = z * centre + 0.5 * (low + high);
  view.across = 0.5 * (high - low), view.down = std::abs(z) * half, view.bend = 0;
}

inline CellView LatlongGrid::Cells::view(const FaceDirection& n, int row, int column) const {
  const CellShape& s = rows[std::size_t(row)];
  const Column& c = columns[std::size_t(column)];
  const double level = n.x * c.cosine + n.y * c.sine, turn = n.x * c.sine - n.y * c.cosine;
  CellView view{};
  view.uniform = n.z * s.mean[2] + level * c.mean * s.mean[0];
  if (s.polar) {
    set_polar(view, n.z, s.centre, s.half, level, turn, c.steep, 1 - 2 * c.bend, s.far);
    return view;
  }
  view.middle = n.z * s.centre + level * c.level;
  view.across = std::abs(turn) * c.steep, view.down = std::abs(n.z) * s.half;
  view.bend = std::abs(level) * c.bend + std::abs(turn) * c.twist;
  return view;
}

inline CellView CubeGrid::Cells::view(const FaceDirection& n, int row, int column) const {
  const CellShape& s = shape(row, column);
  const double inverse = 1.0 / across.texels;
  const double x = (across.first(column) + across.end(column)) * inverse - 1,
               half_x = (across.end(column) - across.first(column)) * inverse;
  const double y = 1 - (down.first(row) + down.end(row)) * inverse,
               half_y = (down.end(row) - down.first(row)) * inverse;
  return {n.x * x + n.y * y + n.z, std::abs(n.x) * half_x, std::abs(n.y) * half_y, 0,
          n.x * s.mean[0] + n.y * s.mean[1] + n.z * s.mean[2]};
}

}  // namespace envmap::prefiltering

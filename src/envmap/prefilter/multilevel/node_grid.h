/// @file
/// Latlong grids whose rows near the poles have fewer columns, so that nodes are nowhere much closer than rows.
#pragma once

#include <cstddef>
#include <vector>

#include "envmap/base/large_pages.h"
#include "envmap/maths/vector.h"

namespace envmap::prefiltering {

/// A direction in the coordinates of a grid: longitude in [0, 2 pi); the polar angle, its sine, and the sine and cosine
/// of its half.
struct GridView {
  double longitude, sine, half_sine, half_cosine, angle;
  explicit GridView(const Direction& in_grid);
  GridView(double at_longitude, double at_angle);
};

/// Three channels at the nodes of a latlong grid. A row has the columns of the equator over a power of two: a multiple
/// of 8, at least 40, no farther apart than rows.
struct NodeGrid {
  int rows = 0;
  std::vector<int> columns;
  std::vector<std::size_t> first;              ///< Index of a row's red; green and blue follow `stride` floats apart.
  std::vector<double> half_sine, half_cosine;  ///< Sine and cosine of half the polar angle.
  std::vector<float> sine;                     ///< Sine of the polar angle.
  std::vector<float, LargePages<float>> values;

  explicit NodeGrid(int of_rows);  ///< All values are 0.

  static constexpr int padding = 16;  ///< Columns that repeat after the last.
  [[nodiscard]] std::size_t stride(int row) const { return std::size_t(columns[std::size_t(row)] + padding); }
  [[nodiscard]] float* channel(int row, int c) {
    return &values[first[std::size_t(row)] + std::size_t(c) * stride(row)];
  }
  void repeat_columns(int row);  ///< After the last, once they are set.
  [[nodiscard]] GridView node(int row, int column) const;
};

/// The number of nodes of a grid, about.
inline double nodes_of(int rows) { return 1.56 * rows * rows; }

}  // namespace envmap::prefiltering

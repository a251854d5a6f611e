/// @file
/// The inner loops of multilevel summation: a kernel in a window of a source grid,
/// eight virtual lanes wide on every processor.
#pragma once

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "envmap/map/environment_map.h"
#include "envmap/maths/vector.h"
#include "envmap/prefilter/multilevel/node_grid.h"

namespace envmap::prefiltering {

/// Part of a lobe that one level adds: K_j = S_j - S_(j+1), over x = 1 - cos. S_j is the lobe, flattened within x_j:
/// S_j(x) = K(x + c x_j (1 - x / x_j)^q). The last level has S_j itself, less what prefix sums add.
struct LevelKernel {
  enum class Kind { ggx, power } kind = Kind::ggx;
  struct Softened {
    bool is = false;
    float inverse = 0, root = 0;  ///< 1 / x_j, and (c x_j)^(1/q).
  };
  Softened inner, outer;
  bool quartic = false;  ///< q = 4, else 3.
  /// What 16 points do for, at most. ggx: (size / distance from the pole)^2 of a piece; power: the power of e that it
  /// falls by.
  float uneven = 0;
  float end = 1;                  ///< x from which it is 0.
  float a = 0;                    ///< ggx: (1 - x) / (a + x)^2.
  float power = 0, part = 1;      ///< power: (1 - part x)^power,
  bool cosine = false;            ///< times 1 - x.
  std::array<float, 3> hinges{};  ///< Factors of t+, t+^2 and t+^3 that are taken off.
  double scale = 1;               ///< Of all.
};

/// Half the columns of a row within 2 sin(angle / 2)^2 = versine of a direction, with a little more.
/// @param versine below 2.
inline double half_width(double versine, int columns) {
  const double s = std::sqrt(0.5 * versine);
  return 2 * s * (1 + 0.5708 * s * s) * columns / (2 * pi) + 0.002;  // asin(s) <= s (1 + 0.5708 s^2).
}

/// Room for gather(), of one thread.
struct GatherRoom {
  struct Row {
    int row, start, blocks, kind;
    float c, g;  // x = c + g x versine.
  };
  struct Angles {
    int columns, low, high;
    std::size_t first;
  };
  std::vector<Row> rows;
  std::vector<Angles> kinds;  // Rows of as many columns.
  std::vector<float> versines;
  std::vector<float> taps;  ///< The kernel at the rows' columns, for gather_at_row().
};

/// The sum over a grid of light x kernel.
Flux gather(const NodeGrid& grid, const LevelKernel& kernel, const GridView& view, GatherRoom& room);

/// The same at each node of a row of the grid itself, added to `out`. Nodes of a row see the same kernel.
void gather_at_row(const NodeGrid& grid, const LevelKernel& kernel, int row, GatherRoom& room, std::span<Flux> out);

/// The values at nodes, interpolated (lagrange.h).
Flux interpolate(const NodeGrid& grid, const GridView& view);

/// out[k] = the product of `weights` with `in` from k x step on. @param weights a multiple of 8.
void dot_products(std::span<const float> in, std::size_t step, std::span<const float> weights, std::span<float> out);

/// out += weight x in.
void add_scaled(std::span<const float> in, float weight, std::span<float> out);

/// The integral of (radiance - darkest) / unit x kernel over the sphere: powers over rows of latlong maps far from the
/// poles by a polynomial (narrow_power-inl.h), else by Gauss points, eight texels at a time where sixteen points of
/// each are good enough. The others are divided until they are. What is left is measured by tests/bench/kappa.cpp.
/// @param source a cube or latlong map in texels of 1.5 degrees or less. @param unit about the mean of its radiance.
/// @param kernel of a narrow lobe: ends within 0.2 radians, since cube faces farther away are left out.
/// @param direction a unit vector.
Flux core_sum(const Level& source, const Colour& darkest, double unit, const LevelKernel& kernel,
              const Direction& direction);

}  // namespace envmap::prefiltering

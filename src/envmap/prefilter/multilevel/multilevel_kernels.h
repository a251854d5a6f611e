/// @file
/// The inner loops of multilevel summation: sums of light x kernel over a window of a source grid. They are eight
/// virtual lanes wide on every processor, so that all give the same bits.
#pragma once

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "envmap/map/environment_map.h"
#include "envmap/maths/vector.h"
#include "envmap/prefilter/multilevel/node_grid.h"

namespace envmap::prefiltering {

/// The part of a lobe that one level adds, over x = 1 - cos: K_j = S_j - S_(j+1). S_j is the lobe K flattened within
/// x_j = r_j^2 / 2: S_j(x) = K(x + c x_j (1 - x / x_j)^q). The last level has S_j itself, less the horizon terms.
struct LevelKernel {
  enum class Kind { ggx, power } kind = Kind::ggx;
  struct Flattening {
    bool active = false;
    float inverse = 0, root = 0;  ///< 1 / x_j, and (c x_j)^(1/q).
  };
  Flattening inner, outer;
  bool quartic = false;  ///< q = 4, else 3.
  /// The most variation over a piece of the near field for which 16 points are accurate. ggx: (size / distance from the
  /// pole)^2 of the piece; power: the power of e by which it falls.
  float max_variation = 0;
  float end = 1;                         ///< x from which the kernel is 0.
  float a = 0;                           ///< ggx: (1 - x) / (a + x)^2.
  float power = 0, part = 1;             ///< power: (1 - part x)^power,
  bool cosine = false;                   ///< times 1 - x.
  std::array<float, 3> horizon_terms{};  ///< Factors of t+, t+^2 and t+^3, which are subtracted.
  double scale = 1;                      ///< Factor of the whole kernel.
};

/// Half the number of columns of a row within a versine, 2 sin(angle / 2)^2, of a direction, rounded up a little.
/// @param versine below 2.
inline double half_width(double versine, int columns) {
  const double s = std::sqrt(0.5 * versine);
  return 2 * s * (1 + 0.5708 * s * s) * columns / (2 * pi) + 0.002;  // asin(s) <= s (1 + 0.5708 s^2).
}

/// Buffers of gather(), for one thread.
struct GatherBuffers {
  struct Row {
    int row, start, blocks, longitudes;  // The last is an index.
    float c, g;                          // x = c + g x versine of the longitude.
  };
  // Versines of columns low to high, for all rows with as many columns.
  struct Longitudes {
    int columns, low, high;
    std::size_t first;
  };
  std::vector<Row> rows;
  std::vector<Longitudes> longitudes;
  std::vector<float> versines;
  std::vector<float> taps;  ///< Values of the kernel at the columns of the rows, for gather_at_row().
};

/// Returns the sum over a grid of light x kernel.
Flux gather(const NodeGrid& grid, const LevelKernel& kernel, const GridView& view, GatherBuffers& buffers);

/// Adds the sum at each node of a row of the grid itself to `out`. All nodes of a row share the kernel's values.
void gather_at_row(const NodeGrid& grid, const LevelKernel& kernel, int row, GatherBuffers& buffers,
                   std::span<Flux> out);

/// Interpolates the values at the nodes (lagrange.h).
Flux interpolate(const NodeGrid& grid, const GridView& view);

/// out[k] = the product of `weights` with `in` from k x step on. @param weights a multiple of 8.
void dot_products(std::span<const float> in, std::size_t step, std::span<const float> weights, std::span<float> out);

/// out += weight x in.
void add_scaled(std::span<const float> in, float weight, std::span<float> out);

/// Returns the integral of (radiance - min_radiance) / unit x kernel over the sphere, by the texels (near_field.cpp).
/// @param source a cube or latlong map in texels of 1.5 degrees or less. @param unit about the mean of its radiance.
/// @param kernel of a narrow lobe: ends within 0.2 radians, since cube faces farther away are left out.
/// @param direction a unit vector.
Flux near_field_sum(const Level& source, const Colour& min_radiance, double unit, const LevelKernel& kernel,
                    const Direction& direction);

}  // namespace envmap::prefiltering

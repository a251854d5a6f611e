/// @file
/// Inner loops of the spectral method, by SIMD: the same bits on every CPU.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace envmap::prefiltering {

/// Points of an interpolation, each way.
inline constexpr std::size_t taps = 8;

/// Samples of red, green and blue on rings of equal distance: colatitude (ring + 0.5) pi / rings,
/// longitude 2 pi column / columns.
struct RingGrid {
  int rings = 0, columns = 0;  ///< Columns a power of two, twice the rings.
  std::vector<double> values;  ///< By ring, channel and column; `taps` columns more, for stencils that run over.

  RingGrid() = default;
  explicit RingGrid(int n) : rings(n / 2), columns(n), values(std::size_t(rings) * 3 * stride(), 0) {}
  [[nodiscard]] std::size_t stride() const { return std::size_t(columns) + taps; }
  [[nodiscard]] double* row(int ring, std::size_t channel) {
    return &values[(std::size_t(ring) * 3 + channel) * stride()];
  }
};

/// Lagrange's polynomials of nodes 0, 1, ... taps - 1 at t.
inline std::array<double, taps> lagrange(double t) {
  static constexpr std::array<double, taps> scale{-1.0 / 5040, 1.0 / 720, -1.0 / 240, 1.0 / 144,
                                                  -1.0 / 144,  1.0 / 240, -1.0 / 720, 1.0 / 5040};
  std::array<double, taps> weights;
  double below = 1, above = 1;
  for (std::size_t k = 0; k < taps; ++k) {
    weights[k] = scale[k] * below;
    below *= t - double(k);
  }
  for (std::size_t k = taps; k-- > 0;) {
    weights[k] *= above;
    above *= t - double(k);
  }
  return weights;
}

/// Where a direction lies among the samples, and the weights of Lagrange's polynomial there.
struct Stencil {
  int ring, column;  ///< The first ones; rings beyond a pole are those on its other side, half a turn on.
  std::array<double, taps> down, across;
};

/// @param u,v of the latlong image of the grid, [0,1].
Stencil stencil_at(const RingGrid& grid, double u, double v);

inline constexpr std::size_t most_turns = 4;

/// Radiance that falls on the same points, turned by quarters of a ring.
struct RingLight {
  std::array<std::array<double, 3>, most_turns> colours;
  std::size_t turns;
};

/// A few points that are less than a sample from the first, with their solid angles.
struct Spot {
  static constexpr std::size_t most = 4;
  RingLight light{};
  std::size_t count = 0;
  std::array<double, most> down{}, across{}, weight{};  ///< In rings from the first, in columns.

  void add(double ring, double column, double solid_angle) {
    down[count] = ring, across[count] = column, weight[count++] = solid_angle;
  }
};

/// Adds spots to the samples round them: what interpolation does, transposed.
void spread(RingGrid& grid, std::span<const Spot> spots);

std::array<double, 3> interpolate(RingGrid& grid, const Stencil& at);

/// Real and imaginary parts of the three channels, and two that are 0.
using Parts = std::array<double, 8>;
inline constexpr std::size_t block = 8;  ///< Rings at once.

/// Associated Legendre functions of one m on a block of rings: see maths/legendre.h.
/// @param first P_m. @param a,b at l - m. @param out l - m = 0, 1, ... a.size() - 1.
void legendre(std::span<const double> a, std::span<const double> b, const std::array<double, block>& y,
              const std::array<double, block>& first, std::span<std::array<double, block>> out);

/// coefficients[k] += sum over the rings of p[k] x even or odd, as k is.
void project_rings(std::span<const std::array<double, block>> p, const std::array<Parts, block>& even,
                   const std::array<Parts, block>& odd, std::span<Parts> coefficients);

/// even[ring] = sum over even k of p[k] x coefficients[k]; odd likewise.
void evaluate_rings(std::span<const std::array<double, block>> p, std::span<const Parts> coefficients,
                    std::array<Parts, block>& even, std::array<Parts, block>& odd);

}  // namespace envmap::prefiltering

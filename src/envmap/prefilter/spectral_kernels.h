/// @file
/// Inner loops of the spectral method, by SIMD: the same bits on every CPU.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace envmap {

/// Points of an interpolation, each way.
inline constexpr std::size_t taps = 8;

/// Samples of red, green and blue on rings of equal distance: colatitude (ring + 0.5) pi / rings, longitude 2 pi column / columns.
struct RingGrid {
  int rings = 0, columns = 0;  ///< Columns a power of two, twice the rings.
  std::vector<double> values;  ///< By ring, channel and column; `taps` columns more, for stencils that run over.

  RingGrid() = default;
  explicit RingGrid(int n) : rings(n / 2), columns(n), values(static_cast<std::size_t>(rings) * 3 * stride(), 0) {}
  [[nodiscard]] std::size_t stride() const { return static_cast<std::size_t>(columns) + taps; }
  [[nodiscard]] double* row(int ring, std::size_t channel) {
    return &values[(static_cast<std::size_t>(ring) * 3 + channel) * stride()];
  }
};

/// Where a direction lies among the samples, and the weights of Lagrange's polynomial there.
struct Stencil {
  int ring, column;  ///< The first ones; rings beyond a pole are those on its other side, half a turn on.
  std::array<double, taps> down, across;
};

/// @param u,v of the latlong image of the grid, [0,1].
Stencil stencil_at(const RingGrid& grid, double u, double v);

/// Adds a colour x a stencil: what interpolation does, transposed.
void spread(RingGrid& grid, const Stencil& at, const std::array<double, 3>& colour);

std::array<double, 3> interpolate(RingGrid& grid, const Stencil& at);

/// Real and imaginary parts of the three channels, and two that are 0.
using Parts = std::array<double, 8>;
inline constexpr std::size_t block = 8;  ///< Rings at once.

/// Normalised associated Legendre functions of one m on a block of rings, by P_l = a_l (y P_{l-1} - b_l P_{l-2}).
/// @param first P_m. @param a,b at l - m. @param out l - m = 0, 1, ... a.size() - 1.
void legendre(std::span<const double> a, std::span<const double> b, const std::array<double, block>& y,
              const std::array<double, block>& first, std::span<std::array<double, block>> out);

/// coefficients[k] += sum over the rings of p[k] x even or odd, as k is.
void project_rings(std::span<const std::array<double, block>> p, const std::array<Parts, block>& even,
                   const std::array<Parts, block>& odd, std::span<Parts> coefficients);

/// even[ring] = sum over even k of p[k] x coefficients[k]; odd likewise.
void evaluate_rings(std::span<const std::array<double, block>> p, std::span<const Parts> coefficients,
                    std::array<Parts, block>& even, std::array<Parts, block>& odd);

}  // namespace envmap

/// @file
/// Gauss points of texels, and of pieces of them, that the cores of lobes are summed over.
#pragma once

#include <array>
#include <cstddef>

namespace envmap::prefiltering {

/// A texel or part of one in two coordinates that are 0 at the output's direction: small numbers keep their digits.
struct Piece {
  double x0, x1, y0, y1;
};

/// Gauss's rule of four points (Abramowitz and Stegun 1964, table 25.4).
inline constexpr std::array<double, 4> node = {-0.861136311594052575, -0.339981043584856265, 0.339981043584856265,
                                               0.861136311594052575};
inline constexpr std::array<double, 4> node_weight = {0.347854845137453857, 0.652145154862546143, 0.652145154862546143,
                                                      0.347854845137453857};

/// Each way: point 4 row + column.
struct SixteenPoints {
  alignas(64) float x[16], y[16], weight[16];
  constexpr SixteenPoints() : x(), y(), weight() {
    for (std::size_t k = 0; k < 16; ++k)
      x[k] = float(node[k % 4]), y[k] = float(node[k / 4]), weight[k] = float(node_weight[k % 4] * node_weight[k / 4]);
  }
};
inline constexpr SixteenPoints points;

/// The rule on equal panels of a texel's side, from 0 to 1.
struct Rule {
  static constexpr std::size_t most = 16;
  std::size_t count;
  std::array<double, most> at{}, weight{};

  explicit Rule(std::size_t panels) : count(4 * panels) {
    for (std::size_t k = 0; k < count; ++k) {
      at[k] = (double(k / 4) + 0.5 + 0.5 * node[k % 4]) / double(panels);
      weight[k] = 0.5 * node_weight[k % 4] / double(panels);
    }
  }
};

}  // namespace envmap::prefiltering

/// @file
/// Gauss points of texels, and of pieces of them, that the cores of lobes are summed over.
#pragma once

#include <algorithm>
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

/// Points of a texel's side, from 0 to 1: Gauss's on equal panels.
struct Rule {
  static constexpr std::size_t most = 16;
  std::size_t count;
  double panel;  ///< A part of the side.
  std::array<double, most> at{}, weight{};
  alignas(64) float at_lanes[most] = {}, weight_lanes[most] = {};  ///< The same; beyond, the last place and no weight.

  template <std::size_t N>
  constexpr Rule(const std::array<double, N>& nodes, const std::array<double, N>& weights, std::size_t panels)
      : count(N * panels), panel(1.0 / double(panels)) {
    for (std::size_t k = 0; k < count; ++k) {
      at[k] = (double(k / N) + 0.5 + 0.5 * nodes[k % N]) * panel;
      weight[k] = 0.5 * weights[k % N] * panel, weight_lanes[k] = float(weight[k]);
    }
    for (std::size_t k = 0; k < most; ++k) at_lanes[k] = float(at[std::min(k, count - 1)]);
  }
};

inline constexpr double two_node = 0.577350269189625765, three_node = 0.774596669241483377;
/// Two or three points of a side: for texels far from a pole, or where a lobe is flat.
inline constexpr Rule two_points(std::array{-two_node, two_node}, std::array{1.0, 1.0}, 1),
    three_points(std::array{-three_node, 0.0, three_node}, std::array{5.0 / 9, 8.0 / 9, 5.0 / 9}, 1);
/// Four points on each of 1, 2 or 4 panels.
inline constexpr std::array<Rule, 3> four_points{Rule(node, node_weight, 1), Rule(node, node_weight, 2),
                                                 Rule(node, node_weight, 4)};

/// sin(t) and 1 - cos(t) of small angles, without loss of digits. @param t up to 0.4, to 1e-16.
struct SmallAngle {
  double sine, versine;
  explicit SmallAngle(double t) {
    const double tt = t * t;
    // Factors from one term of the series to the next.
    constexpr double s[] = {1.0 / 6, 1.0 / 20, 1.0 / 42, 1.0 / 72, 1.0 / 110, 1.0 / 156};
    constexpr double v[] = {1.0 / 12, 1.0 / 30, 1.0 / 56, 1.0 / 90, 1.0 / 132, 1.0 / 182};
    double a = 1, b = 1;
    for (std::size_t k = 6; k-- > 0;) a = 1 - s[k] * tt * a, b = 1 - v[k] * tt * b;
    sine = t * a, versine = 0.5 * tt * b;
  }
};

}  // namespace envmap::prefiltering

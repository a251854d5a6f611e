/// @file
/// Gauss points of texels and of pieces of texels, over which the near field of a narrow lobe is summed.
///
/// All points are constants in float lanes. Coordinates are relative to the output's direction, so that a lobe of a
/// thousandth of a texel keeps its digits in float.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "envmap/maths/quadrature.h"

namespace envmap::prefiltering {

/// A texel or part of one in two coordinates that are 0 at the output's direction.
struct Piece {
  double x0, x1, y0, y1;
};

/// Four Gauss points each way: point 4 row + column.
struct SixteenPoints {
  alignas(64) float x[16], y[16], weight[16];
  constexpr SixteenPoints() : x(), y(), weight() {
    constexpr auto& gauss = quadrature::gauss_4;
    for (std::size_t k = 0; k < 16; ++k) {
      x[k] = float(gauss.node[k % 4]), y[k] = float(gauss.node[k / 4]);
      weight[k] = float(gauss.weight[k % 4] * gauss.weight[k / 4]);
    }
  }
};
inline constexpr SixteenPoints points;

/// Gauss points of a texel's side, from 0 to 1.
struct SideRule {
  static constexpr std::size_t most = 16;
  std::size_t count;
  std::array<double, most> at{}, weight{};
  /// Places and weights as floats. After the last point its place repeats, without weight.
  alignas(64) float at_lanes[most] = {}, weight_lanes[most] = {};

  template <int N>
  constexpr explicit SideRule(const quadrature::Rule<N>& rule) : count(N) {
    for (std::size_t k = 0; k < count; ++k)
      at[k] = 0.5 + 0.5 * rule.node[k], weight[k] = 0.5 * rule.weight[k], weight_lanes[k] = float(weight[k]);
    for (std::size_t k = 0; k < most; ++k) at_lanes[k] = float(at[std::min(k, count - 1)]);
  }
};

/// Two or three points of a side: for texels far from a pole, or where a lobe is flat. Four: nearer to it.
inline constexpr SideRule two_points(quadrature::gauss_2), three_points(quadrature::gauss_3),
    four_points(quadrature::gauss_4);

/// sin(t) and 1 - cos(t) of a small angle, without loss of digits: to 1e-16 for t up to 0.4.
struct SmallAngle {
  double sine, versine;
  explicit SmallAngle(double t) {
    const double tt = t * t;
    // The ratios of successive terms of the series.
    constexpr double s[] = {1.0 / 6, 1.0 / 20, 1.0 / 42, 1.0 / 72, 1.0 / 110, 1.0 / 156};
    constexpr double v[] = {1.0 / 12, 1.0 / 30, 1.0 / 56, 1.0 / 90, 1.0 / 132, 1.0 / 182};
    double a = 1, b = 1;
    for (std::size_t k = 6; k-- > 0;) a = 1 - s[k] * tt * a, b = 1 - v[k] * tt * b;
    sine = t * a, versine = 0.5 * tt * b;
  }
};

}  // namespace envmap::prefiltering

/// @file
/// Point samples of one level.
#pragma once

#include <array>
#include <cmath>
#include <span>

#include "envmap/sample/padded_level.h"

namespace envmap {

/// The texel that contains the location.
Colour nearest(const PaddedLevel& level, const Location<double>& at);

/// The seamless bilinear reconstruction: what this project takes the continuous environment of a map to be.
inline Colour bilinear(const PaddedLevel& level, const Location<double>& at) {
  const double x = at.u * level.width() - 0.5, y = at.v * level.height() - 0.5;
  const double left = std::floor(x), top = std::floor(y);
  const float fx = float(x - left), fy = float(y - top);
  const Colour* a = level.texel(at.face, int(left), int(top));
  const Colour* b = a + level.stride();
  // Two weights a tap, not a + f (b - a): beside a sun of 1e9 the difference would swallow a dim neighbour.
  const Colour upper = (1 - fx) * a[0] + fx * a[1], lower = (1 - fx) * b[0] + fx * b[1];
  return (1 - fy) * upper + fy * lower;
}

/// Weights of the texels at -1, 0, 1 and 2 for a place t beyond the one at 0 (Catmull and Rom 1974; Keys 1981 with a =
/// -1/2): exact for quadratics.
template <class T>
std::array<T, 4> catmull_rom(double t) {
  const double t2 = t * t, t3 = t2 * t;
  return {T(0.5 * (-t3 + 2 * t2 - t)), T(0.5 * (3 * t3 - 5 * t2 + 2)), T(0.5 * (-3 * t3 + 4 * t2 + t)),
          T(0.5 * (t3 - t2))};
}

/// Catmull-Rom: 4 x 4 texels, passes through them. Its negative lobes would ring round a sun and go below 0: the value
/// stays in the range of the 4 texels around the place.
Colour bicubic(const PaddedLevel& level, const Location<double>& at);

/// The same for many locations; bilinear a vector at a time, with the same result to the last bit.
void sample_nearest(const PaddedLevel& level, std::span<const Location<double>> at, std::span<Colour> out);
void sample_bilinear(const PaddedLevel& level, std::span<const Location<double>> at, std::span<Colour> out);
void sample_bicubic(const PaddedLevel& level, std::span<const Location<double>> at, std::span<Colour> out);

}  // namespace envmap

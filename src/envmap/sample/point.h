/// @file
/// Point samples of one level.
#pragma once

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

/// The same for many locations; bilinear a vector at a time, with the same result to the last bit.
void sample_nearest(const PaddedLevel& level, std::span<const Location<double>> at, std::span<Colour> out);
void sample_bilinear(const PaddedLevel& level, std::span<const Location<double>> at, std::span<Colour> out);

}  // namespace envmap

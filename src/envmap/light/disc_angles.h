/// @file
/// The angles of a disc of even radiance on the sphere. Radii are in radians, and below pi / 2.
#pragma once

#include <algorithm>
#include <cmath>

#include "envmap/maths/portable.h"
#include "envmap/maths/vector.h"

namespace envmap {

inline double solid_angle_of_disc(double radius) {
  const double s = portable::sin(0.5 * radius);
  return 4 * pi * s * s;
}

/// The radius of the disc that has a solid angle.
inline double radius_of_disc(double solid_angle) {
  return 2 * portable::asin(std::sqrt(std::min(1.0, solid_angle / (4 * pi))));
}

/// The irradiance of a plane that faces a disc, over the disc's flux.
inline double irradiance_of_flux(double radius) { return 0.5 * (1 + portable::cos(radius)); }

}  // namespace envmap

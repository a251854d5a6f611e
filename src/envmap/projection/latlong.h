/// @file
/// Latlong (equirectangular) maps: longitude across, latitude down, +Z at the centre, +X to the left of it.
/// Source: OpenEXR's ImfEnvmap.h.
#pragma once

#include <algorithm>
#include <cmath>

#include "envmap/maths/portable.h"
#include "envmap/maths/quadrature.h"
#include "envmap/projection/projection.h"

namespace envmap {

struct Latlong {
  static constexpr Projection id = Projection::latlong;
  static constexpr const char* name = "latlong";
  static constexpr int faces = 1, aspect = 2;
  static constexpr double span = 180, stretch = pi / 2;  // Across it is pi, on faces twice as wide.
  static constexpr bool on_disc = false, filled = true, has_forward = true;

  template <class T>
  static Vec3<T> direction(int /*face*/, T u, T v) {
    const double longitude = 2 * (0.5 - u), latitude = 0.5 - v;  // Over pi.
    const double c = portable::cos_pi(latitude);
    return Vec3<T>(c * portable::sin_pi(longitude), portable::sin_pi(latitude), c * portable::cos_pi(longitude));
  }

  template <class T>
  static Location<T> locate(const Vec3<T>& d) {
    const double x = d.x, y = d.y, z = d.z;
    return {0, static_cast<T>(0.5 - portable::atan2(x, z) / (2 * pi)),
            static_cast<T>(0.5 - portable::atan2(y, std::sqrt(x * x + z * z)) / pi)};
  }

  static double density(double /*u*/, double v) { return 2 * pi * pi * portable::sin_pi(v); }

  /// Difference of the sines of two latitudes, as a product: no cancellation in thin rows at the poles.
  static double solid_angle(const Rect& r) {
    const double middle = 0.5 * (r.v0 + r.v1);
    return 4 * pi * (r.u1 - r.u0) * portable::sin_pi(std::min(middle, 1 - middle)) *
           portable::sin_pi(0.5 * (r.v1 - r.v0));
  }
};

}  // namespace envmap

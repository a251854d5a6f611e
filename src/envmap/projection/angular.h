/// @file
/// Angular maps (light probes): the angle from +Z grows in proportion to the radius; the rim is -Z.
/// Source: Debevec 1998, "Rendering synthetic objects into real scenes".
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "envmap/maths/portable.h"
#include "envmap/maths/quadrature.h"
#include "envmap/projection/projection.h"

namespace envmap {

struct Angular {
  static constexpr Projection id = Projection::angular;
  static constexpr const char* name = "angular";
  static constexpr int faces = 1, aspect = 1;
  static constexpr double span = 360, stretch = std::numeric_limits<double>::infinity();
  static constexpr bool on_disc = true, filled = false, has_forward = true;

  /// sin(pi r) / r for r in [0,2], by the nearer zero of the sine so that the rim keeps its digits.
  static double sine_over_r(double r) {
    if (r < 1e-8) return pi;
    return portable::sin_pi(r < 0.5 ? r : 1 - r) / r;
  }

  template <class T>
  static Vec3<T> direction(int /*face*/, T u, T v) {
    const double s = 2.0 * u - 1, t = 1 - 2.0 * v;
    const double r = std::sqrt(s * s + t * t), k = sine_over_r(r);
    return Vec3<T>(-s * k, t * k, portable::cos_pi(r));
  }

  /// -Z itself: the right of the rim.
  template <class T>
  static Location<T> locate(const Vec3<T>& d) {
    const double x = d.x, y = d.y, z = d.z, h = portable::hypot(x, y);
    double s = z > 0 ? 0 : 1, t = 0;
    if (h > 0) {
      const double scale = portable::atan2(h, z) / (pi * h);
      s = -x * scale;
      t = y * scale;
    }
    return {0, static_cast<T>(0.5 + 0.5 * s), static_cast<T>(0.5 - 0.5 * t)};
  }

  static double density(double u, double v) {
    const double s = 2 * u - 1, t = 1 - 2 * v, r = std::sqrt(s * s + t * t);
    return r < 1 ? 4 * pi * sine_over_r(r) : 0;
  }

  static double solid_angle(const Rect& r) {
    return quadrature::inside_disc({2 * r.u0 - 1, 1 - 2 * r.v1, 2 * r.u1 - 1, 1 - 2 * r.v0},
                                   [](double s, double t) { return pi * sine_over_r(std::sqrt(s * s + t * t)); });
  }
};

}  // namespace envmap

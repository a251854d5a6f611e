/// @file
/// Sphere maps: the mirror ball seen from afar along -Z; OpenGL's GL_SPHERE_MAP. Equal-area; all of the rim is -Z.
/// Source: Haeberli and Segal 1993, "Texture mapping as a fundamental drawing primitive"; OpenGL 4.6 compat. 12.1.3.
#pragma once

#include <cmath>
#include <limits>

#include "envmap/maths/portable.h"
#include "envmap/maths/quadrature.h"
#include "envmap/projection/projection.h"

namespace envmap {

struct Sphere {
  static constexpr Projection id = Projection::sphere;
  static constexpr const char* name = "sphere";
  static constexpr int faces = 1, aspect = 1;
  static constexpr double span = 360, stretch = std::numeric_limits<double>::infinity();
  static constexpr bool on_disc = true, filled = false, has_forward = false;

  /// With r = sin(a/2), a the angle from +Z. Beyond the rim the angle goes on past -Z: the point at radius r holds the
  /// direction of the point opposite at radius 2 - r.
  template <class T>
  static Vec3<T> direction(int /*face*/, T u, T v) {
    double s = 2.0 * u - 1, t = 1 - 2.0 * v;
    if (const double r = std::sqrt(s * s + t * t); r > 1) {
      s *= (r - 2) / r;
      t *= (r - 2) / r;
    }
    // 1 - s^2 - t^2 decides how far from -Z we are. The squares of s and t rounded to 26 bits are exact, as is what
    // they leave of 1; s^2 is that square and (s - head)(s + head).
    const double s_head = (s + 0x1.8p27) - 0x1.8p27, t_head = (t + 0x1.8p27) - 0x1.8p27;
    const double tails = (s - s_head) * (s + s_head) + (t - t_head) * (t + t_head);
    const double rest = ((1 - s_head * s_head) - t_head * t_head) - tails;
    const double k = std::sqrt(std::max(0.0, rest));
    return Vec3<T>(2 * k * s, 2 * k * t, 2 * rest - 1);
  }

  /// x / m with m^2 = 2(1+z); behind, where 1+z cancels, the same as x/h sqrt((1-z)/2). -Z itself:
  /// the right of the rim.
  template <class T>
  static Location<T> locate(const Vec3<T>& d) {
    const double x = d.x, y = d.y, z = d.z;
    double s = 1, t = 0;
    if (z > 0) {
      const double scale = 1 / std::sqrt(x * x + y * y + (z + 1) * (z + 1));
      s = x * scale;
      t = y * scale;
    } else if (const double h = portable::hypot(x, y); h > 0) {
      const double r = std::sqrt(0.5 * (1 - z));
      s = x / h * r;
      t = y / h * r;
    }
    return {0, static_cast<T>(0.5 + 0.5 * s), static_cast<T>(0.5 - 0.5 * t)};
  }

  static double density(double u, double v) {
    const double s = 2 * u - 1, t = 1 - 2 * v;
    return s * s + t * t < 1 ? 16 : 0;
  }

  static double solid_angle(const Rect& r) {
    return quadrature::inside_disc({2 * r.u0 - 1, 1 - 2 * r.v1, 2 * r.u1 - 1, 1 - 2 * r.v0},
                                   [](double, double) { return 4.0; });
  }
};

}  // namespace envmap

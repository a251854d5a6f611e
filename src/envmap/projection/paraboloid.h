/// @file
/// Dual-paraboloid maps: front half (+Z) left, back half (-Z) right. The unit disc of each square carries the weight;
/// the corners repeat what the other half shows, so that filters read on across the rim.
/// Source: Heidrich and Seidel 1998, "View-independent environment maps".
#pragma once

#include <cmath>

#include "envmap/maths/quadrature.h"
#include "envmap/projection/projection.h"

namespace envmap {

struct Paraboloid {
  static constexpr Projection id = Projection::paraboloid;
  static constexpr const char* name = "paraboloid";
  static constexpr int faces = 2, aspect = 1;
  static constexpr double span = 180, stretch = 2;
  static constexpr bool on_disc = true, filled = true, has_forward = false;

  template <class T>
  static Vec3<T> direction(int face, T u, T v) {
    const double s = 2.0 * u - 1, t = 1 - 2.0 * v;
    const double rr = s * s + t * t, scale = 1 / (1 + rr);
    return Vec3<T>(2 * s * scale, 2 * t * scale, (face == 0 ? 1 - rr : rr - 1) * scale);
  }

  template <class T>
  static Location<T> locate(const Vec3<T>& d) {
    const double x = d.x, y = d.y, half = 0.5 / (1 + std::abs(double(d.z)));
    return {d.z < 0, static_cast<T>(0.5 + half * x), static_cast<T>(0.5 - half * y)};
  }

  static double density(double u, double v) {
    const double s = 2 * u - 1, t = 1 - 2 * v, rr = s * s + t * t;
    return rr < 1 ? 16 / ((1 + rr) * (1 + rr)) : 0;
  }

  static double solid_angle(const Rect& r) {
    return quadrature::inside_disc({2 * r.u0 - 1, 1 - 2 * r.v1, 2 * r.u1 - 1, 1 - 2 * r.v0}, [](double s, double t) {
      const double m = 1 + s * s + t * t;
      return 4 / (m * m);
    });
  }
};

}  // namespace envmap

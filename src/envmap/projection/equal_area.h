/// @file
/// Equal-area octahedral maps: every texel spans the same solid angle.
/// Source: Clarberg 2008, "Fast equal-area mapping of the (hemi)sphere using SIMD".
#pragma once

#include <cmath>

#include "envmap/maths/portable.h"
#include "envmap/maths/quadrature.h"
#include "envmap/projection/octahedron.h"

namespace envmap {

struct EqualArea : octahedron::Facets {
  static constexpr Projection id = Projection::equal_area;
  static constexpr const char* name = "equal-area";
  static constexpr int faces = 1, aspect = 1;
  static constexpr double span = 180, stretch = 3.07;  // The stretch where a fold of the diamond meets an axis.
  static constexpr bool on_disc = false, filled = true, has_forward = false;

  /// With r = a + b: the height is 1 - r^2, and of a quarter turn from X to Z goes as much as b is of r.
  template <class T>
  static Vec3<T> direction(int /*face*/, T u, T v) {
    const Point2 in = octahedron::wrapped(2.0 * u - 1, 1 - 2.0 * v);
    const auto [a, b, below] = octahedron::folded(in.x, in.y);
    const double r = a + b, turn = r > 0 ? 0.5 * b / r : 0, level = r * std::sqrt(2 - r * r), up = (1 - r) * (1 + r);
    return Vec3<T>(std::copysign(level * portable::cos_pi(turn), in.x), below ? -up : up,
                   std::copysign(level * portable::sin_pi(turn), in.y));
  }

  /// r = sqrt(1 - |y|), without cancellation.
  template <class T>
  static Location<T> locate(const Vec3<T>& d) {
    const Direction wide(d);
    return octahedron::unfolded<T>(place(std::abs(wide.x), wide.y, std::abs(wide.z)), d.x, d.z);
  }

  static double density(double /*u*/, double /*v*/) { return 4 * pi; }
  static double solid_angle(const Rect& r) { return 4 * pi * (r.u1 - r.u0) * (r.v1 - r.v0); }

  // ---- facets ----

  /// Beyond the sides by rounding alone.
  static Location<double> continued(int facet, const Direction& d) {
    const Direction sign = octahedron::signs(facet), in = sign * d;
    octahedron::Place p = place(std::max(in.x, 0.0), std::max(in.y, 0.0), std::max(in.z, 0.0));
    p.below = sign.y < 0;
    return octahedron::unfolded<double>(p, sign.x, sign.z);
  }
  static double continued_density(int /*facet*/, double /*u*/, double /*v*/) { return 4 * pi; }

 private:
  static octahedron::Place place(double x, double y, double z) {
    const double r = std::sqrt((x * x + z * z) / (1 + std::abs(y))), b = r * (2 / pi) * portable::atan2(z, x);
    return {r - b, b, y < 0};
  }
};

}  // namespace envmap

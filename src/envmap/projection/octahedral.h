/// @file
/// Octahedral maps: the sphere projected from its middle onto an octahedron, whose faces are unfolded into a square.
/// Source: Engelhardt and Dachsbacher 2008, "Octahedron environment maps".
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "envmap/maths/polygon.h"
#include "envmap/maths/portable.h"
#include "envmap/maths/quadrature.h"
#include "envmap/projection/octahedron.h"

namespace envmap {

struct Octahedral : octahedron::Facets {
  static constexpr Projection id = Projection::octahedral;
  static constexpr const char* name = "octahedral";
  static constexpr int faces = 1, aspect = 1;
  static constexpr double span = 180, stretch = 3;  // The stretch in the middle of a facet, along the diagonal.
  static constexpr bool on_disc = false, filled = true, has_forward = false;

  template <class T>
  static Vec3<T> direction(int /*face*/, T u, T v) {
    const Point2 in = octahedron::wrapped(2.0 * u - 1, 1 - 2.0 * v);
    const auto [a, b, below] = octahedron::folded(in.x, in.y);
    const double up = 1 - a - b, unit = 1 / std::sqrt(a * a + up * up + b * b);
    return Vec3<T>(std::copysign(a * unit, in.x), below ? -up * unit : up * unit, std::copysign(b * unit, in.y));
  }

  template <class T>
  static Location<T> locate(const Vec3<T>& d) {
    const double x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z), k = 1 / (x + y + z);
    return octahedron::unfolded<T>({x * k, z * k, d.y < 0}, d.x, d.z);
  }

  /// 4 / r^3, r the distance of the octahedron's point from the middle.
  static double density(double u, double v) {
    const Point2 in = octahedron::wrapped(2 * u - 1, 1 - 2 * v);
    return density_in_facet(octahedron::folded(in.x, in.y));
  }

  // ---- facets, over whose sides their planes go on ----

  static Location<double> continued(int facet, const Direction& d) {
    const Direction sign = octahedron::signs(facet), in = sign * d;
    const double k = 1 / (in.x + in.y + in.z), a = in.x * k, b = in.z * k;
    const double s = sign.x * (sign.y < 0 ? 1 - b : a), t = sign.z * (sign.y < 0 ? 1 - a : b);
    return {0, 0.5 + 0.5 * s, 0.5 - 0.5 * t};
  }

  static double continued_density(int facet, double u, double v) {
    const Direction sign = octahedron::signs(facet);
    const double a = sign.x * (2 * u - 1), b = sign.z * (1 - 2 * v);
    return density_in_facet(sign.y < 0 ? octahedron::Place{1 - b, 1 - a, true} : octahedron::Place{a, b, false});
  }

  // ---- solid angles ----

  /// Facet by facet: of what lies in a quarter of the square, a part above and a part below the diamond's side.
  static double solid_angle(const Rect& r) {
    const double s0 = 2 * r.u0 - 1, s1 = 2 * r.u1 - 1, t0 = 1 - 2 * r.v1, t1 = 1 - 2 * r.v0;
    const auto from_axis = [](double low, double high) {  // Parts on either side of 0, by their distance from it.
      return std::array<Point2, 2>{{{std::max(low, 0.0), high}, {std::max(-high, 0.0), -low}}};
    };
    double sum = 0;
    for (const Point2& a : from_axis(s0, s1))
      for (const Point2& b : from_axis(t0, t1))
        if (a.x < a.y && b.x < b.y) sum += in_quarter(a.x, b.x, a.y, b.y);
    return sum;
  }

 private:
  static double density_in_facet(const octahedron::Place& p) {
    const double up = 1 - p.a - p.b, rr = p.a * p.a + up * up + p.b * p.b;
    return 4 / (rr * std::sqrt(rr));
  }

  /// The rectangle [a0,a1] x [b0,b1] of the quarter a, b >= 0.
  static double in_quarter(double a0, double b0, double a1, double b1) {
    if (a1 + b1 <= 1) return on_plane(a0, b0, a1, b1);
    if (a0 + b0 >= 1) return on_plane(1 - b1, 1 - a1, 1 - b0, 1 - a0);
    const std::vector<Point2> corners{{a0, b0}, {a1, b0}, {a1, b1}, {a0, b1}};
    std::vector<Point2> above, beyond;
    cut(corners, -1, -1, 1, above);
    cut(corners, 1, 1, -1, beyond);
    for (Point2& p : beyond) p = {1 - p.y, 1 - p.x};
    return on_plane(above) + on_plane(beyond);
  }

  /// Small texels faster and as well by the density, whose poles are 0.4 away: N points err by about (side / 1.6)^(2N).
  static double on_plane(double a0, double b0, double a1, double b1) {
    if (const double side = std::max(a1 - a0, b1 - b0); side < 0.004) {
      const auto f = [](double a, double b) { return 0.25 * density_in_facet({a, b, false}); };
      return side < 0.0004 ? quadrature::rectangle<2>({a0, b0, a1, b1}, f)
                           : quadrature::rectangle<3>({a0, b0, a1, b1}, f);
    }
    return on_plane(std::array<Point2, 4>{{{a0, b0}, {a1, b0}, {a1, b1}, {a0, b1}}});
  }

  /// Of a convex polygon (a,b) on the plane a + b + y = 1, triangle by triangle: Van Oosterom and Strackee 1983, "The
  /// solid angle of a plane triangle", tan(half) = det / (...). The determinant of corners on that plane is twice the
  /// triangle's area in a and b, so nothing cancels however small it is.
  static double on_plane(std::span<const Point2> corners) {
    const auto at = [&](std::size_t k) {
      return Direction(corners[k].x, 1 - corners[k].x - corners[k].y, corners[k].y);
    };
    double sum = 0;
    for (std::size_t k = 2; k < corners.size(); ++k) {
      const Direction p = at(0), q = at(k - 1), r = at(k);
      const Point2 pq = corners[k - 1] - corners[0], pr = corners[k] - corners[0];
      const double det = std::abs(pq.x * pr.y - pq.y * pr.x);
      const double lp = glm::length(p), lq = glm::length(q), lr = glm::length(r);
      sum += 2 * portable::atan2(det, lp * lq * lr + glm::dot(p, q) * lr + glm::dot(q, r) * lp + glm::dot(p, r) * lq);
    }
    return sum;
  }
};

}  // namespace envmap

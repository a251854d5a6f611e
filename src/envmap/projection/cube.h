/// @file
/// Cube maps: six squares +X -X +Y -Y +Z -Z, seen from inside. Source: OpenEXR's ImfEnvmap.h.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "envmap/maths/portable.h"
#include "envmap/maths/quadrature.h"
#include "envmap/projection/projection.h"

namespace envmap {

struct Cube {
  static constexpr Projection id = Projection::cube;
  static constexpr const char* name = "cube";
  static constexpr int faces = 6, aspect = 1;
  static constexpr double span = 90, stretch = 1;
  static constexpr bool on_disc = false, filled = true, has_forward = false;

  struct Axes {
    Direction forward, right, up;
  };
  static constexpr std::array<Axes, 6> axes{{{{1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
                                             {{-1, 0, 0}, {0, 0, -1}, {0, 1, 0}},
                                             {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
                                             {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}},
                                             {{0, 0, 1}, {-1, 0, 0}, {0, 1, 0}},
                                             {{0, 0, -1}, {1, 0, 0}, {0, 1, 0}}}};

  template <class T>
  static Vec3<T> direction(int face, T u, T v) {
    const double s = 2.0 * u - 1, t = 1 - 2.0 * v;
    const Axes& a = axes[face];
    return Vec3<T>((a.forward + s * a.right + t * a.up) / std::sqrt(1 + s * s + t * t));
  }

  /// On an edge or corner the first of X, Y, Z wins.
  template <class T>
  static Location<T> locate(const Vec3<T>& d) {
    const double x = std::abs(d.x), y = std::abs(d.y), z = std::abs(d.z);
    const int axis = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    return continued(2 * axis + (d[axis] < 0), d);
  }

  /// Where a direction in front of a face meets the plane of the face: u and v may lie beyond [0,1].
  template <class T>
  static Location<T> continued(int face, const Vec3<T>& d) {
    const Axes& a = axes[face];
    const Direction wide(d);
    const double half = 0.5 / std::abs(wide[face / 2]);
    return {face, static_cast<T>(0.5 + half * glm::dot(wide, a.right)),
            static_cast<T>(0.5 - half * glm::dot(wide, a.up))};
  }

  static constexpr int facets = faces;
  static int facet(const Location<double>& at) { return at.face; }
  static int facet(const Direction& d) { return locate(d).face; }
  static std::array<Direction, 4> sides(int facet) {
    const Axes& a = axes[facet];
    return {a.forward + a.right, a.forward - a.right, a.forward + a.up, a.forward - a.up};
  }
  static double continued_density(int /*facet*/, double u, double v) { return density(u, v); }

  static double density(double u, double v) {
    const double s = 2 * u - 1, t = 1 - 2 * v, m = 1 + s * s + t * t;
    return 4 / (m * std::sqrt(m));
  }

  /// Two spherical triangles by Van Oosterom and Strackee 1983: tan(half) = det / (...). The determinant of corners at
  /// height 1 is the rectangle's area itself, so nothing cancels however small the texel.
  /// Small texels faster and as well by the density: N points err by about (side / 4)^(2N).
  static double solid_angle(const Rect& r) {
    if (const double side = 2 * std::max(r.u1 - r.u0, r.v1 - r.v0); side < 0.01) {
      const auto f = [](double u, double v) { return density(u, v); };
      return side < 0.001 ? quadrature::rectangle<2>(r, f) : quadrature::rectangle<3>(r, f);
    }
    const double s0 = 2 * r.u0 - 1, s1 = 2 * r.u1 - 1, t0 = 1 - 2 * r.v1, t1 = 1 - 2 * r.v0;
    const Direction a{s0, t0, 1}, b{s1, t0, 1}, c{s1, t1, 1}, d{s0, t1, 1};
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c), ld = glm::length(d);
    const double area = 4 * (r.u1 - r.u0) * (r.v1 - r.v0), ac = glm::dot(a, c);
    const double abc = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + ac * lb;
    const double acd = la * lc * ld + ac * ld + glm::dot(c, d) * la + glm::dot(a, d) * lc;
    return 2 * (portable::atan2(area, abc) + portable::atan2(area, acd));
  }
};

}  // namespace envmap

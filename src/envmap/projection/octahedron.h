/// @file
/// The net that octahedral maps share: a square, folded along the lines between the middles of its sides so that its
/// four corners meet. +Y is the middle, -Y the corners, the middles of the sides are +X (right), +Z (top), -X and -Z:
/// seen from inside, as the +Y face of a cube. The upper half is the diamond |s| + |t| <= 1, the lower half the corners
/// beyond it.
/// Source: Praun and Hoppe 2003, "Spherical parametrization and remeshing".
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "envmap/projection/projection.h"

namespace envmap::octahedron {

/// A place within its facet, an eighth of the sphere: a towards +-X, b towards +-Z, both from 0, with a + b <= 1.
struct Place {
  double a, b;
  bool below;
};

/// Beyond an edge, the map continues with the same edge, turned by half a turn about its midpoint. @return the place in
/// the square.
inline Point2 wrapped(double s, double t) {
  if (std::abs(s) <= 1 && std::abs(t) <= 1) return {s, t};
  s -= 4 * std::nearbyint(0.25 * s);
  t -= 4 * std::nearbyint(0.25 * t);
  if (std::abs(s) > 1) {
    s = std::copysign(2, s) - s;
    t = -t;
  }
  if (std::abs(t) > 1) {
    t = std::copysign(2, t) - t;
    s = -s;
  }
  return {s, t};
}

/// The same for texels of an n x n map.
inline std::array<int, 2> wrapped_texel(int i, int j, int n) {
  const auto period = [n](int k) { return ((k % (2 * n)) + 2 * n) % (2 * n); };
  i = period(i);
  const bool over_side = i >= n;
  if (over_side) i = 2 * n - 1 - i, j = n - 1 - j;
  j = period(j);
  if (j >= n) j = 2 * n - 1 - j, i = n - 1 - i;
  return {i, j};
}

/// Of a place in the square.
inline Place folded(double s, double t) {
  const double a = std::abs(s), b = std::abs(t);
  if (a + b > 1) return {1 - b, 1 - a, true};
  return {a, b, false};
}

/// Back to u and v, in the quarter of x and z. The lower half is the upper one mirrored along the diamond's sides.
template <class T>
Location<T> unfolded(const Place& p, double x, double z) {
  const double s = std::copysign(p.below ? 1 - p.b : p.a, x), t = std::copysign(p.below ? 1 - p.a : p.b, z);
  return {0, static_cast<T>(0.5 + 0.5 * s), static_cast<T>(0.5 - 0.5 * t)};
}

// ---- facets ---------------------------------------------------------------------------------------------------------

/// Within a facet a map is smooth; over its sides it has creases. Bit 0: x < 0, bit 1: z < 0, bit 2: y < 0.
inline constexpr int facets = 8;

inline Direction signs(int facet) { return {facet & 1 ? -1 : 1, facet & 4 ? -1 : 1, facet & 2 ? -1 : 1}; }

inline int facet(const Direction& d) { return int{d.x < 0} | int{d.z < 0} << 1 | int{d.y < 0} << 2; }

inline int facet(const Location<double>& at) {
  const double s = 2 * at.u - 1, t = 1 - 2 * at.v;
  return int{s < 0} | int{t < 0} << 1 | int{std::abs(s) + std::abs(t) > 1} << 2;
}

/// Planes through the middle of the sphere; a facet lies where dot(side, d) >= 0 for all of them.
inline std::array<Direction, 3> sides(int facet) {
  const Direction sign = signs(facet);
  return {{{sign.x, 0, 0}, {0, sign.y, 0}, {0, 0, sign.z}}};
}

/// A place at least `margin` (in s and t) inside its own facet:
/// what is smooth there says how the map is beside a crease.
inline Location<double> inset(const Location<double>& at, double margin) {
  const Point2 in = wrapped(2 * at.u - 1, 1 - 2 * at.v);
  Place p = folded(in.x, in.y);
  margin = std::min(margin, 0.1);
  p.a = std::max(p.a, margin);
  p.b = std::max(p.b, margin);
  const double over = std::max(0.0, p.a + p.b - (1 - 2 * margin));
  p.a -= 0.5 * over;
  p.b -= 0.5 * over;
  p.a = std::clamp(p.a, margin, 1 - 3 * margin);
  p.b = std::clamp(p.b, margin, 1 - 3 * margin);
  return unfolded<double>(p, in.x, in.y);
}

/// What both maps say of their facets.
struct Facets {
  static constexpr int facets = octahedron::facets;
  static int facet(const Location<double>& at) { return octahedron::facet(at); }
  static int facet(const Direction& d) { return octahedron::facet(d); }
  static std::array<Direction, 3> sides(int facet) { return octahedron::sides(facet); }
  static Location<double> inset(const Location<double>& at, double margin) { return octahedron::inset(at, margin); }
};

}  // namespace envmap::octahedron

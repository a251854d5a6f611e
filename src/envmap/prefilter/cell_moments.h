/// @file
/// Pieces of the sphere that are rectangles of a cube or latlong map, and their moments.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>

#include "envmap/maths/portable.h"
#include "envmap/projection/visit.h"

namespace envmap::prefiltering {

/// Calls f with the type of a projection that can be prefiltered as it is; source_cube.h makes all others a cube first.
template <class F>
decltype(auto) visit_source(Projection p, F&& f) {
  if (p == Projection::latlong) return f(Latlong{});
  if (p != Projection::cube) throw std::logic_error("a source is a cube or a latlong map");
  return f(Cube{});
}

/// A symmetric 3 x 3 matrix: xx, xy, xz, yy, yz, zz.
struct Symmetric {
  std::array<double, 6> m{};

  void add_square(const Direction& v, double weight) {
    m[0] += weight * v.x * v.x, m[1] += weight * v.x * v.y, m[2] += weight * v.x * v.z;
    m[3] += weight * v.y * v.y, m[4] += weight * v.y * v.z, m[5] += weight * v.z * v.z;
  }
  void add(const Symmetric& other, double weight) {
    for (std::size_t k = 0; k < m.size(); ++k) m[k] += weight * other.m[k];
  }
  /// Frobenius.
  [[nodiscard]] double norm() const {
    return std::sqrt(m[0] * m[0] + m[3] * m[3] + m[5] * m[5] + 2 * (m[1] * m[1] + m[2] * m[2] + m[4] * m[4]));
  }
};

/// Moments of a piece of the sphere, evenly lit.
struct Moments {
  double solid_angle = 0;
  Direction centre{0};     ///< Mean direction: inside the sphere, by half the variance.
  Symmetric covariance{};  ///< Of directions about the centre.
  double spread = 0;       ///< Cube root of the mean |direction - centre|^3, or a little above.
  double reach = 0;        ///< No direction is farther from the centre.
};

inline std::array<Rect, 4> quarters(const Rect& r) {
  const double u = 0.5 * (r.u0 + r.u1), v = 0.5 * (r.v0 + r.v1);
  return {{{r.u0, r.v0, u, v}, {u, r.v0, r.u1, v}, {r.u0, v, u, r.v1}, {u, v, r.u1, r.v1}}};
}

/// Puts parts together.
inline Moments united(std::span<const Moments> parts) {
  Moments whole;
  for (const Moments& p : parts) {
    whole.solid_angle += p.solid_angle;
    whole.centre += p.solid_angle * p.centre;
  }
  if (whole.solid_angle <= 0) return {};
  whole.centre /= whole.solid_angle;
  double cubes = 0;
  for (const Moments& p : parts) {
    const Direction off = p.centre - whole.centre;
    const double share = p.solid_angle / whole.solid_angle, distance = glm::length(off);
    whole.covariance.add(p.covariance, share);
    whole.covariance.add_square(off, share);
    const double far = p.spread + distance;
    cubes += share * far * far * far;
    whole.reach = std::max(whole.reach, p.reach + distance);
  }
  whole.spread = portable::cbrt(cubes);
  return whole;
}

/// 2 x 2 Gauss points of a rectangle with their solid angles.
template <class P>
void gauss_points(int face, const Rect& r, std::array<Direction, 4>& points, std::array<double, 4>& weights) {
  constexpr double g = 0.28867513459481287;  // 1 / (2 sqrt(3))
  const double w = r.u1 - r.u0, h = r.v1 - r.v0, u = 0.5 * (r.u0 + r.u1), v = 0.5 * (r.v0 + r.v1);
  if constexpr (std::is_same_v<P, Latlong>) {
    // The two meridians and the two parallels: what Latlong says of each point, in half the time.
    std::array<double, 2> sine, cosine;
    for (std::size_t k = 0; k < 2; ++k) {
      const double longitude = 2 * (0.5 - (u + (k ? g : -g) * w));
      sine[k] = portable::sin_pi(longitude), cosine[k] = portable::cos_pi(longitude);
    }
    for (std::size_t row = 0; row < 2; ++row) {
      const double at_v = v + (row ? g : -g) * h, y = portable::cos_pi(at_v), c = portable::sin_pi(at_v);
      for (std::size_t k = 0; k < 2; ++k) {
        points[2 * row + k] = {c * sine[k], y, c * cosine[k]};
        weights[2 * row + k] = 0.5 * pi * pi * w * h * c;
      }
    }
  } else {
    for (std::size_t k = 0; k < 4; ++k) {
      const double at_u = u + (k % 2 ? g : -g) * w, at_v = v + (k / 2 ? g : -g) * h;
      points[k] = P::direction(face, at_u, at_v);
      weights[k] = 0.25 * w * h * P::density(at_u, at_v);
    }
  }
}

/// What a rectangle spans at most, from its Gauss points: sqrt(3) of their distance, and what a sphere bends.
inline double diagonal(const std::array<Direction, 4>& gauss) {
  return 1.75 * std::max(glm::length(gauss[0] - gauss[3]), glm::length(gauss[1] - gauss[2]));
}

/// Moments of a small rectangle by its Gauss points, to 1e-9 of the solid angle.
/// @return nothing where it spans more than 0.05 radians and `anyway` is not set.
template <class P>
std::optional<Moments> small_cell(int face, const Rect& r, bool anyway = false) {
  std::array<Direction, 4> points;
  std::array<double, 4> weights;
  gauss_points<P>(face, r, points, weights);
  const double across = diagonal(points);
  if (across > 0.05 && !anyway) return std::nullopt;
  Moments found;
  found.solid_angle = weights[0] + weights[1] + weights[2] + weights[3];
  if (found.solid_angle <= 0) return Moments{};
  for (std::size_t k = 0; k < 4; ++k) found.centre += weights[k] / found.solid_angle * points[k];
  for (std::size_t k = 0; k < 4; ++k)
    found.covariance.add_square(points[k] - found.centre, weights[k] / found.solid_angle);
  // Farther to the thin end of a wedge, such as a texel at a pole.
  const auto [least, most] = std::ranges::minmax(weights);
  found.reach = 0.5 * across * (1 + 0.6 * (most - least) / (most + least));
  // Cauchy and Schwarz: the cube of it is at most the root of E|o|^2 E|o|^4, and E|o|^4 at most 1.8 (E|o|^2)^2, that of
  // a line;
  // 1.8^(1/6) = 1.103, and a little for wedges.
  const auto& m = found.covariance.m;
  found.spread = 1.15 * std::sqrt(m[0] + m[3] + m[5]);
  return found;
}

/// Moments of any rectangle, by its quarters where it is not small.
template <class P>
Moments moments(int face, const Rect& cell, int depth = 0) {
  if (const std::optional<Moments> found = small_cell<P>(face, cell, depth >= 9)) return *found;
  std::array<Moments, 4> parts;
  std::size_t count = 0;
  for (const Rect& q : quarters(cell)) parts[count++] = moments<P>(face, q, depth + 1);
  return united(parts);
}

/// f(direction, solid angle) at Gauss points of a rectangle, cut until none of its parts spans more than `across`
/// radians.
template <class P, class F>
void for_points(int face, const Rect& rect, double across, F&& f, int depth = 0) {
  std::array<Direction, 4> points;
  std::array<double, 4> weights;
  gauss_points<P>(face, rect, points, weights);
  if (depth < 9 && diagonal(points) > across) {
    for (const Rect& q : quarters(rect)) for_points<P>(face, q, across, f, depth + 1);
  } else {
    for (std::size_t k = 0; k < 4; ++k) f(points[k], weights[k]);
  }
}

}  // namespace envmap::prefiltering

/// @file
/// Rectangles of a cube or latlong map as pieces of the sphere: Gauss points, solid angle, centre and bounding radius.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>

#include "envmap/maths/portable.h"
#include "envmap/maths/quadrature.h"
#include "envmap/projection/visit.h"

namespace envmap::prefiltering {

/// Calls f with the type of a projection that can be prefiltered as it is; source_cube.h makes all others a cube first.
template <class F>
decltype(auto) visit_source(Projection p, F&& f) {
  if (p == Projection::latlong) return f(Latlong{});
  if (p != Projection::cube) throw std::logic_error("a source is a cube or a latlong map");
  return f(Cube{});
}

/// Moments of a piece of the sphere under uniform light.
struct Moments {
  double solid_angle = 0;
  Direction centre{0};         ///< Mean direction: inside the sphere, by half the variance.
  double bounding_radius = 0;  ///< No direction is farther from the centre.
};

inline std::array<Rect, 4> quarters(const Rect& r) {
  const double u = 0.5 * (r.u0 + r.u1), v = 0.5 * (r.v0 + r.v1);
  return {{{r.u0, r.v0, u, v}, {u, r.v0, r.u1, v}, {r.u0, v, u, r.v1}, {u, v, r.u1, r.v1}}};
}

/// The moments of several pieces together.
inline Moments united(std::span<const Moments> parts) {
  Moments whole;
  for (const Moments& p : parts) {
    whole.solid_angle += p.solid_angle;
    whole.centre += p.solid_angle * p.centre;
  }
  if (whole.solid_angle <= 0) return {};
  whole.centre /= whole.solid_angle;
  for (const Moments& p : parts)
    whole.bounding_radius = std::max(whole.bounding_radius, p.bounding_radius + glm::length(p.centre - whole.centre));
  return whole;
}

/// 2 x 2 Gauss points of a rectangle with their solid angles.
template <class P>
void gauss_points(int face, const Rect& r, std::array<Direction, 4>& points, std::array<double, 4>& weights) {
  constexpr double g = 0.5 * quadrature::gauss_2.node[1];
  const double w = r.u1 - r.u0, h = r.v1 - r.v0, u = 0.5 * (r.u0 + r.u1), v = 0.5 * (r.v0 + r.v1);
  if constexpr (std::is_same_v<P, Latlong>) {
    // Two meridians and two parallels: the same as Latlong's formula for each point, in half the time.
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

/// The most that a rectangle spans, from its Gauss points: sqrt(3) times their distance, and a margin for the curvature
/// of the sphere.
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
  // The thin end of a wedge, such as a texel at a pole, lies farther from the centre.
  const auto [least, most] = std::ranges::minmax(weights);
  found.bounding_radius = 0.5 * across * (1 + 0.6 * (most - least) / (most + least));
  return found;
}

/// Moments of any rectangle: those of its quarters together where it is not small.
template <class P>
Moments moments(int face, const Rect& cell, int depth = 0) {
  if (const std::optional<Moments> found = small_cell<P>(face, cell, depth >= 9)) return *found;
  std::array<Moments, 4> parts;
  std::size_t count = 0;
  for (const Rect& q : quarters(cell)) parts[count++] = moments<P>(face, q, depth + 1);
  return united(parts);
}

/// Calls f(direction, solid angle) at Gauss points of a rectangle, which is divided until none of its parts spans more
/// than `across` radians.
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

/// @file
/// The moments of a piece of the sphere that is a rectangle of a projection.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "envmap/maths/quadrature.h"
#include "envmap/maths/vector.h"

namespace envmap {

/// A symmetric 3 x 3 matrix: xx, xy, xz, yy, yz, zz.
struct Symmetric {
  std::array<double, 6> m{};

  void add_square(const Direction& v, double weight) { add_product(v, v, 0.5 * weight); }
  /// weight x (a b^T + b a^T).
  void add_product(const Direction& a, const Direction& b, double weight) {
    m[0] += 2 * weight * a.x * b.x;
    m[1] += weight * (a.x * b.y + a.y * b.x);
    m[2] += weight * (a.x * b.z + a.z * b.x);
    m[3] += 2 * weight * a.y * b.y;
    m[4] += weight * (a.y * b.z + a.z * b.y);
    m[5] += 2 * weight * a.z * b.z;
  }
  void add(const Symmetric& other, double weight) {
    for (std::size_t k = 0; k < 6; ++k) m[k] += weight * other.m[k];
  }
  [[nodiscard]] double norm() const {
    return std::sqrt(m[0] * m[0] + m[3] * m[3] + m[5] * m[5] + 2 * (m[1] * m[1] + m[2] * m[2] + m[4] * m[4]));
  }
};

struct Patch {
  double solid_angle = 0;
  Direction centre{0};     ///< Mean direction: inside the sphere, by half the variance.
  Symmetric covariance{};  ///< Of directions about the centre.
  double spread = 0;       ///< Cube root of the mean |direction - centre|^3, or a little above.
  double reach = 0;        ///< No direction is farther from the centre.
};

/// Where the rectangle stands to the unit disc.
enum class Coverage { inside, cut, outside };

template <class P>
Coverage coverage(const Rect& r) {
  if constexpr (!P::on_disc) return Coverage::inside;
  const auto far = [](double a, double b) { return std::max(std::abs(2 * a - 1), std::abs(2 * b - 1)); };
  const auto near = [](double a, double b) { return std::abs(2 * std::clamp(0.5, a, b) - 1); };
  const double fs = far(r.u0, r.u1), ft = far(r.v0, r.v1), ns = near(r.u0, r.u1), nt = near(r.v0, r.v1);
  return fs * fs + ft * ft <= 1 ? Coverage::inside : ns * ns + nt * nt < 1 ? Coverage::cut : Coverage::outside;
}

inline std::array<Rect, 4> quarters(const Rect& r) {
  const double u = 0.5 * (r.u0 + r.u1), v = 0.5 * (r.v0 + r.v1);
  return {{{r.u0, r.v0, u, v}, {u, r.v0, r.u1, v}, {r.u0, v, u, r.v1}, {u, v, r.u1, r.v1}}};
}

/// Puts parts together.
inline Patch united(std::span<const Patch> parts) {
  Patch whole;
  for (const Patch& p : parts) {
    whole.solid_angle += p.solid_angle;
    whole.centre += p.solid_angle * p.centre;
  }
  if (whole.solid_angle <= 0) return {};
  whole.centre /= whole.solid_angle;
  double cubes = 0;
  for (const Patch& p : parts) {
    if (p.solid_angle <= 0) continue;
    const Direction off = p.centre - whole.centre;
    const double share = p.solid_angle / whole.solid_angle, distance = glm::length(off);
    whole.covariance.add(p.covariance, share);
    whole.covariance.add_square(off, share);
    cubes += share * std::pow(p.spread + distance, 3);
    whole.reach = std::max(whole.reach, p.reach + distance);
  }
  whole.spread = std::cbrt(cubes);
  return whole;
}

/// 2 x 2 Gauss points of a rectangle with their solid angles. Points outside the disc count 0.
template <class P>
void gauss_points(int face, const Rect& r, std::array<Direction, 4>& points, std::array<double, 4>& weights) {
  constexpr double g = 0.28867513459481287;  // 1 / (2 sqrt(3))
  const double w = r.u1 - r.u0, h = r.v1 - r.v0, u = 0.5 * (r.u0 + r.u1), v = 0.5 * (r.v0 + r.v1);
  for (std::size_t k = 0; k < 4; ++k) {
    const double at_u = u + (k % 2 ? g : -g) * w, at_v = v + (k / 2 ? g : -g) * h;
    points[k] = P::direction(face, at_u, at_v);
    weights[k] = 0.25 * w * h * P::density(at_u, at_v);
  }
}

/// Moments of a small rectangle by its Gauss points, to 1e-9 of the solid angle and somewhat less where the rim cuts it.
/// @return nothing where it spans more than 0.05 radians and `anyway` is not set.
template <class P>
std::optional<Patch> small_patch(int face, const Rect& r, bool anyway = false) {
  const Coverage where = coverage<P>(r);
  if (where == Coverage::outside) return Patch{};
  std::array<Direction, 4> points;
  std::array<double, 4> weights;
  gauss_points<P>(face, r, points, weights);
  const double across = 1.75 * std::max(glm::length(points[0] - points[3]), glm::length(points[1] - points[2]));
  if (across > 0.05 && !anyway) return std::nullopt;
  Patch found;
  found.solid_angle = weights[0] + weights[1] + weights[2] + weights[3];
  if (where == Coverage::cut) {
    const double inside = P::solid_angle(r);
    // A sliver whose points all lie outside is where its inner corner is.
    if (found.solid_angle <= 0) {
      const auto inner = [](double a, double b) { return std::clamp(0.5, a, b); };
      points[0] = P::direction(face, inner(r.u0, r.u1), inner(r.v0, r.v1));
      weights = {inside, 0, 0, 0};
    } else {
      for (double& w : weights) w *= inside / found.solid_angle;
    }
    found.solid_angle = inside;
  }
  if (found.solid_angle <= 0) return Patch{};
  for (std::size_t k = 0; k < 4; ++k) found.centre += weights[k] / found.solid_angle * points[k];
  for (std::size_t k = 0; k < 4; ++k)
    found.covariance.add_square(points[k] - found.centre, weights[k] / found.solid_angle);
  // Farther to the thin end of a wedge, such as a texel at a pole.
  const auto [least, most] = std::ranges::minmax(weights);
  found.reach = where == Coverage::cut ? across : 0.5 * across * (1 + 0.6 * (most - least) / (most + least));
  found.spread = 0.27 * across;  // 0.43 of a side.
  return found;
}

}  // namespace envmap

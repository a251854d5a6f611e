/// @file
/// Pieces of a sphere map's texels near its rim. All of the rim is -Z, so that texels there are thin wedges, up to
/// sqrt(16 / size) radians long: cut into quarters of the image they would stay thin. Here they are cut by their distance
/// from -Z and, when they are short enough, by azimuth.
#pragma once

#include <type_traits>

#include "envmap/prefilter/patch.h"
#include "envmap/projection/sphere.h"
#include "envmap/projection/visit.h"

namespace envmap {

/// Steradians of {0 <= a <= x, 0 <= b <= y, sqrt(a^2 + b^2) <= r}.
inline double corner_solid_angle(double x, double y, double r) {
  x = std::min(x, r), y = std::min(y, r);
  if (x * x + y * y <= r * r) return 4 * x * y;
  const double start = std::sqrt(r * r - y * y);
  const auto under = [r](double s) {
    return 0.5 * (s * std::sqrt(std::max(0.0, r * r - s * s)) + r * r * std::asin(std::min(1.0, s / r)));
  };
  return 4 * (y * start + under(x) - under(start));
}

/// What of a rectangle in one quadrant of the image lies between two distances from -Z and two azimuths, in radians. With
/// a = |s| and b = |t|, a point at distance d and azimuth p is a = cos(d/2) cos p, b = cos(d/2) sin p, and has the solid
/// angle sin(d) dd dp.
struct Wedge {
  double a0, b0, a1, b1;     ///< The rectangle.
  double sign_s, sign_t;     ///< Its quadrant.
  double near, far;          ///< Distances; no corner of the rectangle lies between them.
  double from = 0, to = pi;  ///< Azimuths in the quadrant.
  double factor = 1;         ///< What the Gauss points' solid angle is to be multiplied by.

  struct Arc {
    double from, to;
    [[nodiscard]] double length() const { return std::max(0.0, to - from); }
  };
  [[nodiscard]] Arc arc(double distance) const {
    const double r = std::cos(0.5 * distance);
    const auto unit = [r](double x) { return std::min(1.0, x / r); };
    return {std::max({from, std::acos(unit(a1)), std::asin(unit(b0))}),
            std::min({to, std::acos(unit(a0)), std::asin(unit(b1))})};
  }
  [[nodiscard]] Direction direction(double distance, double azimuth) const {
    const double s = std::sin(distance);
    return {sign_s * s * std::cos(azimuth), sign_t * s * std::sin(azimuth), -std::cos(distance)};
  }
  /// Makes its solid angle exact, as far as it has no cut by azimuth and is large enough for a difference.
  void calibrate() {
    if (from > 0 || to < pi) return;
    const auto within = [&](double r) {
      return corner_solid_angle(a1, b1, r) - corner_solid_angle(a0, b1, r) - corner_solid_angle(a1, b0, r) +
             corner_solid_angle(a0, b0, r);
    };
    const double truth = within(std::cos(0.5 * near)) - within(std::cos(0.5 * far));
    if (truth < 1e-8) return;
    factor = 1;
    const double found = solid_angle();
    factor = found > 0 ? truth / found : 1;
  }
  [[nodiscard]] double solid_angle() const {
    double sum = 0;
    points([&](const Direction&, double weight) { sum += weight; });
    return sum;
  }
  /// f(direction, solid angle) at its Gauss points. Distances run with a square: arcs grow with a root from a corner.
  template <class F>
  void points(F&& f) const {
    const auto& down = quadrature::rule<3>();
    constexpr double g = 0.28867513459481287;  // 1 / (2 sqrt(3))
    for (std::size_t n = 0; n < 3; ++n) {
      const double w = 0.5 + 0.5 * down.node[n], distance = far - (far - near) * w * w;
      const Arc along = arc(distance);
      const double weight = 0.5 * factor * down.weight[n] * w * (far - near) * std::sin(distance) * along.length();
      if (weight <= 0) continue;
      const double middle = 0.5 * (along.from + along.to);
      f(direction(distance, middle - g * along.length()), weight);
      f(direction(distance, middle + g * along.length()), weight);
    }
  }
};

template <class P>
inline constexpr bool has_wedges = std::is_same_v<P, Sphere>;

/// Whether a rectangle is cut into wedges: it lies in one quadrant and its outer corner is stretched eight times.
template <class P>
bool at_rim(const Rect& r) {
  if constexpr (!has_wedges<P>) return false;
  constexpr double little = 1e-12;
  if ((r.u0 < 0.5 - little && r.u1 > 0.5 + little) || (r.v0 < 0.5 - little && r.v1 > 0.5 + little)) return false;
  const double s0 = std::abs(2 * r.u0 - 1), s1 = std::abs(2 * r.u1 - 1), t0 = std::abs(2 * r.v0 - 1),
               t1 = std::abs(2 * r.v1 - 1);
  const double inner = std::min(s0, s1) * std::min(s0, s1) + std::min(t0, t1) * std::min(t0, t1);
  const double outer = std::max(s0, s1) * std::max(s0, s1) + std::max(t0, t1) * std::max(t0, t1);
  return inner > 0.5 && inner < 1 && outer > 0.875;
}

/// f(wedge) for all of a rectangle that is at_rim: between the distances of its corners.
template <class F>
void for_wedges(const Rect& r, F&& f) {
  const double s0 = std::abs(2 * r.u0 - 1), s1 = std::abs(2 * r.u1 - 1), t0 = std::abs(2 * r.v0 - 1),
               t1 = std::abs(2 * r.v1 - 1);
  Wedge w{.a0 = std::min(s0, s1),
          .b0 = std::min(t0, t1),
          .a1 = std::max(s0, s1),
          .b1 = std::max(t0, t1),
          .sign_s = r.u0 + r.u1 > 1 ? 1.0 : -1.0,
          .sign_t = r.v0 + r.v1 < 1 ? 1.0 : -1.0,
          .near = 0,
          .far = 0};
  // At most the rim's.
  const auto radius = [](double a, double b) { return std::min(1.0, std::sqrt(a * a + b * b)); };
  std::array<double, 4> radii{radius(w.a0, w.b0), radius(w.a0, w.b1), radius(w.a1, w.b0), radius(w.a1, w.b1)};
  std::ranges::sort(radii);
  for (std::size_t k = 0; k + 1 < radii.size(); ++k) {
    if (radii[k + 1] - radii[k] < 1e-15) continue;
    w.far = 2 * std::acos(radii[k]), w.near = 2 * std::acos(radii[k + 1]);
    w.calibrate();
    f(w);
  }
}

/// f(part) for its parts, cut across the longer side. Where an azimuth cuts it, distances are cut, too, at which the
/// rectangle's border crosses that azimuth: arcs are smooth in between.
template <class F>
void for_halves(const Wedge& w, F&& f) {
  std::array<Wedge, 10> parts;
  std::size_t count = 0;
  const Wedge::Arc near = w.arc(w.near), far = w.arc(w.far);
  const double from = std::min(near.from, far.from), to = std::max(near.to, far.to);
  if (w.far - w.near > std::sin(w.far) * (to - from)) {
    parts[0] = parts[1] = w;
    count = 2;
    parts[0].far = parts[1].near = 0.5 * (w.near + w.far);
  } else {
    const double cut = 0.5 * (from + to), c = std::cos(cut), s = std::sin(cut);
    std::array<double, 6> at{w.near, w.far};
    std::size_t ends = 2;
    for (const double r : {w.a0 / c, w.a1 / c, w.b0 / s, w.b1 / s}) {
      const double d = r > 0 && r < 1 ? 2 * std::acos(r) : 0;
      if (d <= w.near || d >= w.far) continue;
      std::size_t k = ends++;
      for (; at[k - 1] > d; --k) at[k] = at[k - 1];
      at[k] = d;
    }
    for (std::size_t k = 0; k + 1 < ends; ++k)
      for (const bool first : {true, false}) {
        Wedge& part = parts[count++] = w;
        part.near = at[k], part.far = at[k + 1];
        (first ? part.to : part.from) = cut;
      }
  }
  double found = 0;
  for (std::size_t k = 0; k < count; ++k) {
    parts[k].calibrate();
    found += parts[k].solid_angle();
  }
  for (std::size_t k = 0; k < count; ++k) {
    if (found > 0) parts[k].factor *= w.solid_angle() / found;
    f(parts[k]);
  }
}

/// Its moments. @return nothing where it spans more than 0.05 radians and `anyway` is not set.
inline std::optional<Patch> small_patch(const Wedge& w, bool anyway = false) {
  if (w.far - w.near > 0.05 && !anyway) return std::nullopt;
  Patch found;
  w.points([&](const Direction& d, double weight) {
    found.solid_angle += weight;
    found.centre += weight * d;
  });
  if (found.solid_angle <= 0) return Patch{};
  found.centre /= found.solid_angle;
  double cubes = 0;
  w.points([&](const Direction& d, double weight) {
    found.covariance.add_square(d - found.centre, weight / found.solid_angle);
    cubes += weight / found.solid_angle * std::pow(glm::length(d - found.centre), 3);
  });
  found.spread = 1.1 * std::cbrt(cubes);
  for (const double distance : {w.near, w.far}) {
    const Wedge::Arc along = w.arc(distance);
    for (const double azimuth : {along.from, std::max(along.from, along.to)})
      found.reach = std::max(found.reach, 1.02 * glm::length(w.direction(distance, azimuth) - found.centre));
  }
  if (found.reach > 0.05 && !anyway) return std::nullopt;
  return found;
}

}  // namespace envmap

/// @file
/// The integral of a lobe over a rectangle of a cube or latlong map, as an integral along its border.
///
/// With S the integral of the lobe within an angle, it is that of S / (2 pi) d(azimuth) (Green's theorem). No width of
/// the lobe makes that hard: a lobe much narrower than the rectangle is a smooth S nearly everywhere on the border.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "envmap/prefilter/cell_moments.h"

namespace envmap::prefiltering {

/// 1 - cos of the angle between unit vectors.
inline double versine(const Direction& a, const Direction& b) {
  const Direction d = a - b;
  return 0.5 * glm::dot(d, d);
}

/// A side of a rectangle, or a part of one: along u or v, w running from `from` to `to`.
struct Side {
  bool along_u;
  double fixed, from, to;

  [[nodiscard]] double at(double part) const { return from + (to - from) * part; }
  template <class P>
  [[nodiscard]] Direction direction(int face, double w) const {
    return along_u ? P::direction(face, w, fixed) : P::direction(face, fixed, w);
  }
};

inline std::array<Side, 4> sides_of(const Rect& r) {
  return {{{true, r.v0, r.u0, r.u1}, {false, r.u1, r.v0, r.v1}, {true, r.v1, r.u1, r.u0}, {false, r.u0, r.v1, r.v0}}};
}

/// A point l of the border, with turn = l x dl/dw.
struct BorderPoint {
  Direction l, turn;
};

/// dl/dw follows from the projection's formula. On a cube l = q / |q| with q on the face, and l x dl = l x dq / |q|.
template <class P>
BorderPoint border_point(int face, const Side& side, double w) {
  const Direction l = side.direction<P>(face, w);
  if constexpr (std::is_same_v<P, Latlong>) {
    if (side.along_u) return {l, 2 * pi * glm::cross(l, Direction(-l.z, 0, l.x))};
    // Across parallels, to the south: the turn is level, at right angles to the meridian.
    const double longitude = 2 * (0.5 - side.fixed);
    return {l, pi * Direction(portable::cos_pi(longitude), 0, -portable::sin_pi(longitude))};
  } else {
    const Cube::Axes& a = Cube::axes[std::size_t(face)];
    return {l, glm::dot(l, a.forward) * glm::cross(l, side.along_u ? 2.0 * a.right : -2.0 * a.up)};
  }
}

/// The part of a border's sums that no direction changes: points along each side, and the points of three Gauss rules,
/// over the whole side and over its halves.
template <class P>
struct Border {
  static constexpr std::size_t steps = 8, nodes = 5;
  using Rule = std::array<BorderPoint, nodes>;
  struct Edge {
    Side side;
    std::array<Direction, steps + 1> along;
    std::array<Rule, 3> rules;
  };
  std::array<Edge, 4> edges;
  bool right_handed;  ///< If u, v and the outward direction are. Else the border runs clockwise.

  Border(int face, const Rect& rect) : right_handed(is_right_handed(face)) {
    const std::array<Side, 4> sides = sides_of(rect);
    for (std::size_t n = 0; n < sides.size(); ++n) {
      const Side& s = edges[n].side = sides[n];
      for (std::size_t k = 0; k <= steps; ++k)
        edges[n].along[k] = s.template direction<P>(face, s.at(double(k) / steps));
      edges[n].rules = {rule(face, s, s.from, s.to), rule(face, s, s.from, s.at(0.5)), rule(face, s, s.at(0.5), s.to)};
    }
  }

 private:
  static Rule rule(int face, const Side& side, double from, double to) {
    Rule points;
    for (std::size_t n = 0; n < nodes; ++n)
      points[n] =
          border_point<P>(face, side, 0.5 * (from + to) + 0.5 * (to - from) * quadrature::rule<nodes>().node[n]);
    return points;
  }
  static bool is_right_handed(int face) {
    constexpr double h = 1e-3;
    const Direction l = P::direction(face, 0.6, 0.6);
    return glm::dot(l, glm::cross(P::direction(face, 0.6 + h, 0.6) - l, P::direction(face, 0.6, 0.6 + h) - l)) > 0;
  }
};

/// The integral of a lobe over a rectangle, along its border.
/// @param r the direction of the lobe. @param solid_angle of the rectangle.
/// @param bounding_radius of the rectangle about its middle. @param nearest lower bound of x over the rectangle.
template <class P, class L>
double integral_round(const Border<P>& border, const L& lobe, const Direction& r, int face, const Rect& rect,
                      double solid_angle, double bounding_radius, double nearest);

}  // namespace envmap::prefiltering

/// @file
/// The integral of a lobe over a rectangle of a cube or latlong map, round its border: with S the lobe's share within
/// an angle, that of S / (2 pi) d(azimuth) (Green's theorem).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

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

/// A point of the border with l x dl/dw.
struct BorderPoint {
  Direction l, turn;
};

/// dl/dw is that of the projection's formula; of a cube, where l = q / |q| with q on the face, l x dl = l x dq / |q|.
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

/// What of a border no direction changes: points along each side, and those of three Gauss rules,
/// of the whole and of halves.
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
  bool right_handed;  ///< Whether u, v and the outward direction are; else the border runs the other way round.

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

/// The border of a rectangle; those made last are kept for the same thread,
/// as neighbouring directions ask for the same.
template <class P>
const Border<P>& recent_border(int face, const Rect& rect) {
  struct Kept {
    int face;
    Rect rect;
    Border<P> border;
  };
  thread_local std::vector<std::optional<Kept>> kept(128);
  std::uint64_t hash = std::uint64_t(face);
  for (const double x : {rect.u0, rect.v0, rect.u1, rect.v1})
    hash = 0x9E3779B97F4A7C15U * (hash ^ std::bit_cast<std::uint64_t>(x));
  std::optional<Kept>& place = kept[hash >> 57];
  const auto is_it = [&](const Rect& r) {
    return r.u0 == rect.u0 && r.v0 == rect.v0 && r.u1 == rect.u1 && r.v1 == rect.v1;
  };
  if (!place || place->face != face || !is_it(place->rect)) place = Kept{face, rect, Border<P>(face, rect)};
  return place->border;
}

/// An integral, and what it may be off: the sum of what halving each of its parts changed,
/// some hundred times the true error.
struct Integral {
  double value = 0, error = 0;
};

/// The integral of a lobe over a rectangle, round its border.
/// @param r the direction in which the lobe is. @param solid_angle of the rectangle.
/// @param reach of the rectangle from its middle. @param nearest x of the nearest point, from below.
/// @param enough what a part may be off.
template <class P, class L>
Integral integral_round(const Border<P>& border, const L& lobe, const Direction& r, int face, const Rect& rect,
                        double solid_angle, double reach, double nearest, double enough = 0);

}  // namespace envmap::prefiltering

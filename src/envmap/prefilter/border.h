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

#include "envmap/prefilter/cell.h"

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

/// Whether a direction is outside a rectangle, and not by rounding.
template <class P>
bool is_outside(const Direction& r, int face, const Rect& rect) {
  constexpr double rounding = 1e-12;
  const auto beyond = [](double x, double low, double high, double margin) {
    return x < low - margin || x > high + margin;
  };
  if constexpr (std::is_same_v<P, Latlong>) {
    const Location<double> at = P::locate(r);
    const double margin = rounding / std::max(rounding, portable::sin_pi(at.v));
    const bool at_seam = at.u < margin || at.u > 1 - margin;
    return beyond(at.v, rect.v0, rect.v1, rounding) || (!at_seam && beyond(at.u, rect.u0, rect.u1, margin));
  } else {
    if (glm::dot(r, P::axes[std::size_t(face)].forward) <= 0) return true;
    const Location<double> at = P::continued(face, r);
    return beyond(at.u, rect.u0, rect.u1, rounding) || beyond(at.v, rect.v0, rect.v1, rounding);
  }
}

/// One direction's integral round a border.
template <class P, class L>
class RoundBorder {
 public:
  RoundBorder(const L& lobe, const Direction& r, int face, const Rect& rect)
      : lobe_(lobe), r_(r), face_(face), near_(!is_outside<P>(r, face, rect)) {}

  /// @param solid_angle of the rectangle. @param reach of it from its middle. @param nearest x of the nearest point,
  /// from below. @param enough what a part may be off.
  [[nodiscard]] Integral operator()(const Border<P>& border, double solid_angle, double reach, double nearest,
                                    double enough = 0) const {
    thread_local std::vector<Part> parts;
    parts.clear();
    for (const auto& edge : border.edges) add(edge, parts);
    // Where the horizon leaves but a corner the points may see nothing: what there is at most counts a little.
    double scale = 1e-3 * reach * (near_ ? 1 : lobe_.missing(nearest));
    for (const Part& part : parts) scale += std::abs(part.whole);
    // The sides may cancel: what is left counts beside the mean of the source, of which no texel holds more than 4 pi
    // steradians, and errors are counted from a thousandth of that. Below 1e-14 rounding takes over.
    const double tolerance = std::max(enough, std::clamp(5e-11 * solid_angle, 1e-14 * scale, 1e-8 * scale));
    Integral sum;
    for (const Part& part : parts) add_integral(part, tolerance, sum);
    sum.value = std::max(0.0, border.right_handed ? sum.value : -sum.value);
    return sum;
  }

 private:
  // A part of a side with its integral, and perhaps that of its halves.
  struct Part {
    Side side;
    double whole, first = 0, second = 0;
    bool halved = false;
  };

  // The integrand: S d(azimuth) = S / sin^2 x det(r, l, dl). Outside a rectangle the azimuths of its border add up to
  // 0, so that S - 1 does as well, and keeps its digits in the tail of a lobe.
  [[nodiscard]] double at(const BorderPoint& p) const {
    const double x = versine(r_, p.l);
    if (x < 1e-300) return 0;
    return (near_ ? lobe_.share(x) : -lobe_.missing(x)) / (2 * pi * x * (2 - x)) * glm::dot(r_, p.turn);
  }
  [[nodiscard]] double gauss(const Side& side, double from, double to) const {
    return quadrature::line<Border<P>::nodes>(from, to, [&](double w) { return at(border_point<P>(face_, side, w)); });
  }
  [[nodiscard]] double gauss(const typename Border<P>::Rule& points, double length) const {
    double sum = 0;
    for (std::size_t n = 0; n < points.size(); ++n)
      sum += quadrature::rule<Border<P>::nodes>().weight[n] * at(points[n]);
    return 0.5 * length * sum;
  }

  // Parts of a side. They end where it crosses the horizon, which may leave less of it than points would see.
  void add(const typename Border<P>::Edge& edge, std::vector<Part>& parts) const {
    const Side& side = edge.side;
    const auto above = [&](const Direction& l) { return glm::dot(r_, l) > 0; };
    const bool first = above(edge.along[0]);
    if (std::ranges::all_of(edge.along, [&](const Direction& l) { return above(l) == first; })) {
      const double length = side.to - side.from, nearest = first ? nearest_place(side) : side.from;
      if (first && (is_steep(side, nearest, side.from) || is_steep(side, nearest, side.to)))
        add_graded(side, nearest, parts);
      else if (first || near_)
        parts.push_back({side, gauss(edge.rules[0], length), gauss(edge.rules[1], 0.5 * length),
                         gauss(edge.rules[2], 0.5 * length), true});
      return;
    }
    Side rest = side;
    constexpr auto steps = Border<P>::steps;
    for (std::size_t k = 0; k < steps; ++k) {
      const bool before = above(edge.along[k]);
      if (above(edge.along[k + 1]) == before) continue;
      const double w = crossing(side, side.at(double(k) / steps), side.at((k + 1.0) / steps));
      // Not off a sliver.
      const double least = 1e-6 * std::abs(side.to - side.from);
      if (std::abs(w - rest.from) <= least || std::abs(w - side.to) <= least) continue;
      parts.push_back({{side.along_u, side.fixed, rest.from, w}, gauss(side, rest.from, w)});
      rest.from = w;
    }
    parts.push_back({rest, gauss(rest, rest.from, rest.to)});
  }
  // Parts that grow with their distance from the nearest place, so that points see a lobe much narrower than a side.
  void add_graded(const Side& side, double nearest, std::vector<Part>& parts) const {
    for (const bool forwards : {false, true}) {
      double far = forwards ? side.to : side.from;
      const auto add = [&](double from, double to) {
        const Side part{side.along_u, side.fixed, forwards ? from : to, forwards ? to : from};
        parts.push_back({part, gauss(part, part.from, part.to)});
      };
      for (int k = 0; k < 48 && is_steep(side, nearest, far); ++k) {
        const double middle = 0.5 * (nearest + far);
        add(middle, far);
        far = middle;
      }
      if (far != nearest) add(nearest, far);
    }
  }
  [[nodiscard]] double versine_at(const Side& side, double w) const {
    return versine(r_, side.template direction<P>(face_, w));
  }
  // Whether what is beyond a place is but a small part of what is beyond a nearer one.
  [[nodiscard]] bool is_steep(const Side& side, double near, double far) const {
    return lobe_.missing(versine_at(side, far)) < 0.05 * lobe_.missing(versine_at(side, near));
  }
  // The vertex of parabolas, each over less of the side.
  [[nodiscard]] double nearest_place(const Side& side) const {
    const double low = std::min(side.from, side.to), high = std::max(side.from, side.to);
    double at = 0.5 * (low + high), h = 0.5 * (high - low);
    for (int k = 0; k < 3; ++k, h /= 32) {
      const double before = versine_at(side, at - h), here = versine_at(side, at), after = versine_at(side, at + h);
      const double bend = before - 2 * here + after;
      if (bend > 0) at = std::clamp(at + 0.5 * h * (before - after) / bend, low, high);
    }
    return at;
  }
  // Where a side crosses the horizon: the rule of false position, the weight of an end that stays halved (Illinois
  // method: Dowell and Jarratt 1971).
  [[nodiscard]] double crossing(const Side& side, double low, double high) const {
    const auto height = [&](double w) { return glm::dot(r_, side.template direction<P>(face_, w)); };
    double at_low = height(low), at_high = height(high);
    for (int step = 0; step < 45 && at_low != at_high; ++step) {
      const double w = high - at_high * (high - low) / (at_high - at_low), at = height(w);
      if (std::abs(at) < 1e-16) return w;
      if ((at > 0) == (at_high > 0)) {
        at_low *= 0.5;
      } else {
        low = high, at_low = at_high;
      }
      high = w, at_high = at;
    }
    return high;
  }
  void add_integral(const Part& p, double tolerance, Integral& sum) const {
    const Side& s = p.side;
    if (p.halved)
      add_halves(s, s.from, s.to, p.whole, p.first, p.second, tolerance, 16, sum);
    else
      add_integral(s, s.from, s.to, p.whole, tolerance, 16, sum);
  }
  void add_integral(const Side& side, double from, double to, double whole, double tolerance, int depth,
                    Integral& sum) const {
    const double middle = 0.5 * (from + to);
    add_halves(side, from, to, whole, gauss(side, from, middle), gauss(side, middle, to), tolerance, depth, sum);
  }
  void add_halves(const Side& side, double from, double to, double whole, double first, double second, double tolerance,
                  int depth, Integral& sum) const {
    const double middle = 0.5 * (from + to), off = std::abs(first + second - whole);
    if (depth == 0 || off <= tolerance) {
      sum.value += first + second, sum.error += off;
      return;
    }
    add_integral(side, from, middle, first, tolerance, depth - 1, sum);
    add_integral(side, middle, to, second, tolerance, depth - 1, sum);
  }

  const L& lobe_;
  const Direction& r_;
  int face_;
  bool near_;
};

}  // namespace envmap::prefiltering

/// @file
/// The integral of a lobe over a piece of the sphere, round its border: with S the lobe's share within an angle, that of
/// S / (2 pi) d(azimuth) (Green's theorem).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "envmap/prefilter/cell.h"

namespace envmap {

/// 1 - cos of the angle between unit vectors.
inline double versine(const Direction& a, const Direction& b) {
  const Direction d = a - b;
  return 0.5 * glm::dot(d, d);
}

/// A piece of the border of a texel's part inside the disc: along u, along v, or of the rim, w running from `from` to `to`.
/// Lines that end at the rim run by an angle, with s or t = edge x sin w: at the rim of a sphere map the direction goes with
/// the square root of the distance, and smoothly with w.
struct Piece {
  enum { along_u, along_v, along_s, along_t, rim } kind;
  double fixed, from, to;

  [[nodiscard]] Vec2<double> at(double w) const {
    const auto half_chord = [](double v) { return 0.5 * std::sqrt(std::max(0.0, 4 * v * (1 - v))); };
    switch (kind) {
      case along_u: return {w, fixed};
      case along_v: return {fixed, w};
      case along_s: return {0.5 + half_chord(fixed) * std::sin(w), fixed};
      case along_t: return {fixed, 0.5 + half_chord(fixed) * std::sin(w)};
      case rim: break;
    }
    return {0.5 + 0.5 * std::cos(w), 0.5 + 0.5 * std::sin(w)};
  }
};

/// The edges of the rectangle in the order of the corners, as far as they lie in the disc, and the rim between them.
template <class P>
std::vector<Piece> pieces(const Rect& r) {
  if (coverage<P>(r) == Coverage::inside)
    return {{Piece::along_u, r.v0, r.u0, r.u1},
            {Piece::along_v, r.u1, r.v0, r.v1},
            {Piece::along_u, r.v1, r.u1, r.u0},
            {Piece::along_v, r.u0, r.v1, r.v0}};
  std::vector<Piece> found;
  const auto chord = [&](decltype(Piece::kind) kind, double fixed, double from, double to) {
    const double half = 0.25 - (fixed - 0.5) * (fixed - 0.5);
    if (half <= 0) return;
    const auto angle = [&](double w) { return std::asin(std::clamp((w - 0.5) / std::sqrt(half), -1.0, 1.0)); };
    if (angle(from) != angle(to)) found.push_back({kind, fixed, angle(from), angle(to)});
  };
  chord(Piece::along_s, r.v0, r.u0, r.u1);
  chord(Piece::along_t, r.u1, r.v0, r.v1);
  chord(Piece::along_s, r.v1, r.u1, r.u0);
  chord(Piece::along_t, r.u0, r.v1, r.v0);
  if (!P::filled) return found;  // All of the rim is one direction.
  std::vector<double> breaks{-pi, pi};
  for (const double u : {r.u0, r.u1})
    if (const double c = 2 * u - 1; std::abs(c) < 1) breaks.insert(breaks.end(), {std::acos(c), -std::acos(c)});
  for (const double v : {r.v0, r.v1})
    if (const double c = 2 * v - 1; std::abs(c) < 1)
      breaks.insert(breaks.end(), {std::asin(c), c >= 0 ? pi - std::asin(c) : -pi - std::asin(c)});
  std::ranges::sort(breaks);
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
    if (breaks[k + 1] - breaks[k] < 1e-12) continue;
    const Piece arc{Piece::rim, 0, breaks[k], breaks[k + 1]};
    const Vec2<double> middle = arc.at(0.5 * (arc.from + arc.to));
    if (middle.x >= r.u0 && middle.x <= r.u1 && middle.y >= r.v0 && middle.y <= r.v1) found.push_back(arc);
  }
  return found;
}

/// A point of the border with l x dl/dw.
struct BorderPoint {
  Direction l, turn;
};

/// @param step what the derivative is taken over, to either side.
template <class P>
BorderPoint border_point(int face, const Piece& piece, double w, double step) {
  const auto direction = [&](double to) {
    const Vec2<double> place = piece.at(to);
    return P::direction(face, place.x, place.y);
  };
  const Direction l = direction(w);
  return {l, glm::cross(l, direction(w + step) - direction(w - step)) / (2 * step)};
}
inline double border_step(double from, double to) { return 5e-4 * std::abs(to - from); }

/// What of a border no direction changes: points along each piece, and those of three Gauss rules, of the whole and of halves.
template <class P>
struct Outline {
  static constexpr std::size_t steps = 8, nodes = 5;
  struct Side {
    Piece piece;
    std::array<Direction, steps + 1> along;
    std::array<std::array<BorderPoint, nodes>, 3> rules;
  };
  std::vector<Side> sides;
  bool right_handed;  ///< Whether u, v and the outward direction are; else the border runs the other way round.

  Outline(int face, const Rect& rect) : right_handed(is_right_handed(face)) {
    for (const Piece& piece : pieces<P>(rect)) {
      Side& side = sides.emplace_back();
      side.piece = piece;
      for (std::size_t k = 0; k <= steps; ++k) {
        const Vec2<double> at = piece.at(piece.from + (piece.to - piece.from) * static_cast<double>(k) / steps);
        side.along[k] = P::direction(face, at.x, at.y);
      }
      const double middle = 0.5 * (piece.from + piece.to);
      set(face, piece, piece.from, piece.to, side.rules[0]);
      set(face, piece, piece.from, middle, side.rules[1]);
      set(face, piece, middle, piece.to, side.rules[2]);
    }
  }

 private:
  static void set(int face, const Piece& piece, double from, double to, std::array<BorderPoint, nodes>& points) {
    const auto& node = quadrature::rule<nodes>().node;
    for (std::size_t n = 0; n < nodes; ++n)
      points[n] = border_point<P>(face, piece, 0.5 * (from + to) + 0.5 * (to - from) * node[n], border_step(from, to));
  }
  static bool is_right_handed(int face) {
    constexpr double h = 1e-3;
    const Direction l = P::direction(face, 0.6, 0.6);
    return glm::dot(l, glm::cross(P::direction(face, 0.6 + h, 0.6) - l, P::direction(face, 0.6, 0.6 + h) - l)) > 0;
  }
};

template <class P, class L>
struct Border {
  const L& lobe;
  const Direction& r;
  int face;
  bool near;  ///< S itself; else S - 1, which is 0 for everything far away.

  /// A part of a piece with its integral, and perhaps that of its halves.
  struct Part {
    Piece piece;
    double whole, first = 0, second = 0;
    bool halved = false;
  };

  /// The integrand: S d(azimuth) = S / sin^2 x det(r, l, dl).
  [[nodiscard]] double at(const BorderPoint& p) const {
    const double x = versine(r, p.l);
    if (x < 1e-300) return 0;
    return (near ? lobe.share(x) : -lobe.missing(x)) / (2 * pi * x * (2 - x)) * glm::dot(r, p.turn);
  }
  [[nodiscard]] double gauss(const Piece& piece, double from, double to) const {
    return quadrature::line<Outline<P>::nodes>(from, to, [&](double w) {
      return at(border_point<P>(face, piece, w, border_step(from, to)));
    });
  }
  [[nodiscard]] double gauss(const std::array<BorderPoint, Outline<P>::nodes>& points, double length) const {
    const auto& weight = quadrature::rule<Outline<P>::nodes>().weight;
    double sum = 0;
    for (std::size_t n = 0; n < points.size(); ++n) sum += weight[n] * at(points[n]);
    return 0.5 * length * sum;
  }
  [[nodiscard]] double height(const Piece& piece, double w) const {
    const Vec2<double> place = piece.at(w);
    return glm::dot(r, P::direction(face, place.x, place.y));
  }

  /// Parts of a side. They end where it crosses the horizon, which may leave less of it than points would see.
  void add(const typename Outline<P>::Side& side, std::vector<Part>& parts) const {
    const Piece& piece = side.piece;
    const auto above = [&](const Direction& l) { return glm::dot(r, l) > 0; };
    const bool first = above(side.along[0]);
    if (std::ranges::all_of(side.along, [&](const Direction& l) { return above(l) == first; })) {
      const double length = piece.to - piece.from;
      if (first || near)
        parts.push_back({piece, gauss(side.rules[0], length), gauss(side.rules[1], 0.5 * length),
                         gauss(side.rules[2], 0.5 * length), true});
      return;
    }
    Piece rest = piece;
    constexpr auto steps = Outline<P>::steps;
    for (std::size_t k = 0; k < steps; ++k) {
      const bool before = above(side.along[k]);
      if (above(side.along[k + 1]) == before) continue;
      const double step = (piece.to - piece.from) / steps, low = piece.from + step * static_cast<double>(k);
      const double w = crossing(piece, low, low + step, before);
      // Not off a sliver: differences need a length.
      const double least = 1e-6 * std::abs(piece.to - piece.from);
      if (std::abs(w - rest.from) <= least || std::abs(w - piece.to) <= least) continue;
      parts.push_back({{piece.kind, piece.fixed, rest.from, w}, gauss(piece, rest.from, w)});
      rest.from = w;
    }
    parts.push_back({rest, gauss(rest, rest.from, rest.to)});
  }
  [[nodiscard]] double integral(const Part& p, double tolerance) const {
    const double from = p.piece.from, to = p.piece.to;
    if (!p.halved) return integral(p.piece, from, to, p.whole, tolerance, 16);
    if (std::abs(p.first + p.second - p.whole) <= tolerance) return p.first + p.second;
    const double middle = 0.5 * (from + to);
    return integral(p.piece, from, middle, p.first, tolerance, 15) + integral(p.piece, middle, to, p.second, tolerance, 15);
  }

 private:
  [[nodiscard]] double crossing(const Piece& piece, double low, double high, bool above_low) const {
    for (int step = 0; step < 45; ++step) {
      const double middle = 0.5 * (low + high);
      ((height(piece, middle) > 0) == above_low ? low : high) = middle;
    }
    return low;
  }
  [[nodiscard]] double integral(const Piece& piece, double from, double to, double whole, double tolerance, int depth) const {
    const double middle = 0.5 * (from + to), a = gauss(piece, from, middle), b = gauss(piece, middle, to);
    if (depth == 0 || std::abs(a + b - whole) <= tolerance) return a + b;
    return integral(piece, from, middle, a, tolerance, depth - 1) + integral(piece, middle, to, b, tolerance, depth - 1);
  }
};

/// @param outline of the rectangle, made if it is not yet. @param nearest x of the nearest point, from below.
/// @param reach of the rectangle from its middle.
template <class P, class L>
double round_border(const L& lobe, const Direction& r, int face, const Rect& rect, std::optional<Outline<P>>& outline,
                    double nearest, double reach) {
  if (!outline) outline.emplace(face, rect);
  const Border<P, L> border{lobe, r, face, nearest <= 0 || lobe.missing(nearest) > 0.5};
  thread_local std::vector<typename Border<P, L>::Part> parts;
  parts.clear();
  for (const auto& side : outline->sides) border.add(side, parts);
  // Where the horizon leaves but a corner the points may see nothing: what there is at most counts a little.
  double scale = 1e-3 * reach * (border.near ? 1 : lobe.missing(nearest));
  for (const auto& part : parts) scale += std::abs(part.whole);
  double sum = 0;
  for (const auto& part : parts) sum += border.integral(part, 1e-8 * scale);
  return std::max(0.0, outline->right_handed ? sum : -sum);
}

}  // namespace envmap

#include "envmap/sample/outline.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "envmap/maths/portable.h"
#include "envmap/projection/visit.h"
#include "envmap/sample/inverse_bilinear.h"

namespace envmap {
namespace {

constexpr double inside_share = 0.75;  // This share of the pieces of a cut side lies inside the disc.

Point2 moved_onto_rim(const Point2& p) {
  const double radius = glm::length(p - 0.5);
  return radius <= 0.5 ? p : 0.5 + 0.5 / radius * (p - 0.5);
}

// At what part of the way from a point inside the disc to one outside the rim is.
double way_to_rim(const Point2& inside, const Point2& outside) {
  const Point2 a = inside - 0.5, way = outside - inside;
  const double rest = 0.25 - glm::dot(a, a), along = glm::dot(a, way);
  return rest / (along + std::sqrt(along * along + glm::dot(way, way) * rest));
}

// A point on a side of a texel that the rim cuts, s of its pieces from a corner. Near the rim of a sphere map the angle
// to -Z grows with the root of the distance from it; pieces are about as long in the source.
Point2 on_cut_side(const Point2& a, const Point2& b, double s, bool on_sphere) {
  const double from = 0.5 - glm::length(a - 0.5), to = 0.5 - glm::length(b - 0.5);
  if (from <= 0 && to > 0) return on_cut_side(b, a, 1 - s, on_sphere);
  if (from > 0 && to <= 0) {
    const double rim = way_to_rim(a, b), part = s / inside_share;
    if (part < 1) return glm::mix(a, b, rim * (on_sphere ? part * (2 - part) : part));
    return moved_onto_rim(glm::mix(a, b, glm::mix(rim, 1.0, (s - inside_share) / (1 - inside_share))));
  }
  const double root = glm::mix(std::sqrt(std::max(from, 0.0)), std::sqrt(std::max(to, 0.0)), s), way = to - from;
  const bool is_steep = on_sphere && from > 0 && std::abs(way) > 1e-6 * from;
  return moved_onto_rim(glm::mix(a, b, is_steep ? (root * root - from) / way : s));
}

// Whether a direction of the source lies in a texel of the result.
bool shows(const Target& target, const Sides& sides, std::size_t texel, const Direction& direction) {
  const Location<double> at = locate(target.to, glm::transpose(target.to_source) * direction);
  const double x = at.u * target.size * aspect(target.to) - sides.first - double(texel);
  const double y = at.v * target.size - sides.row;
  return at.face == sides.face && x >= 0 && x <= 1 && y >= 0 && y <= 1;
}

}  // namespace

bool Sides::is_corner(std::size_t point, std::size_t n) const {
  constexpr double rounding = 1e-12;
  if (n % pieces == 0) return true;
  if (clipped) {  // on_cut_side() meets the rim a quarter from the end.
    const std::size_t quarters = 4 * (n % pieces);
    return (quarters == pieces || quarters == 3 * pieces) &&
           std::abs(glm::length(points[point] - 0.5) - 0.5) < rounding;
  }
  if (!folded) return false;
  const Point2 in = glm::abs(2.0 * points[point] - 1.0);
  return std::min({in.x, in.y, std::abs(in.x + in.y - 1)}) < rounding;
}

void Sides::find(const Target& target, Projection source, bool inside) {
  const double h = target.size, w = h * aspect(target.to), n = double(pieces);
  folded = is_octahedral(target.to), clipped = inside;
  const auto at = [&](double k, double r) { return Point2((first * n + k) / n / w, (row * n + r) / n / h); };
  const auto on_side = [&](std::size_t k, std::size_t r) {
    const bool level = r % pieces == 0, on_sphere = target.to == Projection::sphere;
    const double x = double(k), y = double(r);
    return level ? on_cut_side(at(0, y), at(n, y), x / n, on_sphere)
                 : on_cut_side(at(x, 0), at(x, n), y / n, on_sphere);
  };
  points.clear();
  for (std::size_t r = 0; r <= pieces; ++r)
    for (std::size_t k = 0; k <= pieces * texels; k += r == 0 || r == pieces ? 1 : pieces)
      points.push_back(inside ? on_side(k, r) : at(double(k), double(r)));
  directions.resize(points.size());
  places.resize(points.size());
  envmap::directions(target.to, face, points, directions);
  rotate(target.to_source, directions);
  locate(source, directions, places);
}

void Outline::add(const Point2& p, bool corner) {
  lengths.push_back(points.empty() ? 0 : glm::length((p - points.back()) * Point2(narrowing(p.y), 1)));
  points.push_back(p);
  corners.push_back(corner);
}

// Pieces of a curve of curvature c and of length l lie off by b = c l^2 / 8 in their middles, all to one side. After
// move_out() a piece has as much on one side as on the other, which moves weights only where those bend: at the borders
// of cells by b l^2 / 48 each (the second integral of t - t^2 - 1/6 has its largest value, 1/48 b l^2, in the middle),
// of which a texel's hat has four along each axis; and by b l^2 / 6 at each corner, whose half of the first piece
// stands one point away. Beside 2/3 b for a side as long as a texel, that is 3/4 l^2.
Outline::Shape Outline::shape() const {
  Point2 low = points[0], high = points[0];
  double area = 0, bend = 0, error = 0;
  double side = 0, longest = 0, most = 0;  // From the last corner on: how long, the longest piece, the largest bend.
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const Point2 &a = points[k], &b = points[k + 1];
    const double narrow = narrowing(b.y), piece = lengths[k + 1];
    area += narrow * (b.y - a.y) * (a.x + b.x - 2 * points[0].x);
    low = glm::min(low, a), high = glm::max(high, a);
    side += piece, longest = std::max(longest, piece);
    if (corners[k + 1]) {
      bend = std::max(bend, most);
      error = std::max(error, most * std::min(1.0, 0.75 * longest * longest / std::min(1.0, side)));
      side = longest = most = 0;
      continue;
    }
    const Point2 chord = (points[k + 2] - a) * Point2(narrow, 1), step = (b - a) * Point2(narrow, 1);
    const double from_a_to_c = glm::length(chord);
    if (from_a_to_c > 0) most = std::max(most, 0.25 * std::abs(chord.x * step.y - chord.y * step.x) / from_a_to_c);
  }
  const double across = (high.x - low.x) * narrowing(0.5 * (low.y + high.y));
  return {bend, error, 0.5 * std::abs(area) / std::max({across, high.y - low.y, 1e-300})};
}

// An arc of length l and curvature c encloses c l^3 / 12 more than its chord. A point that lies h = c l m / 2 off the
// chord between its neighbours, l and m away, takes half of what both pieces lack,
// and all of it where the other end is a corner.
void Outline::move_out() {
  Point2 before = points[0];
  for (std::size_t k = 1; k + 1 < points.size(); ++k) {
    const Point2 a = std::exchange(before, points[k]), b = points[k], c = points[k + 1];
    if (corners[k]) continue;
    const double l = lengths[k], m = lengths[k + 1];
    const double lacking = l * l * l * (corners[k - 1] ? 2 : 1) + m * m * m * (corners[k + 1] ? 2 : 1);
    if (l * m > 0) points[k] += lacking / (6 * (l + m) * l * m) * (b - glm::mix(a, c, l / (l + m)));
  }
}

double Outline::narrowing(double y) const {
  if (latlong_rows == 0) return 1;
  const double angle = pi * std::max(0.0, std::min(y + 0.5, latlong_rows - 0.5 - y)) / latlong_rows;
  return angle < 1.2 ? angle * (1 - angle * angle / 6) : 1;
}

namespace {

// The way round a texel on a latlong map: over the seam it goes on; past a pole, where the longitude runs, it gets more
// points; and through a pole it goes along the map's border, where all places are one direction.
struct LatlongPath {
  Outline& out;
  const PaddedLevel& source;
  const Target& target;
  const Sides& sides;
  std::size_t texel;
  Direction last{0};
  bool from_pole = false;

  void go_to(const Direction& d, const Location<double>& at, bool corner, int depth = 0) {
    const double w = source.width();
    const bool to_pole = d.x * d.x + d.z * d.z < 1e-28;
    Point2 p = in_texels(source, at);
    if (out.points.empty()) {
      out.add(p, true);
    } else if (to_pole) {
      out.add({out.points.back().x, p.y}, true);
    } else if (from_pole) {
      leave_pole(d, p, corner);
    } else {
      const double before = out.points.back().x;
      p.x -= w * std::round((p.x - before) / w);
      if (std::abs(p.x - before) > w / 64 && depth < 50) {
        const Direction half = glm::normalize(last + d);
        go_to(half, locate(Projection::latlong, half), false, depth + 1);
        return go_to(d, at, corner, depth + 1);
      }
      out.add(p, corner);
    }
    last = d;
    from_pole = to_pole;
  }

  void leave_pole(const Direction& d, Point2 p, bool corner) {
    const double w = source.width();
    Point2& pole = out.points.back();
    if (out.points.size() == 1) pole.x = p.x;
    const double right = p.x - w * std::floor((p.x - pole.x) / w) - pole.x;  // From 0 to w.
    // Straight over it: to that side which the texel is on.
    const bool straight = std::abs(right - 0.5 * w) < 0.1 * w;
    const double quarter = (pole.x + 0.25 * w + 0.5) / w, near = d.y > 0 ? 1e-7 : 1 - 1e-7;
    const bool to_right =
        straight ? shows(target, sides, texel, Latlong::direction(0, quarter, near)) : right < 0.5 * w;
    p.x = pole.x + (to_right ? right : right - w);
    out.add({p.x, pole.y}, true);
    out.add(p, corner);
  }

  // Back to the beginning. False where both poles lie inside.
  bool close() {
    const Point2 first = out.points.front(), from = out.points.back();
    if (std::abs(first.x - from.x) > 0.5 && !from_pole) {
      const bool north = shows(target, sides, texel, {0, 1, 0});
      if (north == shows(target, sides, texel, {0, -1, 0})) return false;
      const double border = north ? -0.5 : source.height() - 0.5;
      out.add({from.x, border}, true);
      out.add({first.x, border}, true);
    }
    out.add(first, true);
    return true;
  }
};

}  // namespace

// On the facet of the texel's middle; places on its sides may have been found beyond them.
bool Outline::follow_on_octahedron(const PaddedLevel& source, const Sides& sides, std::size_t texel) {
  constexpr double rounding = 1e-14;
  return visit(source.projection(), [&](auto q) {
    using P = decltype(q);
    if constexpr (Faceted<P>) {
      Direction middle(0);
      sides.around(texel, [&](std::size_t k) { middle += sides.directions[k]; });
      facet = P::facet(middle);
      const auto planes = P::sides(facet);
      bool whole = true;
      std::size_t n = 0;
      sides.around(texel, [&](std::size_t k) {
        const Direction& d = sides.directions[k];
        for (const Direction& plane : planes) whole &= glm::dot(plane, d) >= -rounding;
        if (whole) add(in_texels(source, P::continued(facet, d)), sides.is_corner(k, n++));
      });
      return whole;
    } else {
      return false;
    }
  });
}

bool Outline::follow(const PaddedLevel& source, const Target& target, const Sides& sides, std::size_t texel) {
  const Projection p = source.projection();
  const bool disc = on_disc(p);
  const double behind = bilinear_bends_below(p, source.height()),
               rim = disc ? 0.5 - 1.0 * Level::padding / source.height() : 2;
  begin(sides.places[texel * sides.pieces].face, p == Projection::latlong ? source.height() : 0);
  std::size_t n = 0;
  if (p == Projection::latlong) {
    LatlongPath path{*this, source, target, sides, texel};
    sides.around(texel,
                 [&](std::size_t k) { path.go_to(sides.directions[k], sides.places[k], sides.is_corner(k, n++)); });
    return path.close();
  }
  if (is_octahedral(p)) return follow_on_octahedron(source, sides, texel);
  bool whole = true;
  sides.around(texel, [&](std::size_t k) {
    const Location<double>& at = sides.places[k];
    whole &= at.face == facet && sides.directions[k].z >= behind && portable::hypot(at.u - 0.5, at.v - 0.5) < rim;
    add(in_texels(source, at), sides.is_corner(k, n++));
  });
  // Round -Z the outline would enclose all the rest of a disc.
  return whole && !(disc && shows(target, sides, texel, {0, 0, -1}));
}

bool is_cut_by_rim(const Target& target, int row, int column) {
  if (!on_disc(target.to)) return false;
  const double half = 0.5 * target.size, x0 = column - half, x1 = x0 + 1, y0 = row - half, y1 = y0 + 1;
  const double x = std::clamp(0.0, x0, x1), y = std::clamp(0.0, y0, y1), u = std::max(-x0, x1), v = std::max(-y0, y1);
  return x * x + y * y < half * half && u * u + v * v > half * half;
}

}  // namespace envmap

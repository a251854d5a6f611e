#include "envmap/operate/generate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/base/run_operation.h"
#include "envmap/maths/check_direction.h"
#include "envmap/maths/portable.h"
#include "envmap/maths/quadrature.h"
#include "envmap/operate/check_options.h"
#include "envmap/projection/visit.h"

namespace envmap {
namespace {

// ---- patterns known by their radiance in one direction -------------------------------------------------------------

Rgb<double> radiance(const Constant& p, const Direction&) { return p.radiance; }

Rgb<double> radiance(const Gradient& p, const Direction& d) { return glm::mix(p.bottom, p.top, 0.5 * (d.y + 1)); }

Rgb<double> radiance(const Directions&, const Direction& d) { return Rgb<double>(0.5 * (d + 1.0)); }

// Longitude and latitude, in squares.
Point2 in_squares(const Checker& p, const Direction& d) {
  return Point2(portable::atan2(d.x, d.z), portable::asin(std::clamp(d.y, -1.0, 1.0))) * double(p.squares) / pi;
}

Rgb<double> radiance(const Checker& p, const Point2& at) {
  return std::int64_t(std::floor(at.x) + std::floor(at.y)) % 2 == 0 ? p.even : p.odd;
}

Rgb<double> radiance(const Checker& p, const Direction& d) { return radiance(p, in_squares(p, d)); }

int main_axis(const Direction& d) {
  const Direction size = glm::abs(d);
  return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

Rgb<double> radiance(const Faces&, const Direction& d) {
  const int axis = main_axis(d);
  Rgb<double> colour(d[axis] < 0 ? 1 : 0);
  colour[axis] = 1 - colour[axis];
  return colour;
}

Rgb<double> radiance(const Sky& p, const Direction& d) {
  if (d.y < 0) return p.ground;
  return p.horizon ? glm::mix(*p.horizon, p.zenith, d.y) : p.zenith * (1 + 2 * d.y) / 3.0;
}

Rgb<double> radiance(const Harmonic& p, const Direction& d) {
  return Rgb<double>(p.base + p.amplitude * real_harmonic(p.degree, p.order, d));
}

// Samples along a side of each texel.
template <class P>
constexpr int samples = 1;
template <>
constexpr int samples<Checker> = 8;
template <>
constexpr int samples<Faces> = 8;

// Around a direction in which no edge lies within an angle, the radiance; else nothing.
struct Reach {
  double radians, sine;  // Below a right angle.
};

std::optional<Rgb<double>> even_radiance(const Checker& p, const Direction& d, const Reach& reach) {
  const Point2 at = in_squares(p, d), off = pi / p.squares * glm::abs(at - glm::round(at));
  if (off.y <= reach.radians || portable::sin(off.x) * std::sqrt(1 - std::min(1.0, d.y * d.y)) <= reach.sine)
    return std::nullopt;
  return radiance(p, at);
}

// The edges of faces lie in planes at 45 degrees between two axes.
std::optional<Rgb<double>> even_radiance(const Faces& p, const Direction& d, const Reach& reach) {
  const int axis = main_axis(d);
  const double other = std::max(std::abs(d[(axis + 1) % 3]), std::abs(d[(axis + 2) % 3]));
  if (std::abs(d[axis]) - other <= std::numbers::sqrt2 * reach.sine) return std::nullopt;
  return radiance(p, d);
}

// No point of a texel is further from its centre, in radians:
// half its diagonal times the largest stretch of the projection.
double texel_reach(Projection p, int size) {
  const double half_diagonal = std::numbers::sqrt2 / size;  // In s and t, which are 2 a side.
  return std::min(pi, half_diagonal * visit(p, [](auto q) { return decltype(q)::stretch; }));
}

// What directions next to each other have in common where no edge is near any of them.
// @param reach how far from it each stands for.
template <class P>
std::optional<Rgb<double>> even_radiance(const P& pattern, std::span<const Direction> some, double reach) {
  const Direction& middle = some[some.size() / 2];
  double chord = 0;  // Squared.
  for (const Direction& d : some) chord = std::max(chord, glm::dot(d - middle, d - middle));
  const double angle = reach + 1.02 * std::sqrt(chord);  // That of a chord of half a radius is 1.011 times as large.
  if (chord > 0.25 || angle > 1.5) return std::nullopt;
  return even_radiance(pattern, middle, {angle, portable::sin(angle)});
}

// Radiance of directions next to each other, together where they have it in common. @param each what is done with the
// index of another.
template <class P, class Each>
void fill(const P& pattern, std::span<const Direction> d, double reach, std::span<Rgb<double>> out, Each&& each,
          std::size_t first = 0) {
  if (const auto even = even_radiance(pattern, d, reach)) return void(std::ranges::fill(out, *even));
  if (d.size() == 1) return each(first);
  const std::size_t half = d.size() / 2;
  fill(pattern, d.first(half), reach, out.first(half), each, first);
  fill(pattern, d.subspan(half), reach, out.subspan(half), each, first + half);
}

// The mean over the texels of an n times finer map, n x n to each of these;
// those outside the disc are sampled at the rim.
template <class P>
Rgb<double> supersample(const P& pattern, const Level& level, const Rotation& to_world, int face, int row, int column) {
  constexpr int n = samples<P>;
  std::array<Direction, n> fine;
  std::array<Rgb<double>, n> found;
  Rgb<double> sum(0);
  for (int j = 0; j < n; ++j) {
    texel_directions(level.projection(), level.height() * n, face, row * n + j, column * n, fine);
    rotate(to_world, fine);
    fill(pattern, fine, 0, found, [&](std::size_t k) { found[k] = radiance(pattern, fine[k]); });
    for (const Rgb<double>& c : found) sum += c / double(n * n);
  }
  return sum;
}

template <class P>
void fill(const P& pattern, EnvironmentMap& map, const Progress& progress) {
  constexpr std::size_t together = 32;
  Level& level = map.base();
  const Rotation to_world = image_to_world(map.forward);
  const double reach = 1.001 * texel_reach(level.projection(), level.height());
  for_each_row(level.faces(), level.height(), progress, [&](int face, int row) {
    const Columns in = level.columns(row);
    std::vector<Rgb<double>> sum(in.count());
    std::vector<Direction> d(sum.size());
    texel_directions(level.projection(), level.height(), face, row, in.first, d);
    rotate(to_world, d);
    if constexpr (samples<P> == 1) {
      for (std::size_t k = 0; k < d.size(); ++k) sum[k] = radiance(pattern, d[k]);
    } else {
      const auto each = [&](std::size_t k) {
        sum[k] = supersample(pattern, level, to_world, face, row, in.first + int(k));
      };
      for (std::size_t k = 0; k < d.size(); k += together) {
        const std::size_t count = std::min(together, d.size() - k);
        fill(pattern, std::span(d).subspan(k, count), reach, std::span(sum).subspan(k, count), each, k);
      }
    }
    std::ranges::transform(sum, in.of(level.row(face, row)).begin(), [](const Rgb<double>& c) { return Colour(c); });
  });
}

// ---- the sun --------------------------------------------------------------------------------------------------------

struct Cone {
  Direction axis;
  double radius;  // radians
};

// Angle of a texel's centre from the axis, and how far from its centre it reaches.
struct Extent {
  double away, reach;
};

template <class P>
Extent extent(const Cone& cone, int face, const Rect& r) {
  const Direction centre = P::direction(face, 0.5 * (r.u0 + r.u1), 0.5 * (r.v0 + r.v1));
  Extent e{angle_between(centre, cone.axis), pi};
  if (r.v1 - r.v0 > 0.2) return e;  // Texels of the smallest maps may reach anywhere.
  e.reach = 0;
  for (const double u : {r.u0, 0.5 * (r.u0 + r.u1), r.u1})
    for (const double v : {r.v0, 0.5 * (r.v0 + r.v1), r.v1})
      e.reach = std::max(e.reach, 1.2 * angle_between(centre, P::direction(face, u, v)));  // 1.2: edges bulge.
  return e;
}

// Texels of a row that may be on the sun's edge, and how many points of its outer ring hit each.
struct EdgeRow {
  double inner;  // Radians from the axis: no texel here that is not inside whole comes closer.
  std::vector<int> columns;
  std::vector<int> hits;
};

// Puts the sun into texels that lie inside whole. The others that it may touch are returned, row by row.
template <class P>
std::vector<EdgeRow> fill_inside(const Sun& sun, const Cone& cone, Level& level) {
  const int w = level.width(), h = level.height();
  // Most texels are so far from the edge that the cosine of their centre tells.
  const double reach = h < 8 ? pi : 1.2 * texel_reach(level.projection(), h) + 1e-9;
  const double outside = cone.radius + reach < pi ? portable::cos(cone.radius + reach) : -2;
  const double inside = cone.radius > reach ? portable::cos(cone.radius - reach) : 2;
  std::vector<EdgeRow> edge(std::size_t(h) * P::faces, EdgeRow{cone.radius, {}, {}});
  for_each_row(P::faces, h, {}, [&](int face, int row) {
    EdgeRow& touched = edge[std::size_t(face) * std::size_t(h) + std::size_t(row)];
    const Columns in = columns(level.projection(), h, row);
    std::vector<Direction> centres(in.count());
    texel_directions(level.projection(), h, face, row, in.first, centres);
    for (int i = in.first; i < in.end; ++i) {
      const double cosine = glm::dot(centres[std::size_t(i - in.first)], cone.axis);
      if (cosine < outside) continue;
      const Extent e = cosine > inside ? Extent{0, 0} : extent<P>(cone, face, texel_rect(i, row, w, h));
      if (e.away + e.reach <= cone.radius) {
        *level.texel(face, i, row) = Colour(sun.radiance);
        continue;
      }
      touched.columns.push_back(i);
      touched.inner = std::min(touched.inner, std::max(0.0, e.away - e.reach));
    }
    touched.hits.resize(touched.columns.size());
  });
  return edge;
}

// Points spread evenly over the cone's ring beyond an angle (a Fibonacci lattice, equal-area) are dropped into the
// texels they hit: the light that the sun sends is what arrives, however thin and long the texels are.
// @return the steradians of a point.
template <class P>
double drop_points(const Cone& cone, double inner, int w, int h, std::span<EdgeRow> edge) {
  const double z0 = portable::cos(inner), z1 = portable::cos(cone.radius),
               steradians =
                   4 * pi * portable::sin(0.5 * (cone.radius - inner)) * portable::sin(0.5 * (cone.radius + inner));
  if (steradians <= 0) return 0;
  const double texels = steradians * P::faces * w * h / (4 * pi),
               cap = 2 * portable::pow(portable::sin(0.5 * inner), 2);
  const auto points = std::int64_t(std::clamp(256 * texels, 0x1p20, 0x1p26));
  const Direction e1 =
      glm::normalize(glm::cross(std::abs(cone.axis.x) < 0.7 ? Direction(1, 0, 0) : Direction(0, 1, 0), cone.axis));
  const Direction e2 = glm::cross(cone.axis, e1);
  for (std::int64_t k = 0; k < points; ++k) {
    const double part = (double(k) + 0.5) / double(points), z = z0 + part * (z1 - z0);
    // 1 - z without cancellation, so that a sun of seconds of arc is round.
    const double sine = std::sqrt(std::max(0.0, (cap + part * (z0 - z1)) * (1 + z)));
    const double turn = 2 * pi * std::fmod(double(k) * std::numbers::phi, 1.0);
    const auto at = P::locate(z * cone.axis + sine * (portable::cos(turn) * e1 + portable::sin(turn) * e2));
    const int i = std::clamp(int(at.u * w), 0, w - 1), j = std::clamp(int(at.v * h), 0, h - 1);
    EdgeRow& row = edge[std::size_t(at.face) * std::size_t(h) + std::size_t(j)];
    const auto found = std::ranges::lower_bound(row.columns, i);
    if (found != row.columns.end() && *found == i) ++row.hits[std::size_t(found - row.columns.begin())];
  }
  return steradians / double(points);
}

template <class P>
void add_sun(const Sun& sun, const Cone& cone, Level& level) {
  const int w = level.width(), h = level.height();
  std::vector<EdgeRow> edge = fill_inside<P>(sun, cone, level);
  // The ring must reach as far in as any texel that is not inside whole.
  const double inner = std::ranges::min_element(edge, {}, &EdgeRow::inner)->inner;
  const double steradians = drop_points<P>(cone, inner, w, h, edge);
  for_each_row(P::faces, h, {}, [&](int face, int row) {
    const EdgeRow& touched = edge[std::size_t(face) * std::size_t(h) + std::size_t(row)];
    for (std::size_t k = 0; k < touched.columns.size(); ++k) {
      if (touched.hits[k] == 0) continue;  // A texel outside the disc has no solid angle, too.
      const int i = touched.columns[k];
      const double share =
          float(std::min(1.0, touched.hits[k] * steradians / P::solid_angle(texel_rect(i, row, w, h))));
      Colour& c = *level.texel(face, i, row);
      c = Colour(share * sun.radiance + (1 - share) * Rgb<double>(c));
    }
  });
}

void fill(const Sun& sun, EnvironmentMap& map, const Progress& progress) {
  fill(sun.sky, map, progress);
  const Cone cone{glm::transpose(image_to_world(map.forward)) * checked_direction("towards", sun.towards),
                  sun.radius_degrees * pi / 180};
  visit(map.projection(), [&](auto p) { add_sun<decltype(p)>(sun, cone, map.base()); });
}

// ---- what makes no sense --------------------------------------------------------------------------------------------

// One for each pattern: a new one that has none does not compile.
void check(const Constant&) {}
void check(const Gradient&) {}
void check(const Directions&) {}
void check(const Faces&) {}
void check(const Sky& p) {
  check_not_negative("zenith", Flux(p.zenith));
  check_not_negative("ground", Flux(p.ground));
  if (p.horizon) check_not_negative("horizon", Flux(*p.horizon));
}
void check(const Checker& p) { check_range(limits::squares, p.squares); }
void check(const Sun& p) {
  check(p.sky);
  check_not_negative("radiance", Flux(p.radiance));
  check_range(limits::disc_radius, p.radius_degrees);
}
void check(const Harmonic& p) {
  check_range(limits::degree, p.degree);
  check_range({"order", -1.0 * p.degree, 1.0 * p.degree}, p.order);
}

}  // namespace

double real_harmonic(int degree, int order, const Direction& towards) {
  check_range({"degree", 0, limits::order.most}, degree);
  check_range({"order", -1.0 * degree, 1.0 * degree}, order);
  const Direction d = checked_direction("d", towards);
  const int m = std::abs(order);
  const double y = d.y, sine = std::sqrt(d.x * d.x + d.z * d.z), longitude = portable::atan2(d.x, d.z);
  double previous = 0, current = legendre::first();
  for (int k = 0; k < m; ++k) current *= legendre::diagonal(k) * sine;
  for (int l = m + 1; l <= degree; ++l) {
    const auto [a, b] = legendre::step(l, m);
    const double next = a * (y * current - b * previous);
    previous = current;
    current = next;
  }
  if (order == 0) return current;
  return std::numbers::sqrt2 * current * (order > 0 ? portable::cos(m * longitude) : portable::sin(m * longitude));
}

EnvironmentMap generate(const Pattern& pattern, const Frame& to, int size, const Run& run) {
  std::visit([](const auto& p) { check(p); }, pattern);
  check_range(limits::size, size);
  EnvironmentMap map = blank_map(to, size);
  run_operation(run,
                [&](const Progress& progress) { std::visit([&](const auto& p) { fill(p, map, progress); }, pattern); });
  for (int face = 0; face < map.base().faces(); ++face)
    for (int j = 0; j < map.base().height(); ++j)
      for (const Colour& c : map.base().row(face, j))
        if (!(glm::all(glm::greaterThanEqual(c, Colour(0))) &&
              glm::all(glm::lessThanEqual(c, Colour(std::numeric_limits<float>::max())))))
          throw UsageError(
              "the pattern has negative or infinite radiance: change its values (for a harmonic: a smaller amplitude)");
  return map;
}

}  // namespace envmap

#include "envmap/operate/generate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "envmap/error.h"
#include "envmap/maths/sum.h"
#include "envmap/operate/parallel.h"

namespace envmap {
namespace {

// ---- patterns known by their radiance in one direction -------------------------------------------------------------

Direction radiance(const Constant& p, const Direction&) { return p.radiance; }

Direction radiance(const Gradient& p, const Direction& d) { return glm::mix(p.bottom, p.top, 0.5 * (d.y + 1)); }

Direction radiance(const Directions&, const Direction& d) { return 0.5 * (d + 1.0); }

Direction radiance(const Checker& p, const Direction& d) {
  const double longitude = std::atan2(d.x, d.z), latitude = std::asin(std::clamp(d.y, -1.0, 1.0));
  const auto square = [&](double angle) { return static_cast<long>(std::floor(angle * p.squares / pi)); };
  return (square(longitude) + square(latitude)) % 2 == 0 ? p.even : p.odd;
}

Direction radiance(const Sky& p, const Direction& d) {
  return Direction(d.y < 0 ? p.ground : p.zenith * (1 + 2 * d.y) / 3);
}

Direction radiance(const Harmonic& p, const Direction& d) {
  return Direction(p.base + p.amplitude * real_harmonic(p.degree, p.order, d));
}

// Samples along a side of each texel.
template <class P>
constexpr int samples = 1;
template <>
constexpr int samples<Checker> = 8;

template <class P>
void fill(const P& pattern, EnvironmentMap& map, const Progress& progress) {
  Level& level = map.base();
  const Rotation to_world = image_to_world(map.forward);
  constexpr int n = samples<P>;
  for_each_row(level.faces(), level.height(), progress, [&](int face, int row) {
    const Columns in = columns(level.projection(), level.height(), row);
    std::vector<Direction> sum(static_cast<std::size_t>(in.end - in.first)), d(sum.size());
    if constexpr (n == 1) {
      texel_directions(level.projection(), level.height(), face, row, in.first, d);
      for (std::size_t k = 0; k < d.size(); ++k) sum[k] = radiance(pattern, to_world * d[k]);
    } else {
      // The texels of an n times finer map, n x n to each of ours; those outside the disc are sampled at the rim.
      std::vector<Direction> fine(d.size() * n);
      for (int j = 0; j < n; ++j) {
        texel_directions(level.projection(), level.height() * n, face, row * n + j, in.first * n, fine);
        for (std::size_t k = 0; k < fine.size(); ++k) sum[k / n] += radiance(pattern, to_world * fine[k]) / double(n * n);
      }
    }
    for (std::size_t k = 0; k < sum.size(); ++k) level.row(face, row)[static_cast<std::size_t>(in.first) + k] = sum[k];
  });
}

// ---- the sun ---------------------------------------------------------------------------------------------------------

struct Cone {
  Direction axis;
  double radius;       // radians
  double solid_angle;  // steradians
};

// Steradians of the part of a rectangle of a face that lies in the cone: quartered until a piece is all in, all out or
// too small to matter (1e-7 of the cone: a few hundred pieces along its edge, their errors of either sign).
template <class P>
double covered(const Cone& cone, int face, const Rect& r) {
  const double whole = P::solid_angle(r);
  if (whole <= 0) return 0;
  const Direction centre = P::direction(face, 0.5 * (r.u0 + r.u1), 0.5 * (r.v0 + r.v1));
  const double away = angle_between(centre, cone.axis);
  // No piece reaches further from its centre than its corners and edges do; 1.2 for edges that bulge between.
  double reach = pi;
  if (r.v1 - r.v0 < 0.2) {
    reach = 0;
    for (const double u : {r.u0, 0.5 * (r.u0 + r.u1), r.u1})
      for (const double v : {r.v0, 0.5 * (r.v0 + r.v1), r.v1})
        reach = std::max(reach, 1.2 * angle_between(centre, P::direction(face, u, v)));
  }
  if (away >= cone.radius + reach) return 0;
  if (away + reach <= cone.radius) return whole;
  if (whole < 1e-7 * cone.solid_angle || r.v1 - r.v0 < 1e-12) return away < cone.radius ? whole : 0;
  const double u = 0.5 * (r.u0 + r.u1), v = 0.5 * (r.v0 + r.v1);
  return covered<P>(cone, face, {r.u0, r.v0, u, v}) + covered<P>(cone, face, {u, r.v0, r.u1, v}) +
         covered<P>(cone, face, {r.u0, v, u, r.v1}) + covered<P>(cone, face, {u, v, r.u1, r.v1});
}

void fill(const Sun& sun, EnvironmentMap& map, const Progress& progress) {
  fill(Sky{sun.zenith, sun.ground}, map, progress);
  Level& level = map.base();
  const double radians = sun.radius * pi / 180, half = std::sin(0.5 * radians);
  const Cone cone{glm::transpose(image_to_world(map.forward)) * sun.towards, radians, 4 * pi * half * half};
  visit(level.projection(), [&](auto p) {
    using P = decltype(p);
    for_each_row(level.faces(), level.height(), {}, [&](int face, int row) {
      const double w = level.width(), h = level.height();
      for (int i = 0; i < level.width(); ++i) {
        const Rect texel{i / w, row / h, (i + 1) / w, (row + 1) / h};
        const double part = covered<P>(cone, face, texel);
        if (part <= 0) continue;
        const double share = std::min(1.0, part / P::solid_angle(texel));
        Colour& c = *level.texel(face, i, row);
        c = Colour(share * sun.radiance + (1 - share) * Direction(c));
      }
    });
  });
}

// ---- what makes no sense ---------------------------------------------------------------------------------------------

void require(bool sensible, const char* message) {
  if (!sensible) throw UsageError(message);
}
void check(const Constant&) {}
void check(const Gradient&) {}
void check(const Directions&) {}
void check(const Sky&) {}
void check(const Checker& p) { require(p.squares >= 1, "--squares: at least 1"); }
void check(const Sun& p) { require(p.radius > 0 && p.radius <= 180, "--radius: more than 0 and at most 180 degrees"); }
void check(const Harmonic& p) {
  require(p.degree >= 0 && p.degree <= 100, "--degree: from 0 to 100");
  require(std::abs(p.order) <= p.degree, "--order: from -degree to degree");
}

}  // namespace

double real_harmonic(int degree, int order, const Direction& d) {
  // Associated Legendre functions with the normalisation folded in, upwards in degree (Press et al. 2007, 6.7): stable.
  const int m = std::abs(order);
  const double y = d.y, sine = std::sqrt(d.x * d.x + d.z * d.z), longitude = std::atan2(d.x, d.z);
  double pmm = std::sqrt(1 / (4 * pi));
  for (int k = 1; k <= m; ++k) pmm *= std::sqrt((2.0 * k + 1) / (2.0 * k)) * sine;
  double previous = 0, current = pmm;
  for (int l = m + 1; l <= degree; ++l) {
    const double a = std::sqrt((4.0 * l * l - 1) / (1.0 * l * l - 1.0 * m * m));
    const double b = std::sqrt(((l - 1.0) * (l - 1) - 1.0 * m * m) / (4.0 * (l - 1) * (l - 1) - 1));
    const double next = a * (y * current - b * previous);
    previous = current;
    current = next;
  }
  if (order == 0) return current;
  return std::numbers::sqrt2 * current * (order > 0 ? std::cos(m * longitude) : std::sin(m * longitude));
}

EnvironmentMap generate(const Pattern& pattern, Projection to, int size, Forward forward, const Progress& progress) {
  EnvironmentMap map;
  map.forward = has_forward(to) ? forward : Forward::plus_z;
  std::visit([](const auto& p) { check(p); }, pattern);
  map.levels.emplace_back(to, size);
  std::visit([&](const auto& p) { fill(p, map, progress); }, pattern);
  for (int face = 0; face < map.base().faces(); ++face)
    for (int j = 0; j < map.base().height(); ++j)
      for (const Colour& c : map.base().row(face, j))
        if (!(glm::all(glm::greaterThanEqual(c, Colour(0))) &&
              glm::all(glm::lessThanEqual(c, Colour(std::numeric_limits<float>::max())))))
          throw UsageError("the pattern has negative or infinite radiance: change its values (for sh: a smaller --amplitude)");
  return map;
}

}  // namespace envmap

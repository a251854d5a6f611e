#include "envmap/prefilter/exact.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "envmap/maths/sum.h"
#include "envmap/operate/parallel.h"
#include "envmap/prefilter/patch.h"

namespace envmap {
namespace {

constexpr double nothing = 1e-30;  // Of a lobe: no radiance makes it count.

// 1 - cos of the angle between unit vectors.
double versine(const Direction& a, const Direction& b) {
  const Direction d = a - b;
  return 0.5 * glm::dot(d, d);
}

// ---- round the border -----------------------------------------------------------------------------------------------

template <class P, class L>
struct Border {
  const L& lobe;
  const Direction& r;
  int face;
  bool near;  // S itself; else S - 1, which is 0 for everything far away.

  // The integrand at a point that moves by (du,dv): S d(azimuth) = S / sin^2 x det(r, l, dl).
  [[nodiscard]] double at(double u, double v, double du, double dv) const {
    constexpr double step = 5e-4;
    const Direction l = P::direction(face, u, v);
    const Direction move =
        (P::direction(face, u + step * du, v + step * dv) - P::direction(face, u - step * du, v - step * dv)) / (2 * step);
    const double x = versine(r, l);
    if (x < 1e-300) return 0;
    return (near ? lobe.share(x) : -lobe.missing(x)) / (2 * pi * x * (2 - x)) * glm::dot(r, glm::cross(l, move));
  }
  [[nodiscard]] double gauss(double u0, double v0, double u1, double v1) const {
    return quadrature::line<5>(0, 1,
                               [&](double t) { return at(u0 + t * (u1 - u0), v0 + t * (v1 - v0), u1 - u0, v1 - v0); });
  }
  [[nodiscard]] double edge(double u0, double v0, double u1, double v1, double whole, double tolerance, int depth) const {
    const double u = 0.5 * (u0 + u1), v = 0.5 * (v0 + v1);
    const double a = gauss(u0, v0, u, v), b = gauss(u, v, u1, v1);
    if (depth == 0 || std::abs(a + b - whole) <= tolerance) return a + b;
    return edge(u0, v0, u, v, a, tolerance, depth - 1) + edge(u, v, u1, v1, b, tolerance, depth - 1);
  }
};

template <class P, class L>
double round_border(const L& lobe, const Direction& r, int face, const Rect& rect, double nearest, double reach) {
  const Border<P, L> border{lobe, r, face, nearest <= 0 || lobe.missing(nearest) > 0.5};
  const std::array<Vec2<double>, 5> c{
      {{rect.u0, rect.v0}, {rect.u1, rect.v0}, {rect.u1, rect.v1}, {rect.u0, rect.v1}, {rect.u0, rect.v0}}};
  std::array<double, 4> rough{};
  // Where the horizon leaves but a corner the points may see nothing: what there is at most counts a little.
  double scale = 1e-3 * reach * (border.near ? 1 : lobe.missing(nearest));
  for (std::size_t k = 0; k < 4; ++k) {
    rough[k] = border.gauss(c[k].x, c[k].y, c[k + 1].x, c[k + 1].y);
    scale += std::abs(rough[k]);
  }
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k)
    sum += border.edge(c[k].x, c[k].y, c[k + 1].x, c[k + 1].y, rough[k], 1e-8 * scale, 16);
  // u, v and the outward direction may be left- or right-handed.
  const double u = 0.5 * (rect.u0 + rect.u1), v = 0.5 * (rect.v0 + rect.v1);
  const double h = 1e-3 * (rect.u1 - rect.u0), k = 1e-3 * (rect.v1 - rect.v0);
  const Direction l = P::direction(face, u, v);
  const double turn = glm::dot(l, glm::cross(P::direction(face, u + h, v) - l, P::direction(face, u, v + k) - l));
  return std::max(0.0, turn > 0 ? sum : -sum);
}

// ---- one texel --------------------------------------------------------------------------------------------------------

template <class P, class L>
double over_area(const L& lobe, const Direction& r, int face, const Rect& rect) {
  return quadrature::rectangle<4>(rect, [&](double u, double v) {
    return P::density(u, v) * lobe.value(versine(r, P::direction(face, u, v)));
  });
}

// The part of a rectangle inside the disc.
template <class P, class L>
double over_cut(const L& lobe, const Direction& r, int face, const Rect& rect) {
  return quadrature::inside_disc({2 * rect.u0 - 1, 1 - 2 * rect.v1, 2 * rect.u1 - 1, 1 - 2 * rect.v0},
                                 [&](double s, double t) {
                                   const double u = 0.5 + 0.5 * s, v = 0.5 - 0.5 * t;
                                   const double x = versine(r, P::direction(face, u, v));
                                   return 0.25 * P::density(u, v) * lobe.value(x);
                                 });
}

// How much of its value the lobe loses over a piece, at most; infinite where the horizon crosses it.
template <class L>
double unevenness(const L& lobe, const Direction& r, const Patch& p) {
  const double d = glm::length(r - p.centre), near = std::max(0.0, d - p.reach), far = d + p.reach;
  const double lo = 0.5 * near * near, hi = 0.5 * far * far;
  if (lo >= 1) return 0;
  if (hi >= 1) return 1e300;
  return std::max(lobe.rate(lo), lobe.rate(hi)) * std::min(1.0, far) * p.reach;
}

template <class P, class L>
double lobe_over(const L& lobe, const Direction& r, int face, const Rect& rect, int depth) {
  const Coverage where = coverage<P>(rect);
  if (where == Coverage::outside) return 0;
  const Patch p = patch<P>(face, rect);
  const double near = std::max(0.0, glm::length(r - p.centre) - p.reach);
  if (p.solid_angle <= 0 || lobe.missing(0.5 * near * near) < nothing) return 0;
  const double uneven = unevenness(lobe, r, p);
  if (where == Coverage::inside) {
    if (uneven <= 0.4 && p.reach < 0.2) return over_area<P>(lobe, r, face, rect);
    if (p.reach < 0.3) return round_border<P>(lobe, r, face, rect, 0.5 * near * near, p.reach);
  } else if (uneven <= 0.4 || depth == 0) {
    return over_cut<P>(lobe, r, face, rect);
  }
  double sum = 0;
  for (const Rect& q : quarters(rect)) sum += lobe_over<P>(lobe, r, face, q, depth - 1);
  return sum;
}

// One row of a face in all directions.
template <class P, class L>
std::vector<Flux> row_of(const Level& source, const L& lobe, std::span<const Direction> directions, int face, int row) {
  std::vector<Flux> sums(directions.size(), Flux(0));
  const double w = source.width(), h = source.height();
  const Columns in = columns(source.projection(), source.height(), row);
  for (int i = in.first; i < in.end; ++i) {
    const Flux radiance(*source.texel(face, i, row));
    if (radiance == Flux(0)) continue;
    const Rect rect{i / w, row / h, (i + 1) / w, (row + 1) / h};
    const Coverage where = coverage<P>(rect);
    if (where == Coverage::outside) continue;
    const Patch p = patch<P>(face, rect);
    std::array<Direction, 4> points;
    std::array<double, 4> weights;
    gauss_points<P>(face, rect, points, weights);
    const bool simple = where == Coverage::inside && p.reach < 0.02;
    for (std::size_t k = 0; k < directions.size(); ++k) {
      const double d = std::max(0.0, glm::length(directions[k] - p.centre) - p.reach);
      if (lobe.missing(0.5 * d * d) < nothing) continue;
      double part = 0;
      if (simple && unevenness(lobe, directions[k], p) < 0.05) {
        for (std::size_t n = 0; n < 4; ++n) part += weights[n] * lobe.value(versine(directions[k], points[n]));
      } else {
        part = lobe_over<P>(lobe, directions[k], face, rect, 6);
      }
      sums[k] += part * radiance;
    }
  }
  return sums;
}

}  // namespace

std::vector<Flux> exact_prefilter(const Level& source, const Lobe& lobe, std::span<const Direction> directions,
                                  const Progress& progress) {
  constexpr std::size_t batch = 512;  // Directions at once: the sums of all rows stay small beside the source.
  std::vector<Flux> out(directions.size());
  for (std::size_t first = 0; first < directions.size(); first += batch) {
    const auto some = directions.subspan(first, std::min(batch, directions.size() - first));
    const int rows = source.faces() * source.height();
    std::vector<std::array<Sum, 3>> totals(some.size());
    constexpr int band = 64;
    for (int start = 0; start < rows; start += band) {
      const auto found = map_rows<std::vector<Flux>>(std::min(band, rows - start), [&](int k) {
        const int face = (start + k) / source.height(), row = (start + k) % source.height();
        return visit(source.projection(), [&](auto p) {
          return std::visit([&](const auto& l) { return row_of<decltype(p)>(source, l, some, face, row); }, lobe);
        });
      });
      for (const auto& row : found)
        for (std::size_t k = 0; k < some.size(); ++k)
          for (int c = 0; c < 3; ++c) totals[k][static_cast<std::size_t>(c)].add(row[k][c]);
      if (progress)
        progress((static_cast<double>(first) + static_cast<double>(some.size()) * (start + band) / rows) /
                 static_cast<double>(directions.size()));
    }
    for (std::size_t k = 0; k < some.size(); ++k)
      out[first + k] = {totals[k][0].value(), totals[k][1].value(), totals[k][2].value()};
  }
  return out;
}

}  // namespace envmap

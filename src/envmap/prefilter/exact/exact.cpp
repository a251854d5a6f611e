// Sums over all texels in double, rows in parallel. Compensated sums over the rows make the result independent of the
// number of threads.
#include "envmap/prefilter/exact/exact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "envmap/base/parallel.h"
#include "envmap/base/stop_point.h"
#include "envmap/maths/compensated_sum.h"
#include "envmap/prefilter/exact/exact_kernels.h"
#include "envmap/prefilter/lobe_in_rectangle.h"
#include "envmap/prefilter/work_counters.h"
#include "envmap/projection/visit.h"

namespace envmap::prefiltering {
namespace {

constexpr double nothing = 1e-30;  // A part of a lobe that no radiance makes count.

// ---- one texel ------------------------------------------------------------------------------------------------------

template <class P, class L>
double over_area(const L& lobe, const Direction& r, int face, const Rect& rect) {
  return quadrature::rectangle<4>(rect, [&](double u, double v) {
    return P::density(u, v) * lobe.value(versine(r, P::direction(face, u, v)));
  });
}

// The part of its value that the lobe loses over a piece, at most; infinite where the horizon crosses the piece. A
// cosine is linear in the direction of light, so that any piece is smooth.
template <class L>
double variation(const L& lobe, const Direction& r, const Moments& p) {
  const double d = glm::length(r - p.centre), near = std::max(0.0, d - p.bounding_radius), far = d + p.bounding_radius;
  const double lo = 0.5 * near * near, hi = 0.5 * far * far;
  if (lo >= 1) return 0;
  if (hi >= 1) return 1e300;
  if constexpr (std::is_same_v<L, Cosine>) return 0;
  return std::max(lobe.rate(lo), lobe.rate(hi)) * std::min(1.0, far) * p.bounding_radius;
}

// The most variation over a piece for which sixteen points are accurate. The error of N points each way is f^2N (N!)^4
// / ((2N+1) (2N)!^3) of exp(f x) over [0,1] (Abramowitz and Stegun 1964, 25.4.30): 4e-8 for a fall of 1.2 over half a
// diagonal. Powers of eight and more have smaller derivatives, other lobes larger ones.
template <class L>
double max_variation(const L& lobe) {
  if constexpr (std::is_same_v<L, Phong>)
    if (lobe.exponent >= 8) return 1.2;
  // Sheen is a power of x with its root in the middle. From 8 on it is like Phong's. For powers of 2 to 8, the eighth
  // derivative is below 0.08 of the one that 1.2 allows, and grows by up to 21 times over the texel. For smaller powers
  // Gauss's error is rho^-8, where rho = 2 / fall is the distance of the root over the radius of the texel.
  if constexpr (std::is_same_v<L, Charlie>) return lobe.power >= 8 ? 1.2 : lobe.power >= 2 ? 0.8 : 0.2;
  return 0.4;
}

// The moments of a piece about the direction in its middle.
template <class P>
Moments place_of(int face, const Rect& rect) {
  const Direction middle = P::direction(face, 0.5 * (rect.u0 + rect.u1), 0.5 * (rect.v0 + rect.v1));
  Moments found{.solid_angle = P::solid_angle(rect), .centre = middle};
  // The farthest point of a small piece is a corner, or little farther.
  for (const double u : {rect.u0, rect.u1})
    for (const double v : {rect.v0, rect.v1})
      found.bounding_radius = std::max(found.bounding_radius, 1.02 * glm::length(P::direction(face, u, v) - middle));
  return found.bounding_radius < 0.2 ? found : moments<P>(face, rect);
}

// The integral over a rectangle. @param p its moments.
template <class P, class L>
double lobe_over(const L& lobe, const Direction& r, int face, const Rect& rect, const Moments& p,
                 std::optional<Border<P>>& border) {
  const double near = std::max(0.0, glm::length(r - p.centre) - p.bounding_radius), nearest = 0.5 * near * near;
  if (p.solid_angle <= 0 || lobe.missing(nearest) < nothing) return 0;
  const double loss = variation(lobe, r, p), most = max_variation(lobe);
  if (p.bounding_radius < 0.2 && loss <= most) return over_area<P>(lobe, r, face, rect);
  // Below that a few quarters are quicker than the border (measured).
  if (loss > 0.8 && p.bounding_radius < 0.3) {
    if (!border) border.emplace(face, rect);
    return integral_round<P>(*border, lobe, r, face, rect, p.solid_angle, p.bounding_radius, nearest);
  }
  double sum = 0;
  for (const Rect& q : quarters(rect)) {
    std::optional<Border<P>> none;
    sum += lobe_over<P>(lobe, r, face, q, place_of<P>(face, q), none);
  }
  return sum;
}

// The integral over a texel. @param simple whether four points may be accurate.
template <class P, class L>
double texel_over(const L& lobe, const Direction& r, int face, const Rect& rect, const Moments& p, bool simple,
                  std::optional<Border<P>>& border) {
  if (!simple || variation(lobe, r, p) >= 0.05) return lobe_over<P>(lobe, r, face, rect, p, border);
  std::array<Direction, 4> points;
  std::array<double, 4> weights;
  gauss_points<P>(face, rect, points, weights);
  double sum = 0;
  for (std::size_t n = 0; n < 4; ++n) sum += weights[n] * lobe.value(versine(r, points[n]));
  return sum;
}

// ---- all texels -----------------------------------------------------------------------------------------------------

// Gauss points of all texels of a row: four each, and sixteen.
class RowPoints {
 public:
  RowPoints(const Level& source, int face, int row) {
    std::vector<Vec2<double>> at;
    for (int i = 0; i < source.width(); ++i) {
      grid<2>(i, row, source, at);
      grid<4>(i, row, source, at);
    }
    directions_.resize(at.size()), weights_.resize(at.size());
    directions(source.projection(), face, at, directions_);
    densities(source.projection(), at, weights_);
  }
  void set(std::size_t texel, double across, double down, ExactTexel& t) const {
    std::size_t from = texel * (t.few.size() + t.many.size());
    from = copy<2>(from, across * down, t.few, t.few_weights);
    copy<4>(from, across * down, t.many, t.many_weights);
  }

 private:
  template <int N>
  static void grid(int i, int row, const Level& source, std::vector<Vec2<double>>& at) {
    const auto& node = quadrature::rule<N>().node;
    for (const double v : node)
      for (const double u : node)
        at.emplace_back((i + 0.5 + 0.5 * u) / source.width(), (row + 0.5 + 0.5 * v) / source.height());
  }
  template <int N, std::size_t M>
  std::size_t copy(std::size_t from, double area, std::array<Direction, M>& points,
                   std::array<double, M>& weights) const {
    const auto& weight = quadrature::rule<N>().weight;
    for (std::size_t n = 0; n < M; ++n, ++from) {
      points[n] = directions_[from];
      weights[n] = 0.25 * area * weight[n / N] * weight[n % N] * weights_[from];
    }
    return from;
  }
  std::vector<Direction> directions_;
  std::vector<double> weights_;
};

// The least x in [low, high] from which `is` holds, by bisection.
template <class F>
double least_where(double low, double high, F&& is) {
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    (is(middle) ? high : low) = middle;
  }
  return high;
}

// A texel holds at most 4 pi of the source's mean in steradians:
// where a lobe is below 1e-15 it adds less than 2e-14 of that.
template <class L>
SampleThresholds thresholds_of(const L& lobe) {
  const auto is_faint = [&](double x) { return lobe.value(x) < 1e-15; };
  return {.start = is_faint(0) ? least_where(0, lobe.peak(), [&](double x) { return !is_faint(x); }) : 0,
          .faint = least_where(lobe.peak(), 1, is_faint),
          .end = least_where(0, 1, [&](double x) { return lobe.missing(x) < nothing; }),
          .max_variation = max_variation(lobe)};
}

// One row of a face in all directions. @param by_points many directions at once, where points are accurate.
template <class P, class L>
std::vector<Flux> row_of(const Level& source, const L& lobe, std::span<const Direction> directions, bool by_points,
                         int face, int row) {
  const double w = source.width(), h = source.height();
  const SampleThresholds thresholds = thresholds_of(lobe);
  ExactSums sums(directions);
  std::vector<std::uint32_t> every(directions.size()), left;
  std::iota(every.begin(), every.end(), 0U);
  std::optional<RowPoints> points;
  if (by_points) points.emplace(source, face, row);
  ExactTexel texel;
  for (int i = 0; i < source.width(); ++i) {
    const Flux radiance(*source.texel(face, i, row));
    if (radiance == Flux(0)) continue;
    stop_point();
    const Rect rect = texel_rect(i, row, w, h);
    const Moments p = moments<P>(face, rect);
    const bool simple = p.bounding_radius < 0.02, together = points && p.bounding_radius < 0.2;
    if (together) {
      texel.centre = p.centre, texel.bounding_radius = p.bounding_radius, texel.simple = simple;
      texel.radiance = {radiance.x, radiance.y, radiance.z};
      points->set(std::size_t(i), 1 / w, 1 / h, texel);
      add_texel(lobe, thresholds, texel, sums, left);
    }
    std::optional<Border<P>> border;
    for (const std::uint32_t k : together ? left : every) {
      const double d = glm::length(directions[k] - p.centre), near = std::max(0.0, d - p.bounding_radius),
                   far = d + p.bounding_radius;
      if (0.5 * near * near >= thresholds.end || 0.5 * far * far <= thresholds.start) continue;
      const double part = texel_over<P>(lobe, directions[k], face, rect, p, simple, border);
      for (std::size_t c = 0; c < 3; ++c) sums.flux[c][k] += part * radiance[int(c)];
    }
  }
  std::vector<Flux> found(directions.size());
  for (std::size_t k = 0; k < found.size(); ++k) found[k] = {sums.flux[0][k], sums.flux[1][k], sums.flux[2][k]};
  return found;
}

std::vector<Flux> exact_sums(const Level& source, const LobeFormula& lobe, std::span<const Direction> directions,
                             bool by_points, const Progress& progress) {
  constexpr std::size_t batch = 512;  // Directions at once: the sums of all rows stay small beside the source.
  count(Work::exact, directions.size() * index_of(source, {source.faces(), 0, 0}));
  std::vector<Flux> out(directions.size());
  for (std::size_t first = 0; first < directions.size(); first += batch) {
    const auto some = directions.subspan(first, std::min(batch, directions.size() - first));
    const int rows = source.faces() * source.height();
    std::vector<std::array<CompensatedSum, 3>> totals(some.size());
    constexpr int band = 64;
    for (int start = 0; start < rows; start += band) {
      source.trim();
      const auto found = map_rows<std::vector<Flux>>(std::min(band, rows - start), [&](int k) {
        const int face = (start + k) / source.height(), row = (start + k) % source.height();
        return visit_source(source.projection(), [&](auto p) {
          return std::visit([&](const auto& l) { return row_of<decltype(p)>(source, l, some, by_points, face, row); },
                            lobe);
        });
      });
      for (const auto& row : found)
        for (std::size_t k = 0; k < some.size(); ++k)
          for (int c = 0; c < 3; ++c) totals[k][std::size_t(c)].add(row[k][c]);
      if (progress)
        progress((double(first) + double(some.size()) * std::min(start + band, rows) / rows) /
                 double(directions.size()));
    }
    for (std::size_t k = 0; k < some.size(); ++k)
      out[first + k] = {totals[k][0].value(), totals[k][1].value(), totals[k][2].value()};
  }
  return out;
}

}  // namespace

std::vector<Flux> exact_prefilter(const Level& source, const LobeFormula& lobe, std::span<const Direction> directions,
                                  const Progress& progress) {
  constexpr std::size_t few = 16;  // Fewer directions do not repay the points of all texels.
  return exact_sums(source, lobe, directions, directions.size() >= few, progress);
}

std::vector<Direction> directions_of(const Target& target, std::span<const Texel> texels) {
  std::vector<Direction> d(texels.size());
  for (std::size_t k = 0; k < d.size(); ++k)
    texel_directions(target.to, target.size, texels[k].face, texels[k].j, texels[k].i, std::span(d).subspan(k, 1));
  rotate(target.to_source, d);
  return d;
}

void exact_texels(const Level& source, const LobeFormula& lobe, const Target& target, std::span<const Texel> texels,
                  Level& out, const Progress& progress) {
  constexpr bool by_points = true;  // However few texels: the result of one must not depend on the others.
  const std::vector<Flux> found = exact_sums(source, lobe, directions_of(target, texels), by_points, progress);
  for (std::size_t k = 0; k < found.size(); ++k)
    *out.texel(texels[k].face, texels[k].i, texels[k].j) = Colour(found[k]);
}

}  // namespace envmap::prefiltering

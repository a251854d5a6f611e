// quad_sampler(), compiled once for every instruction set and chosen at run time.
#include "envmap/sample/quad.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "envmap/sample/area.h"
#include "envmap/sample/outline.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/sample/quad.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace envmap {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<double, 8>;
using V = hn::Vec<Lanes>;
constexpr std::size_t lanes_at_most = hn::MaxLanes(Lanes());

constexpr std::size_t block = 64;       // Texels of a row that are worked on at once; bits of the answer.
constexpr int longest = 24;             // Side of a window, and
constexpr int most_taps = 128;          // texels in it.
constexpr double most_bend = 1.0 / 32;  // Beyond, sides no longer are what their middles show.
constexpr double most_times = 8;        // Times the tolerance: the bound of a mean that is told to be right by another.
constexpr Colour unknown(std::numeric_limits<float>::quiet_NaN());

HWY_INLINE V broadcast(double x) { return hn::Set(Lanes(), x); }

// Places in the plane of the source's texels, one a lane.
struct Place {
  V x, y;
};
HWY_INLINE Place operator-(const Place& a, const Place& b) { return {a.x - b.x, a.y - b.y}; }
HWY_INLINE Place operator+(const Place& a, const Place& b) { return {a.x + b.x, a.y + b.y}; }
HWY_INLINE Place operator*(V s, const Place& a) { return {s * a.x, s * a.y}; }
HWY_INLINE Place middle(const Place& a, const Place& b) { return broadcast(0.5) * (a + b); }
HWY_INLINE V cross(const Place& a, const Place& b) { return a.x * b.y - a.y * b.x; }

// After how many columns a source begins again. 0: it does not.
double period_of(const PaddedLevel& source) { return source.projection() == Projection::latlong ? source.width() : 0; }

// Of texels of a row, in source texels with centres at whole numbers: the corners above (row 0) and below (2), from one
// to the left of the first to one beyond the last, and the middles of upright sides (1). Columns go on over a seam.
struct Grid {
  static constexpr std::size_t size = block + 3 + lanes_at_most;
  HWY_ALIGN double x[3][size], y[3][size], face[3][size], density[3][size];

  Grid(const PaddedLevel& source, const Target& target, int face_of_target, int row, int first, std::size_t texels) {
    std::array<Point2, size> points;
    std::array<Direction, size> directions;
    std::array<Location<double>, size> at;
    std::array<double, size> densities;
    const double h = target.size, w = h * aspect(target.to), period = period_of(source);
    for (int r = 0; r < 3; ++r) {
      for (std::size_t k = 0; k < texels + 3; ++k) points[k] = {(first - 1.0 + double(k)) / w, (row + 0.5 * r) / h};
      const std::size_t n = texels + 3;
      envmap::directions(target.to, face_of_target, std::span(points).first(n), std::span(directions).first(n));
      rotate(target.to_source, std::span(directions).first(n));
      locate(source.projection(), std::span(directions).first(n), std::span(at).first(n));
      for (std::size_t k = 0; k < n; ++k) {
        points[k] = {at[k].u, at[k].v};
        x[r][k] = at[k].u * source.width() - 0.5, y[r][k] = at[k].v * source.height() - 0.5, face[r][k] = at[k].face;
        const double step = x[r][k] - (k > 0 ? x[r][k - 1] : x[0][0]);
        if (period > 0 && std::abs(step) > 0.5 * period) x[r][k] -= period * std::round(step / period);
      }
      if (r != 1) envmap::densities(source.projection(), std::span(points).first(n), std::span(densities).first(n));
      std::copy_n(densities.begin(), n, density[r]);
      for (std::size_t k = n; k < size; ++k) x[r][k] = y[r][k] = face[r][k] = density[r][k] = 0;
    }
  }

  [[nodiscard]] Place at(int r, std::size_t k) const {
    return {hn::LoadU(Lanes(), &x[r][k]), hn::LoadU(Lanes(), &y[r][k])};
  }
};

// As many quadrilaterals as there are lanes. Those that are not plain have no area, and windows of one texel.
struct Quads {
  HWY_ALIGN double left[lanes_at_most], top[lanes_at_most], columns[lanes_at_most], rows[lanes_at_most];
  HWY_ALIGN double off[lanes_at_most];  // Share of the area that may be wrong; 1 where it is not plain.
  HWY_ALIGN double mean_density[lanes_at_most];
  Place corners[4];       // In order, from the left and the top of the window.
  V density[4], along_x;  // At the corners; how it grows with x. Both up to a factor.
};

// The middle of a level side off its chord's, by the corners to both sides: a second difference is the same along them.
HWY_INLINE Place off_level(const Grid& grid, int r, std::size_t k) {
  const Place inner = middle(grid.at(r, k + 1), grid.at(r, k + 2)), outer = middle(grid.at(r, k), grid.at(r, k + 3));
  return broadcast(0.125) * (inner - outer);
}

// Moves a quadrilateral along `way` so that two opposite sides, parabolas whose middles lie off their chords, have as
// much to one side of them as to the other. Returns the area in between: a parabola of height 1 differs from its mean
// by 0.2566 in the mean, and from its chord by 2/3.
V straighten(const Place (&off)[2], const Place (&chord)[2], const Place& way, Place (&corners)[4]) {
  const Place bend = middle(off[0], off[1]), unlike = off[0] - bend, mean_chord = middle(chord[0], chord[1]);
  const V share = cross(bend, mean_chord) / cross(way, mean_chord);
  for (Place& c : corners) c = c + (broadcast(2.0 / 3) * share) * way;
  const V like = hn::Abs(cross(bend, chord[0])) + hn::Abs(cross(bend, chord[1]));
  const V rest = hn::Abs(cross(unlike, chord[0])) + hn::Abs(cross(unlike, chord[1]));
  return broadcast(0.2566) * like + broadcast(2.0 / 3) * rest;
}

HWY_INLINE V least_of(V a, V b, V c, V d) { return hn::Min(hn::Min(a, b), hn::Min(c, d)); }
HWY_INLINE V most_of(V a, V b, V c, V d) { return hn::Max(hn::Max(a, b), hn::Max(c, d)); }

// The texels that quadrilaterals lie over. `left` is within the source's columns, `unwrapped` where the corners are.
struct Window {
  V left, unwrapped, top, columns, rows;

  Window(const PaddedLevel& source, const Place (&c)[4])
      : unwrapped(hn::Floor(least_of(c[0].x, c[1].x, c[2].x, c[3].x))),
        top(hn::Floor(least_of(c[0].y, c[1].y, c[2].y, c[3].y))) {
    const V two = broadcast(2), padding = broadcast(Level::padding);
    const V turns = hn::Floor((unwrapped + padding) / broadcast(source.width()));
    left = unwrapped - broadcast(period_of(source)) * turns;
    columns = hn::Floor(most_of(c[0].x, c[1].x, c[2].x, c[3].x)) + two - unwrapped;
    rows = hn::Floor(most_of(c[0].y, c[1].y, c[2].y, c[3].y)) + two - top;
  }

  // Whether it is small enough, and within the source and its padding.
  [[nodiscard]] auto is_plain(const PaddedLevel& source) const {
    const V padding = broadcast(Level::padding);
    const auto is_small =
        hn::And(hn::Le(columns * rows, broadcast(most_taps)), hn::Le(hn::Max(columns, rows), broadcast(longest)));
    const auto is_inside = hn::And(hn::Le(left + columns, broadcast(source.width()) + padding),
                                   hn::Le(top + rows, broadcast(source.height()) + padding));
    return hn::And(hn::And(is_small, is_inside), hn::Le(hn::Neg(padding), hn::Min(left, top)));
  }
};

// Sets the windows, and leaves out what is not plain: over an edge or too large, or not convex.
// @param twice the area, of either sign. @param off share of the area that may be wrong.
void set_window(const PaddedLevel& source, const Grid& grid, std::size_t k, const Place (&c)[4], V twice, V off,
                Quads& q) {
  const Lanes d;
  const V one = broadcast(1);
  const Window w(source, c);
  auto plain = hn::And(w.is_plain(source), hn::Le(off, broadcast(most_bend)));
  for (int s = 0; s < 4; ++s) {
    const V face = hn::LoadU(d, &grid.face[s / 2 * 2][k + 1 + std::size_t(s % 2)]);
    const V turn = cross(c[(s + 1) % 4] - c[s], c[(s + 2) % 4] - c[s]);
    plain =
        hn::And(plain, hn::And(hn::Eq(face, hn::LoadU(d, &grid.face[0][k + 1])), hn::Gt(twice * turn, hn::Zero(d))));
  }
  hn::Store(w.left, d, q.left), hn::Store(w.top, d, q.top);
  hn::Store(hn::IfThenElse(plain, w.columns, one), d, q.columns);
  hn::Store(hn::IfThenElse(plain, w.rows, one), d, q.rows);
  // Densities are linear but for an eighth of their second derivative.
  const V arc = hn::Max(w.columns, w.rows) * broadcast(1.5 / source.height());
  hn::Store(hn::IfThenElse(plain, off + arc * arc, one), d, q.off);
  for (int s = 0; s < 4; ++s)
    q.corners[s] = {hn::IfThenElseZero(plain, c[s].x - w.unwrapped), hn::IfThenElseZero(plain, c[s].y - w.top)};
}

// The densities of quadrilaterals that are plain: the plane through their mean that grows as they do along the
// diagonals. @param twice the area, of either sign.
void set_densities(const Grid& grid, std::size_t k, const Place (&unmoved)[4], const Place (&c)[4], V twice, Quads& q) {
  const Lanes d;
  const Place e = unmoved[2] - unmoved[0], f = unmoved[3] - unmoved[1];
  const Place heart = middle(middle(unmoved[0], unmoved[2]), middle(unmoved[1], unmoved[3]));
  const V density[4] = {hn::LoadU(d, &grid.density[0][k + 1]), hn::LoadU(d, &grid.density[0][k + 2]),
                        hn::LoadU(d, &grid.density[2][k + 2]), hn::LoadU(d, &grid.density[2][k + 1])};
  const V de = density[2] - density[0], df = density[3] - density[1];
  const V gx = (de * f.y - df * e.y) / twice, gy = (e.x * df - f.x * de) / twice;
  const V sum = (density[0] + density[1]) + (density[2] + density[3]);
  hn::Store(broadcast(0.25) * sum, d, q.mean_density);
  const V scale = hn::CopySign(broadcast(4) / sum, twice);  // Whichever way the corners go round.
  const auto plain = hn::Lt(hn::Load(d, q.off), broadcast(1));
  q.along_x = hn::IfThenElseZero(plain, gx * scale);
  for (int s = 0; s < 4; ++s) {
    const Place from = c[s] - heart;
    const V grown = scale * (gx * from.x + gy * from.y);
    q.density[s] = hn::IfThenElseZero(plain, hn::CopySign(broadcast(1), twice) + grown);
  }
}

// The quadrilaterals of the texels from column k of a grid on.
void set_quads(const PaddedLevel& source, const Grid& grid, std::size_t k, Quads& q) {
  const Place unmoved[4] = {grid.at(0, k + 1), grid.at(0, k + 2), grid.at(2, k + 2), grid.at(2, k + 1)};
  Place c[4] = {unmoved[0], unmoved[1], unmoved[2], unmoved[3]};
  const V twice = cross(c[2] - c[0], c[3] - c[1]);
  const Place level[2] = {c[1] - c[0], c[2] - c[3]}, upright[2] = {c[3] - c[0], c[2] - c[1]};
  const Place off_upright[2] = {grid.at(1, k + 1) - middle(c[0], c[3]), grid.at(1, k + 2) - middle(c[1], c[2])};
  V off = straighten({off_level(grid, 0, k), off_level(grid, 2, k)}, level, middle(upright[0], upright[1]), c);
  off = off + straighten(off_upright, upright, middle(level[0], level[1]), c);
  set_window(source, grid, k, c, twice, (off + off) / hn::Abs(twice), q);
  set_densities(grid, k, unmoved, c, twice, q);
}

// Weights of the texels of windows.
struct Weights {
  int columns, rows;  // Of the largest.
  HWY_ALIGN float of[(longest + 2) * (longest + 2)][lanes_at_most];
  HWY_ALIGN double wedges[(longest + 2) * (longest + 2)][lanes_at_most];

  // By Green's theorem the integral of max(x - i, 0) max(y - j, 0) x density over an area is that of
  // max(x - i, 0)^2 / 2 max(y - j, 0) (density - slope max(x - i, 0) / 3) over its sides, by dy; and a texel's hat is a
  // second difference of such wedges. Two Gauss points are exact for a cubic, which this is but for the slope.
  void add_side(const Quads& q, int s) {
    const Lanes d;
    const V zero = hn::Zero(d), one = broadcast(1), tiny = broadcast(1e-30);
    const int next = (s + 1) % 4;
    const Place a = q.corners[s], side = q.corners[next] - a;
    const V dx = hn::IfThenElse(hn::Eq(side.x, zero), tiny, side.x),
            dy = hn::IfThenElse(hn::Eq(side.y, zero), tiny, side.y);
    const V per_x = one / dx, per_y = one / dy;
    const auto rightwards = hn::Gt(dx, zero), downwards = hn::Gt(dy, zero);
    const V grows = q.density[next] - q.density[s], third = broadcast(1.0 / 3) * q.along_x;
    HWY_ALIGN double from_x[longest + 2][lanes_at_most], to_x[longest + 2][lanes_at_most];
    const auto clamped = [&](V x) HWY_ATTR { return hn::Min(hn::Max(x, zero), one); };
    for (int i = 0; i < columns; ++i) {
      const V at = clamped((broadcast(i - 1.0) - a.x) * per_x);
      hn::Store(hn::IfThenElse(rightwards, at, zero), d, from_x[i]);
      hn::Store(hn::IfThenElse(rightwards, one, at), d, to_x[i]);
    }
    for (int j = 0; j < rows; ++j) {
      const V at = clamped((broadcast(j - 1.0) - a.y) * per_y);
      const V from_y = hn::IfThenElse(downwards, at, zero), to_y = hn::IfThenElse(downwards, one, at);
      const V ay = a.y - broadcast(j - 1.0);
      double(*out)[lanes_at_most] = wedges + j * (columns + 2);
      for (int i = 0; i < columns; ++i) {
        const V from = hn::Max(hn::Load(d, from_x[i]), from_y), to = hn::Min(hn::Load(d, to_x[i]), to_y);
        const V length = hn::Max(to - from, zero), mid = broadcast(0.5) * (from + to);
        const V step = length * broadcast(0.28867513459481287);  // To the Gauss points: 1 / (2 sqrt(3)).
        const V ax = a.x - broadcast(i - 1.0);
        const auto value = [&](V t) HWY_ATTR {
          const V x = ax + side.x * t, y = ay + side.y * t;
          return ((x * x) * y) * ((q.density[s] + grows * t) - third * x);
        };
        hn::Store(hn::Load(d, out[i]) + (length * side.y) * (value(mid - step) + value(mid + step)), d, out[i]);
      }
    }
  }

  void find(const Quads& q) {
    const Lanes d;
    columns = rows = 1;
    for (std::size_t k = 0; k < hn::Lanes(d); ++k)
      columns = std::max(columns, int(q.columns[k])), rows = std::max(rows, int(q.rows[k]));
    const int wide = columns + 2;
    for (int k = 0; k < wide * (rows + 2); ++k) hn::Store(hn::Zero(d), d, wedges[k]);
    for (int s = 0; s < 4; ++s) add_side(q, s);
    const auto difference = [&](int k, int step) HWY_ATTR {
      const V twice = broadcast(2) * hn::Load(d, wedges[k + step]);
      return (hn::Load(d, wedges[k]) - twice) + hn::Load(d, wedges[k + 2 * step]);
    };
    const hn::Rebind<float, Lanes> df;
    for (int k = 0; k < wide * rows; ++k)
      if (k % wide < columns) hn::Store(difference(k, 1), d, wedges[k]);
    for (int k = 0; k < wide * rows; ++k)
      if (k % wide < columns) hn::Store(hn::DemoteTo(df, hn::Max(hn::Zero(d), difference(k, wide))), df, of[k]);
  }
};

// The light of a texel, summed over its quadrilaterals.
struct TexelSum {
  Rgb<double> light{0}, off{0};  // The bound of the error of `light`.
  double solid_angle = 0;        // Up to a factor.
  bool is_known = true;          // Not if a quadrilateral is not plain.

  // Whether the bound is within the tolerance.
  [[nodiscard]] bool is_within(double tolerance, double floor, const Colour& mean) const {
    for (int c = 0; c < 3; ++c)
      if (!(off[c] <= solid_angle * tolerance * std::max<double>(mean[c], floor))) return false;
    return true;
  }
  // Whether the mean hardly differs from that of half the division, which is off by several times as much.
  [[nodiscard]] bool is_settled(double tolerance, double floor, const Colour& before, const Colour& mean) const {
    for (int c = 0; c < 3; ++c)
      if (!(std::abs(mean[c] - before[c]) <= 0.25 * tolerance * std::max<double>(mean[c], floor))) return false;
    return is_within(most_times * tolerance, floor, mean);
  }
};

void add(const PaddedLevel& source, int face, const Quads& q, const Weights& weights, std::size_t lane, TexelSum& sum) {
  if (!(q.off[lane] < 1)) return void(sum.is_known = false);
  const int left = int(q.left[lane]), top = int(q.top[lane]), columns = int(q.columns[lane]), rows = int(q.rows[lane]);
  const hn::CappedTag<float, 4> d;  // The fourth channel is the next texel's, or a spare one.
  HWY_ALIGN float lights[4], lows[4], highs[4];
  float whole = 0;
  for (std::size_t c = 0; c < 4; c += hn::Lanes(d)) {
    auto light = hn::Zero(d), low = hn::LoadU(d, &source.texel(face, left, top)->x + c), high = low;
    whole = 0;
    for (int j = 0; j < rows; ++j) {
      const float* radiance = &source.texel(face, left, top + j)->x + c;
      const float(*weight)[lanes_at_most] = weights.of + j * (weights.columns + 2);
      for (int i = 0; i < columns; ++i, radiance += 3) {
        const auto texel = hn::LoadU(d, radiance);
        light = light + hn::Set(d, weight[i][lane]) * texel;
        low = hn::Min(low, texel), high = hn::Max(high, texel);
        whole += weight[i][lane];
      }
    }
    hn::Store(light, d, lights + c), hn::Store(low, d, lows + c), hn::Store(high, d, highs + c);
  }
  // Beyond the largest float: area_sampler() sums in double.
  if (!std::isfinite(lights[0] + lights[1] + lights[2])) return void(sum.is_known = false);
  const double scale = q.mean_density[lane];
  for (int c = 0; c < 3; ++c) {
    sum.light[c] += scale * lights[c];
    sum.off[c] += scale * whole * q.off[lane] * (highs[c] - lows[c]);
  }
  sum.solid_angle += scale * whole;
}

// At most `block` / `division` texels of a row, each by `division` x `division` quadrilaterals. Returns a bit for each
// of those that were not within the tolerance.
std::uint64_t SampleQuads(const PaddedLevel& source, const Target& target, int division, double tolerance, double floor,
                          bool estimates, int face, int row, int first, std::span<Colour> out) {
  static thread_local Weights weights;
  Target parts = target;
  parts.size *= division;
  const std::size_t count = out.size() * std::size_t(division);
  std::array<TexelSum, block> sums{};
  Quads q;
  for (int part = 0; part < division; ++part) {
    const Grid grid(source, parts, face, row * division + part, first * division, count);
    for (std::size_t k = 0; k < count; k += hn::Lanes(Lanes())) {
      set_quads(source, grid, k, q);
      weights.find(q);
      for (std::size_t lane = 0; lane < std::min(hn::Lanes(Lanes()), count - k); ++lane)
        add(source, int(grid.face[0][k + lane + 1]), q, weights, lane, sums[(k + lane) / std::size_t(division)]);
    }
  }
  std::uint64_t open = 0;
  for (std::size_t k = 0; k < out.size(); ++k) {
    const Colour before = out[k];
    out[k] = sums[k].is_known ? Colour(sums[k].light / sums[k].solid_angle) : unknown;
    if (!sums[k].is_within(tolerance, floor, out[k]) &&
        !(estimates && division > 1 && sums[k].is_settled(tolerance, floor, before, out[k])))
      open |= std::uint64_t(1) << k;
  }
  return open;
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace envmap {

HWY_EXPORT(SampleQuads);

bool quads_suit(const PaddedLevel& source, const Target& target) {
  return !target.ball && !on_disc(source.projection()) && !is_octahedral(source.projection());
}

namespace {

constexpr int most_division = 8;

struct Task {
  const PaddedLevel& source;
  Target target;
  double tolerance, floor;
  bool estimates;
  Sampler otherwise;

  void sample(int division, int face, int row, int first, std::span<Colour> out) const {
    if (division > most_division) return otherwise(face, row, first, out);
    const std::size_t block = HWY_NAMESPACE::block / std::size_t(division);
    for (std::size_t start = 0; start < out.size(); start += block)
      sample_block(division, face, row, first + int(start), out.subspan(start, std::min(block, out.size() - start)));
  }

  void sample_block(int division, int face, int row, int first, std::span<Colour> out) const {
    std::uint64_t open =
        HWY_DYNAMIC_DISPATCH(SampleQuads)(source, target, division, tolerance, floor, estimates, face, row, first, out);
    while (open != 0) {
      const int begin = std::countr_zero(open), count = std::countr_one(open >> begin);
      sample(2 * division, face, row, first + begin, out.subspan(std::size_t(begin), std::size_t(count)));
      open = begin + count < 64 ? open >> (begin + count) << (begin + count) : 0;
    }
  }
};

}  // namespace

Sampler quad_sampler(const PaddedLevel& source, const Target& target, double tolerance, double floor, bool estimates) {
  const Task task{source, target,    tolerance,
                  floor,  estimates, area_sampler(source, target, tolerance, floor, estimates)};
  return [task](int face, int row, int first, std::span<Colour> out) {
    for (std::size_t end, k = 0; k < out.size(); k = end) {
      const bool cut = is_cut_by_rim(task.target, row, first + int(k));
      for (end = k + 1; end < out.size() && is_cut_by_rim(task.target, row, first + int(end)) == cut;) ++end;
      const std::span texels = out.subspan(k, end - k);
      cut ? task.otherwise(face, row, first + int(k), texels) : task.sample(1, face, row, first + int(k), texels);
    }
  };
}

}  // namespace envmap
#endif  // HWY_ONCE

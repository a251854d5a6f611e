// The middles of narrow lobes, summed over the texels of the source: narrower than any grid of multilevel sums.
// Compiled once for every instruction set and chosen at run time.
#include <algorithm>
#include <array>
#include <cmath>

#include "envmap/base/eight_lanes.h"
#include "envmap/prefilter/multilevel_kernels.h"
#include "envmap/projection/cube.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/prefilter/lobe_core.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "envmap/prefilter/core_places-inl.h"

#ifndef ENVMAP_PREFILTER_LOBE_CORE_ONCE
#define ENVMAP_PREFILTER_LOBE_CORE_ONCE
namespace envmap::prefiltering {
namespace {

// A rule for texels that are even enough, and the coordinates across of its points: see the places below.
struct RuleAcross {
  Rule rule;
  double part;             // Of the unevenness that four points of a panel do for.
  float* x = nullptr;      // Of the first point of each texel.
  std::size_t stride = 0;  // To those of the next point.

  // That of each texel from k on, about in its middle.
  [[nodiscard]] const float* middles(std::size_t k) const { return x + rule.count / 2 * stride + k; }
};

// From the sparsest on.
using Rules = std::array<RuleAcross, 3>;

// Texels of one row of the source, as an output sees them.
struct RowOfTexels {
  std::span<const Colour> row;
  int first, count;  // Column of the first, which may lie beyond the row: rows of latlong maps wrap.
  Piece texel;       // The first.
  const Rules& rules;
  std::size_t from;  // Place of the first texel in the coordinates.
};

// The light of a source is counted from the darkest, in a unit that keeps its sums within floats.
struct Light {
  const Level& source;
  const Colour& darkest;
  float scale, scale_again;  // Their product is 1 / unit, which may be beyond floats.
  Light(const Level& of, const Colour& least, double unit)
      : source(of), darkest(least), scale(float(1 / std::sqrt(unit))), scale_again(scale) {}
};

}  // namespace
}  // namespace envmap::prefiltering
#endif

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {

// A column that may lie beyond the row by less than its length.
HWY_INLINE int column_of(int k, int columns) { return k < 0 ? k + columns : k >= columns ? k - columns : k; }

// Eight texels from k on as planes; 0 after the last.
struct EightTexels {
  alignas(32) float light[3][virtual_lanes];

  HWY_INLINE EightTexels(const RowOfTexels& texels, int k, const Light& of) {
    const int columns = int(texels.row.size()), count = std::min(int(virtual_lanes), texels.count - k);
    int at = column_of(texels.first + k, columns);
    alignas(32) float some[3 * virtual_lanes];
    const float* from = &texels.row[std::size_t(at)].x;
    if (at + int(virtual_lanes) > columns) {
      for (int i = 0; i < int(virtual_lanes); ++i, at = at + 1 < columns ? at + 1 : 0)
        for (int c = 0; c < 3; ++c) some[3 * i + c] = texels.row[std::size_t(at)][c];
      from = some;
    }
    const D d;
    for (std::size_t part = 0; part < parts; ++part) {
      V channel[3];
      hn::LoadInterleaved3(d, from + 3 * part * lanes, channel[0], channel[1], channel[2]);
      const auto is_there = hn::Lt(hn::Iota(d, float(part * lanes)), hn::Set(d, float(count)));
      for (int c = 0; c < 3; ++c) {
        const V above = hn::Sub(channel[c], hn::Set(d, of.darkest[c]));
        hn::Store(hn::IfThenElseZero(is_there,
                                     hn::Mul(hn::Mul(above, hn::Set(d, of.scale)), hn::Set(d, of.scale_again))),
                  d, light[c] + part * lanes);
      }
    }
  }
};

// Whether sixteen points do: pieces small beside their distance from where the kernel has its pole, or is steep.
template <class K>
bool is_even(const K& kernel, double size, double nearest) {
  if (kernel.k.kind == LevelKernel::Kind::ggx)
    return size * size <= double(kernel.k.uneven) * (nearest * nearest + 2 * double(kernel.k.a));
  return size * (nearest + size) * double(kernel.k.power * kernel.k.part) <= double(kernel.k.uneven);
}

// Whether a rule's points do in each of some texels. @param size of a texel. @param x of the middles of the texels.
template <class K>
HWY_INLINE auto rule_does(const K& kernel, const RuleAcross& r, double size, V x) {
  const D d;
  const V square = hn::Add(x, x);
  const float uneven = float(r.part) * kernel.k.uneven;
  if (kernel.k.kind == LevelKernel::Kind::ggx)
    return hn::Le(hn::Set(d, float(size * size)),
                  hn::Mul(hn::Set(d, uneven), hn::Add(square, hn::Set(d, 2 * kernel.k.a))));
  const float steep = float(size * r.rule.panel) * kernel.k.power * kernel.k.part;
  return hn::Le(hn::Mul(hn::Set(d, steep * steep), hn::Add(square, hn::Set(d, float(size * size)))),
                hn::Set(d, uneven * uneven));
}

template <class Place, class K>
double over(const Place& place, const K& kernel, const Piece& p, int depth) {
  const Seen s = place.seen(p);
  V nearest = s.x[0];
  for (std::size_t k = 1; k < vectors; ++k) nearest = hn::Min(nearest, s.x[k]);
  // No place is farther from a point than half the largest gap each way.
  const double near = std::sqrt(2 * double(-largest(hn::Neg(nearest)))) - 0.25 * s.size, end = double(kernel.k.end);
  if (near > 0 && near * near > 2 * end) return 0;
  if (depth < 40 && !(s.size < 0.3 && is_even(kernel, s.size, std::max(0.0, near)))) {
    const double x = 0.5 * (p.x0 + p.x1), y = 0.5 * (p.y0 + p.y1);
    const auto part = [&](double x0, double x1, double y0, double y1) {
      return over(place, kernel, {x0, x1, y0, y1}, depth + 1);
    };
    return (part(p.x0, x, p.y0, y) + part(x, p.x1, p.y0, y)) + (part(p.x0, x, y, p.y1) + part(x, p.x1, y, p.y1));
  }
  V sum[parts];
  for (std::size_t k = 0; k < parts; ++k) {
    const V inside = hn::Mul(kernel(s.x[k]), s.weight[k]);
    sum[k] = hn::Add(inside, hn::Mul(kernel(s.x[k + parts]), s.weight[k + parts]));
  }
  return 0.25 * (p.x1 - p.x0) * (p.y1 - p.y0) * sum_of(sum);
}

// The sum of weight x kernel over a rule's points of some texels, from place k on.
template <class Place, class K>
HWY_INLINE V by_rule(const Place& place, const K& kernel, const typename Place::Row& row, const RuleAcross& r,
                     std::size_t k) {
  const D d;
  V sum = hn::Zero(d);
  for (std::size_t e = 0; e < r.rule.count; ++e) {
    const V across = hn::LoadU(d, r.x + e * r.stride + k);
    V column = hn::Zero(d);
    for (std::size_t g = 0; g < r.rule.count; ++g)
      column = hn::Add(column, hn::Mul(place.weight(row, g, across), kernel(place.versine(row, g, across))));
    sum = hn::Add(sum, hn::Mul(hn::Set(d, float(r.rule.weight[e])), column));
  }
  return sum;
}

// A row of texels as rules see it, each made when it is wanted.
template <class Place>
class RowByRules {
 public:
  RowByRules(const Place& place, const RowOfTexels& texels)
      : place_(place), texels_(texels), first_(place.first_rule(texels.texel)) {}

  HWY_INLINE const typename Place::Row& of(std::size_t rule) {
    if (!made_[rule]) place_.set(texels_.texel, texels_.rules[rule].rule, rows_[rule]), made_[rule] = true;
    return rows_[rule];
  }

  // The sparsest rule that does for eight texels from k on, or the last.
  template <class K>
  HWY_INLINE std::size_t sparsest(const K& kernel, std::size_t k) {
    std::size_t rule = first_;
    for (; rule + 1 < texels_.rules.size(); ++rule) {
      const RuleAcross& r = texels_.rules[rule];
      const typename Place::Row& row = of(rule);
      bool does = true;
      for (std::size_t part = 0; part < parts; ++part) {
        const V x = place_.versine(row, r.rule.count / 2, hn::LoadU(D(), r.middles(texels_.from + k + part * lanes)));
        does = does && hn::AllTrue(D(), rule_does(kernel, r, row.size, x));
      }
      if (does) break;
    }
    return rule;
  }

 private:
  const Place& place_;
  const RowOfTexels& texels_;
  const std::size_t first_;
  std::array<typename Place::Row, 3> rows_;
  std::array<bool, 3> made_{};
};

// By the sparsest rule that does, else by pieces.
template <class Place, class K>
Flux over_row(const Place& place, const K& kernel, const RowOfTexels& texels, const Light& of) {
  const D d;
  const Piece& first = texels.texel;
  const double wide = first.x1 - first.x0, high = first.y1 - first.y0;
  RowByRules<Place> rows(place, texels);
  Sums total;
  Flux pieces(0);
  for (int k = 0; k < texels.count; k += int(virtual_lanes)) {
    const EightTexels eight(texels, k, of);
    const std::size_t chosen = rows.sparsest(kernel, std::size_t(k));
    const RuleAcross& r = texels.rules[chosen];
    const typename Place::Row& row = rows.of(chosen);
    for (std::size_t part = 0; part < parts; ++part) {
      const std::size_t at = std::size_t(k) + part * lanes;
      const V of_middles = place.versine(row, r.rule.count / 2, hn::LoadU(d, r.middles(texels.from + at)));
      const auto even = rule_does(kernel, r, row.size, of_middles);
      const V sum = hn::IfThenElseZero(even, by_rule(place, kernel, row, r, texels.from + at));
      total.add(part, sum, eight.light[0] + part * lanes, virtual_lanes);
      if (hn::AllTrue(d, even)) continue;
      std::uint8_t bits[8] = {};
      hn::StoreMaskBits(d, even, bits);
      for (std::size_t i = 0; i < lanes && at + i < std::size_t(texels.count); ++i) {
        const std::size_t n = part * lanes + i;
        const Flux light(eight.light[0][n], eight.light[1][n], eight.light[2][n]);
        if ((bits[0] >> i & 1) != 0 || light == Flux(0)) continue;
        const double left = first.x0 + double(at + i) * wide;
        pieces += over(place, kernel, {left, left + wide, first.y0, first.y1}, 0) * light;
      }
    }
  }
  return pieces + wide * high * total.whole();
}

template <class Place>
Flux OverRow(const Place& place, const LevelKernel& k, const RowOfTexels& texels, const Light& of) {
  const auto with = [&](const auto& kernel) { return over_row(place, kernel, texels, of); };
  if (k.kind == LevelKernel::Kind::power) return k.cosine ? with(OfPower<true>{k}) : with(OfPower<false>{k});
  return k.quartic ? with(OfGgx<false, true, true>{k}) : with(OfGgx<false, true, false>{k});
}

// How many panels of four points do for a side, where a lobe is steepest.
std::size_t panels_for(const LevelKernel& k, double side) {
  if (k.kind == LevelKernel::Kind::ggx) return 1;
  const double steep = side * double(k.power * k.part) * (std::sqrt(2 * double(k.end)) + side);
  const double panels = steep / double(k.uneven);
  return panels <= 1 ? 1 : panels <= 2 ? 2 : 4;
}

// Rules for texels with a side, and room for the coordinates of so many, until this thread asks for others.
// What each does for by the terms that Gauss's rules leave out, h^4 / 4320 and h^6 / 2016000 of the fourth and sixth
// derivative: 1e-5 to 5e-5 of a texel.
Rules rules_for(const LevelKernel& k, double side, int texels) {
  const bool ggx = k.kind == LevelKernel::Kind::ggx;
  Rules rules{{{two_points(), ggx ? 0.04 : 0.06},
               {three_points(), ggx ? 0.25 : 0.4},
               {four_points(panels_for(k, side)), ggx ? 0.6 : 1}}};
  thread_local std::vector<float> room;
  const std::size_t stride = std::size_t(texels) + 2 * virtual_lanes;
  std::size_t size = 0;
  for (RuleAcross& r : rules) r.stride = stride, size += r.rule.count * stride;
  if (room.size() < size) room.resize(size);
  float* x = room.data();
  for (RuleAcross& r : rules) r.x = x, x += r.rule.count * stride;
  return rules;
}

// Columns of a row of a latlong map.
struct Window {
  int row, first, last;
  OnLatlong::Side top;
  double least_sine;
};

// What is within x = end of a direction. @param at its column.
std::vector<Window> windows(const Level& source, double end, const GridView& view, const OnLatlong& place, double at) {
  const double reach = 2 * portable::asin(std::sqrt(0.5 * end)), step = pi / source.height();
  const int columns = source.width(), low = std::max(0, int((view.angle - reach) / step)),
            high = std::min(source.height() - 1, int((view.angle + reach) / step));
  std::vector<Window> all;
  OnLatlong::Side above = place.side(low * step - view.angle);
  for (int row = low; row <= high; ++row) {
    const OnLatlong::Side top = above, below = place.side((row + 1) * step - view.angle);
    const double sine = std::min(top.sine, below.sine);
    const double c = top.off.sine > 0 ? top.off.versine : below.off.sine < 0 ? below.off.versine : 0;
    above = below;
    const double versine = (end - c) / std::max(1e-30, sine * view.sine);
    if (versine <= 0) continue;
    const double half = versine >= 2 ? columns : half_width(versine, columns);
    int first = int(std::floor(at - half)), last = int(std::floor(at + half));
    if (last - first + 1 > columns) first = int(std::floor(at)) - columns / 2, last = first + columns - 1;
    all.push_back({row, first, last, top, sine});
  }
  return all;
}

// Rows lie far apart in memory.
HWY_INLINE void prefetch(std::span<const Colour> row, const Window& w) {
  constexpr int in_cache_line = 5;
  const int columns = int(row.size());
  for (int k = w.first; k <= w.last; k += in_cache_line) hwy::Prefetch(&row[std::size_t(column_of(k, columns))]);
}

Flux OfLatlong(const Light& light, const LevelKernel& k, const GridView& view) {
  const Level& source = light.source;
  const OnLatlong place(view);
  const int columns = source.width();
  const double at = view.longitude * columns / (2 * pi), wide = 2 * pi / columns, step = pi / source.height();
  const std::vector<Window> rows = windows(source, double(k.end), view, place, at);
  if (rows.empty()) return Flux(0);
  int low = rows[0].first, high = rows[0].last;
  for (const Window& w : rows) {
    low = std::min(low, w.first), high = std::max(high, w.last);
    prefetch(source.row(0, w.row), w);
  }
  const Rules rules = rules_for(k, step, high - low + 1);
  for (const RuleAcross& r : rules)
    for (std::size_t e = 0; e < r.rule.count; ++e)
      versines(at - r.rule.at[e], columns, low, high + int(virtual_lanes), r.x + e * r.stride);
  Flux sum(0);
  for (const Window& w : rows) {
    const double x = (w.first - at) * wide, y = w.row * step - view.angle;
    sum += OverRow(place.of_row(w.top, w.least_sine), k,
                   {source.row(0, w.row),
                    w.first,
                    w.last - w.first + 1,
                    {x, x + wide, y, y + step},
                    rules,
                    std::size_t(w.first - low)},
                   light);
  }
  return sum;
}

// Which of a face's rows or columns reach to within `reach` of a direction, whose part in front is `ahead`, whose part
// to the side `aside`.
struct Cells {
  int first, last;
};
Cells cells_of(double ahead, double aside, double reach, int size) {
  const double angle = portable::atan2(aside, ahead);
  const double wide =
      portable::asin(std::min(1.0, portable::sin_pi(reach / pi) / portable::hypot(ahead, aside))) + 1e-9;
  const auto cell = [&](double a) {
    const double turn = std::clamp(a / pi, -0.25, 0.25);
    return int(std::floor(0.5 * size * (1 + portable::sin_pi(turn) / portable::cos_pi(turn))));
  };
  return {std::max(0, cell(angle - wide)), std::min(size - 1, cell(angle + wide))};
}

Flux OfCube(const Light& light, const LevelKernel& k, const Direction& n) {
  const Level& source = light.source;
  const double reach = 2 * portable::asin(std::sqrt(0.5 * double(k.end)));
  const int size = source.height();
  const double wide = 2.0 / size;
  Flux sum(0);
  for (int face = 0; face < 6; ++face) {
    const Cube::Axes& a = Cube::axes[std::size_t(face)];
    const double ahead = glm::dot(n, a.forward), right = glm::dot(n, a.right), up = glm::dot(n, a.up);
    if (ahead < 0.3) continue;  // Beyond a corner by more than 0.2 radians.
    const Cells across = cells_of(ahead, right, reach, size), down = cells_of(ahead, -up, reach, size);
    const double s = right / ahead, t = -up / ahead;
    const int count = across.last - across.first + 1;
    if (count <= 0) continue;
    const OnCube place{float(s), float(t), float(std::sqrt(1 + s * s + t * t))};
    const double left = across.first * wide - 1 - s;
    const Rules rules = rules_for(k, wide, count);
    for (const RuleAcross& r : rules)
      for (std::size_t e = 0; e < r.rule.count; ++e)
        for (int i = 0; i < count + int(virtual_lanes); ++i)
          r.x[e * r.stride + std::size_t(i)] = float(left + (i + r.rule.at[e]) * wide);
    for (int row = down.first; row <= down.last; ++row) {
      const double y = row * wide - 1 - t;
      sum += OverRow(place, k, {source.row(face, row), across.first, count, {left, left + wide, y, y + wide}, rules, 0},
                     light);
    }
  }
  return sum;
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace envmap::prefiltering {
HWY_EXPORT(OfLatlong);
HWY_EXPORT(OfCube);

Flux core_sum(const Level& source, const Colour& darkest, double unit, const LevelKernel& kernel,
              const Direction& direction) {
  const Light light(source, darkest, unit);
  if (source.projection() == Projection::cube)
    return kernel.scale * HWY_DYNAMIC_DISPATCH(OfCube)(light, kernel, direction);
  return kernel.scale * HWY_DYNAMIC_DISPATCH(OfLatlong)(light, kernel, GridView(direction));
}

}  // namespace envmap::prefiltering
#endif  // HWY_ONCE

// Rows of texels by rules of Gauss points, eight texels at a time, and by pieces of a texel where a lobe is too uneven
// for them. Included once a target.
#include "envmap/prefilter/near_field/gauss_points-inl.h"
#include "envmap/prefilter/near_field/near_field.h"
#include "envmap/prefilter/work_counters.h"

#if defined(ENVMAP_PREFILTER_CORE_RULES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ENVMAP_PREFILTER_CORE_RULES_INL_H_
#undef ENVMAP_PREFILTER_CORE_RULES_INL_H_
#else
#define ENVMAP_PREFILTER_CORE_RULES_INL_H_
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
template <std::size_t some, class Place, class K>
HWY_INLINE V by_points(const Place& place, const K& kernel, const typename Place::Row& row, const RuleAcross& r,
                       std::size_t k) {
  const D d;
  const std::size_t count = some > 0 ? some : r.rule.count;  // Loops of a few points are unrolled.
  V sum = hn::Zero(d);
  for (std::size_t e = 0; e < count; ++e) {
    const V across = hn::LoadU(d, r.x + e * r.stride + k);
    V column = hn::Zero(d);
    for (std::size_t g = 0; g < count; ++g)
      column = hn::Add(column, hn::Mul(place.weight(row, g, across), kernel(place.versine(row, g, across))));
    sum = hn::Add(sum, hn::Mul(hn::Set(d, r.rule.weight_lanes[e]), column));
  }
  return sum;
}
template <class Place, class K>
HWY_INLINE V by_rule(const Place& place, const K& kernel, const typename Place::Row& row, const RuleAcross& r,
                     std::size_t k) {
  if (r.rule.count == 2) return by_points<2>(place, kernel, row, r, k);
  if (r.rule.count == 3) return by_points<3>(place, kernel, row, r, k);
  return by_points<0>(place, kernel, row, r, k);
}

// A row of texels as rules see it, each made when it is wanted.
template <class Place>
class RowByRules {
 public:
  RowByRules(const Place& place, const Rules& rules, const RowOfTexels& texels)
      : place_(place), rules_(rules), texels_(texels), first_(place.first_rule(texels.texel)) {}

  HWY_INLINE const typename Place::Row& of(std::size_t rule) {
    if (!made_[rule]) place_.set(texels_.texel, rules_.all[rule].rule, rows_[rule]), made_[rule] = true;
    return rows_[rule];
  }

  // The sparsest rule that does for eight texels from k on, or the last.
  template <class K>
  HWY_INLINE std::size_t sparsest(const K& kernel, std::size_t k) {
    const auto from = std::size_t(texels_.first - rules_.low);
    std::size_t rule = first_;
    for (; rule + 1 < rules_.all.size(); ++rule) {
      const RuleAcross& r = rules_.all[rule];
      const typename Place::Row& row = of(rule);
      bool does = true;
      for (std::size_t part = 0; part < parts; ++part) {
        const V x = place_.versine(row, r.rule.count / 2, hn::LoadU(D(), r.middle_of(from + k + part * lanes)));
        does = does && hn::AllTrue(D(), rule_does(kernel, r, row.size, x));
      }
      if (does) break;
    }
    return rule;
  }

 private:
  const Place& place_;
  const Rules& rules_;
  const RowOfTexels& texels_;
  const std::size_t first_;
  std::array<typename Place::Row, 3> rows_;
  std::array<bool, 3> made_{};
};

// By the sparsest rule that does, else by pieces.
template <class Place, class K>
Flux over_row(const Place& place, const K& kernel, const Rules& rules, const RowOfTexels& texels, const Light& of) {
  const D d;
  const Piece& first = texels.texel;
  const double wide = first.x1 - first.x0, high = first.y1 - first.y0;
  RowByRules<Place> rows(place, rules, texels);
  const auto from = std::size_t(texels.first - rules.low);
  Sums total;
  Flux pieces(0);
  std::size_t points = 0;
  for (int k = 0; k < texels.count; k += int(virtual_lanes)) {
    const EightTexels eight(texels, k, of);
    const std::size_t chosen = rows.sparsest(kernel, std::size_t(k));
    const RuleAcross& r = rules.all[chosen];
    const typename Place::Row& row = rows.of(chosen);
    points += virtual_lanes * r.rule.count * r.rule.count;
    for (std::size_t part = 0; part < parts; ++part) {
      const std::size_t at = std::size_t(k) + part * lanes;
      const V of_middles = place.versine(row, r.rule.count / 2, hn::LoadU(d, r.middle_of(from + at)));
      const auto even = rule_does(kernel, r, row.size, of_middles);
      const V sum = hn::IfThenElseZero(even, by_rule(place, kernel, row, r, from + at));
      total.add(part, sum, eight.light[0] + part * lanes, virtual_lanes);
      if (hn::AllTrue(d, even)) continue;
      std::uint8_t bits[8] = {};
      hn::StoreMaskBits(d, even, bits);
      for (std::size_t i = 0; i < lanes && at + i < std::size_t(texels.count); ++i) {
        const std::size_t n = part * lanes + i;
        const Flux light(eight.light[0][n], eight.light[1][n], eight.light[2][n]);
        if ((bits[0] >> i & 1) != 0 || light == Flux(0)) continue;
        const double left = first.x0 + double(at + i) * wide;
        points += 16, pieces += over(place, kernel, {left, left + wide, first.y0, first.y1}, 0) * light;
      }
    }
  }
  count(Work::core_points, points);
  return pieces + wide * high * total.whole();
}

template <class Place>
Flux OverRow(const Place& place, const LevelKernel& k, const Rules& rules, const RowOfTexels& texels, const Light& of) {
  const auto with = [&](const auto& kernel) { return over_row(place, kernel, rules, texels, of); };
  if (k.kind == LevelKernel::Kind::power) return k.cosine ? with(OfPower<true>{k}) : with(OfPower<false>{k});
  return k.quartic ? with(OfGgx<false, true, true>{k}) : with(OfGgx<false, true, false>{k});
}

// The power of e that a power falls by over a side, where it is steepest.
double fall_over(const LevelKernel& k, double side) {
  return side * double(k.power * k.part) * (std::sqrt(2 * double(k.end)) + side);
}

// How many panels of four points do for a side, where a lobe is steepest.
std::size_t panels_for(const LevelKernel& k, double side) {
  if (k.kind == LevelKernel::Kind::ggx) return 1;
  const double panels = fall_over(k, side) / double(k.uneven);
  return panels <= 1 ? 1 : panels <= 2 ? 2 : 4;
}

// Rules for texels with a side, and room for the coordinates of so many columns from `low` on and a vector more, until
// this thread asks for others.
// What each does for by the terms that Gauss's rules leave out, h^4 / 4320 and h^6 / 2016000 of the fourth and sixth
// derivative: 1e-5 to 5e-5 of a texel.
Rules rules_for(const LevelKernel& k, double side, int low, int columns) {
  const bool ggx = k.kind == LevelKernel::Kind::ggx;
  Rules rules{{{{two_points, ggx ? 0.028 : 0.06},
                {three_points, ggx ? 0.175 : 0.4},
                {four_points[panels_for(k, side) / 2], ggx ? 0.45 : 1}}},
              low};
  thread_local std::vector<float> room;
  const std::size_t stride = std::size_t(columns) + 2 * virtual_lanes;
  std::size_t size = 0;
  for (RuleAcross& r : rules.all) r.stride = stride, size += r.rule.count * stride;
  if (room.size() < size) room.resize(size);
  float* x = room.data();
  for (RuleAcross& r : rules.all) r.x = x, x += r.rule.count * stride;
  return rules;
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();
#endif

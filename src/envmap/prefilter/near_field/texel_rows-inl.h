// The near field over rows of texels. Included once a target.
//
// Most texels lie far from the middle of a lobe, where 2 x 2 or 3 x 3 Gauss points are accurate. Eight texels at a time
// take the sparsest rule whose remainder is small enough in all of them (Abramowitz and Stegun 1964, 25.4.30). A texel
// that no rule serves is divided into pieces of 4 x 4 points until each is small beside its distance from the middle.
// tests/bench/kappa.cpp measures the error of all rules together.
#include "envmap/prefilter/near_field/gauss_points-inl.h"
#include "envmap/prefilter/near_field/near_field.h"
#include "envmap/prefilter/near_field/point_rules.h"
#include "envmap/prefilter/work_counters.h"

#if defined(ENVMAP_PREFILTER_TEXEL_ROWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ENVMAP_PREFILTER_TEXEL_ROWS_INL_H_
#undef ENVMAP_PREFILTER_TEXEL_ROWS_INL_H_
#else
#define ENVMAP_PREFILTER_TEXEL_ROWS_INL_H_
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
      const auto is_there = hn::Lt(hn::Iota(d, float(part * lanes)), broadcast(count));
      for (int c = 0; c < 3; ++c) {
        const V above = channel[c] - broadcast(of.min_radiance[c]);
        hn::Store(hn::IfThenElseZero(is_there, above * broadcast(of.scale) * broadcast(of.scale_again)), d,
                  light[c] + part * lanes);
      }
    }
  }
};

// Whether sixteen points are accurate: the piece is small beside its distance from the pole of the kernel, or a power
// falls little enough over it.
template <class K>
bool is_smooth(const K& kernel, double size, double nearest) {
  if (kernel.k.kind == LevelKernel::Kind::ggx)
    return size * size <= double(kernel.k.max_variation) * (nearest * nearest + 2 * double(kernel.k.a));
  return size * (nearest + size) * double(kernel.k.power * kernel.k.part) <= double(kernel.k.max_variation);
}

// Whether a rule is accurate in each of some texels. @param size of a texel. @param x of the middles of the texels.
template <class K>
HWY_INLINE auto rule_is_accurate(const K& kernel, const RuleAcross& r, double size, V x) {
  const V square = x + x;
  const float most = float(r.part) * kernel.k.max_variation;
  if (kernel.k.kind == LevelKernel::Kind::ggx)
    return hn::Le(broadcast(size * size), broadcast(most) * (square + broadcast(2 * kernel.k.a)));
  const float steep = float(size) * kernel.k.power * kernel.k.part;
  return hn::Le(broadcast(steep * steep) * (square + broadcast(size * size)), broadcast(most * most));
}

// The integral of the kernel over a piece.
template <class Place, class K>
double over_piece(const Place& place, const K& kernel, const Piece& p, int depth) {
  const PiecePoints s = place.points_of(p);
  V nearest = s.x[0];
  for (std::size_t k = 1; k < vectors; ++k) nearest = hn::Min(nearest, s.x[k]);
  // No place is farther from a point than half of the largest gap between points.
  const double near = std::sqrt(2 * double(-largest(hn::Neg(nearest)))) - 0.25 * s.size, end = double(kernel.k.end);
  if (near > 0 && near * near > 2 * end) return 0;
  if (depth < 40 && !(s.size < 0.3 && is_smooth(kernel, s.size, std::max(0.0, near)))) {
    const double x = 0.5 * (p.x0 + p.x1), y = 0.5 * (p.y0 + p.y1);
    const auto part = [&](double x0, double x1, double y0, double y1) {
      return over_piece(place, kernel, {x0, x1, y0, y1}, depth + 1);
    };
    return (part(p.x0, x, p.y0, y) + part(x, p.x1, p.y0, y)) + (part(p.x0, x, y, p.y1) + part(x, p.x1, y, p.y1));
  }
  V sum[parts];
  for (std::size_t k = 0; k < parts; ++k) {
    const V inside = kernel(s.x[k]) * s.weight[k];
    sum[k] = inside + kernel(s.x[k + parts]) * s.weight[k + parts];
  }
  return 0.25 * (p.x1 - p.x0) * (p.y1 - p.y0) * sum_of(sum);
}

// The sum of weight x kernel over a rule's points of a vector of texels, from column k on.
template <std::size_t some, class Place, class K>
HWY_INLINE V by_points(const Place& place, const K& kernel, const typename Place::Row& row, const RuleAcross& r,
                       std::size_t k) {
  const D d;
  const std::size_t count = some > 0 ? some : r.rule->count;  // Loops of a few points are unrolled.
  V sum = hn::Zero(d);
  for (std::size_t e = 0; e < count; ++e) {
    const V across = hn::LoadU(d, r.x + e * r.stride + k);
    V column = hn::Zero(d);
    for (std::size_t g = 0; g < count; ++g)
      column += place.weight(row, g, across) * kernel(place.versine(row, g, across));
    sum += broadcast(r.rule->weight_lanes[e]) * column;
  }
  return sum;
}
template <class Place, class K>
HWY_INLINE V by_rule(const Place& place, const K& kernel, const typename Place::Row& row, const RuleAcross& r,
                     std::size_t k) {
  if (r.rule->count == 2) return by_points<2>(place, kernel, row, r, k);
  if (r.rule->count == 3) return by_points<3>(place, kernel, row, r, k);
  return by_points<0>(place, kernel, row, r, k);
}

// The sum of light x kernel over a row of texels.
template <class Place, class K>
class RowSum {
 public:
  RowSum(const Place& place, const K& kernel, const Rules& rules, const RowOfTexels& texels)
      : place_(place),
        kernel_(kernel),
        rules_(rules),
        texels_(texels),
        column_(std::size_t(texels.first - rules.low)),
        first_rule_(place.first_rule(texels.texel)) {}

  Flux over(const Light& light) {
    Sums total;
    Flux pieces(0);
    for (int k = 0; k < texels_.count; k += int(virtual_lanes)) {
      const EightTexels eight(texels_, k, light);
      const std::size_t rule = sparsest_rule(std::size_t(k));
      const RuleAcross& r = rules_.all[rule];
      points_ += virtual_lanes * r.rule->count * r.rule->count;
      for (std::size_t part = 0; part < parts; ++part) {
        const std::size_t at = std::size_t(k) + part * lanes;
        const auto accurate = is_accurate(rule, at);
        const V sum = hn::IfThenElseZero(accurate, by_rule(place_, kernel_, row(rule), r, column_ + at));
        total.add(part, sum, eight.light[0] + part * lanes, virtual_lanes);
        if (!hn::AllTrue(D(), accurate)) add_pieces(accurate, eight, part, at, pieces);
      }
    }
    count(Work::near_field_points, points_);
    const Piece& first = texels_.texel;
    return pieces + (first.x1 - first.x0) * (first.y1 - first.y0) * total.whole();
  }

 private:
  // The points down the row by a rule, made when they are first used.
  HWY_INLINE const typename Place::Row& row(std::size_t rule) {
    if (!made_[rule]) place_.set(texels_.texel, *rules_.all[rule].rule, rows_[rule]), made_[rule] = true;
    return rows_[rule];
  }

  // Whether a rule is accurate in each texel of a vector from texel k on.
  HWY_INLINE auto is_accurate(std::size_t rule, std::size_t k) {
    const RuleAcross& r = rules_.all[rule];
    const typename Place::Row& points = row(rule);
    const V middle = place_.versine(points, r.rule->count / 2, hn::LoadU(D(), r.middle_of(column_ + k)));
    return rule_is_accurate(kernel_, r, points.size, middle);
  }

  // The sparsest rule that is accurate in all of eight texels from texel k on, or the last rule.
  HWY_INLINE std::size_t sparsest_rule(std::size_t k) {
    for (std::size_t rule = first_rule_; rule + 1 < rules_.count; ++rule) {
      bool all = true;
      for (std::size_t part = 0; part < parts; ++part)
        all = all && hn::AllTrue(D(), is_accurate(rule, k + part * lanes));
      if (all) return rule;
    }
    return rules_.count - 1;
  }

  // Adds the texels of a vector, from texel k on, for which the rule is not accurate.
  void add_pieces(hn::Mask<D> accurate, const EightTexels& eight, std::size_t part, std::size_t k, Flux& sum) {
    const Piece& first = texels_.texel;
    const double wide = first.x1 - first.x0;
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(D(), accurate, bits);
    for (std::size_t i = 0; i < lanes && k + i < std::size_t(texels_.count); ++i) {
      const std::size_t n = part * lanes + i;
      const Flux light(eight.light[0][n], eight.light[1][n], eight.light[2][n]);
      if ((bits[0] >> i & 1) != 0 || light == Flux(0)) continue;
      const double left = first.x0 + double(k + i) * wide;
      points_ += 16, sum += over_piece(place_, kernel_, {left, left + wide, first.y0, first.y1}, 0) * light;
    }
  }

  const Place& place_;
  const K& kernel_;
  const Rules& rules_;
  const RowOfTexels& texels_;
  const std::size_t column_, first_rule_;  // The first texel's among the coordinates of the rules.
  std::array<typename Place::Row, Rules::most> rows_;
  std::array<bool, Rules::most> made_{};
  std::size_t points_ = 0;
};

template <class Place>
Flux OverRow(const Place& place, const LevelKernel& k, const Rules& rules, const RowOfTexels& texels,
             const Light& light) {
  const auto with = [&](const auto& kernel) { return RowSum(place, kernel, rules, texels).over(light); };
  if (k.kind == LevelKernel::Kind::power) return k.cosine ? with(PowerKernel<true>{k}) : with(PowerKernel<false>{k});
  return k.quartic ? with(GgxKernel<false, true, true>{k}) : with(GgxKernel<false, true, false>{k});
}

// rules_of() with room for the coordinates of `columns` columns from `low` on and a vector more. The room is kept until
// this thread asks for others.
Rules rules_for(const LevelKernel& k, double side, int low, int columns) {
  Rules rules = rules_of(k, side);
  rules.low = low;
  thread_local std::vector<float> room;
  const std::size_t stride = std::size_t(columns) + 2 * virtual_lanes;
  std::size_t size = 0;
  for (RuleAcross& r : rules.used()) r.stride = stride, size += r.rule->count * stride;
  if (room.size() < size) room.resize(size);
  float* x = room.data();
  for (RuleAcross& r : rules.used()) r.x = x, x += r.rule->count * stride;
  return rules;
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();
#endif

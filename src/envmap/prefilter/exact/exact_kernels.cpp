// add_texel(), compiled once for every instruction set and chosen at run time.
#include "envmap/prefilter/exact/exact_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/prefilter/exact/exact_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "envmap/prefilter/lobe_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {

using D = hn::CappedTag<double, ExactSums::lanes>;
using V = hn::Vec<D>;

template <class T>
HWY_INLINE V broadcast(T c) {
  return broadcast(D(), c);
}

// The bound of |d ln(value) / dx| of lobe.h, rate(). A cosine is linear: points are accurate whatever it loses.
HWY_INLINE V log_slope(const Cosine&, V /*x*/) { return hn::Zero(D()); }
HWY_INLINE V log_slope(const Phong& l, V x) { return broadcast(l.exponent) / (broadcast(1) - x); }
HWY_INLINE V log_slope(const Ggx& l, V x) {
  const V q = broadcast(l.a) + broadcast(l.b) * x;
  return broadcast(1) / (broadcast(1) - x) + broadcast(2 * l.b) / q;
}
HWY_INLINE V log_slope(const BlinnPhong& l, V x) {
  return broadcast(1) / (broadcast(1) - x) + broadcast(l.power) / (broadcast(2) - x);
}
HWY_INLINE V log_slope(const Charlie& l, V x) {
  const D d;
  const V y = hn::Max(x, broadcast(d, 1e-300));
  return broadcast(l.power) / y + broadcast(1) / (broadcast(1) - x);
}

HWY_INLINE V square_of(const ExactSums& sums, std::size_t k, const Direction& p) {
  const D d;
  const V x = hn::LoadU(d, &sums.direction[0][k]) - broadcast(p.x),
          y = hn::LoadU(d, &sums.direction[1][k]) - broadcast(p.y),
          z = hn::LoadU(d, &sums.direction[2][k]) - broadcast(p.z);
  return x * x + y * y + z * z;
}

template <class L, std::size_t N>
HWY_INLINE V over_points(const L& lobe, const ExactSums& sums, std::size_t k, const std::array<Direction, N>& points,
                         const std::array<double, N>& weights) {
  const D d;
  V sum = hn::Zero(d);
  for (std::size_t n = 0; n < N; ++n) {
    const V x = broadcast(0.5) * square_of(sums, k, points[n]);
    sum += broadcast(weights[n]) * value(lobe, d, x);
  }
  return sum;
}

template <class L>
void add_lanes(const L& lobe, const SampleThresholds& thresholds, const ExactTexel& t, ExactSums& sums,
               std::vector<std::uint32_t>& left) {
  const D d;
  const V one = broadcast(1), half = broadcast(0.5), reach = broadcast(t.bounding_radius);
  for (std::size_t k = 0; k < sums.direction[0].size(); k += hn::Lanes(d)) {
    const V distance = hn::Sqrt(square_of(sums, k, t.centre));
    const V near = hn::Max(hn::Zero(d), distance - reach), far = distance + reach;
    const V low = half * (near * near), high = half * (far * far);
    const auto seen = hn::And(hn::Lt(low, broadcast(thresholds.end)), hn::Gt(high, broadcast(thresholds.start)));
    if (hn::AllFalse(d, seen)) continue;
    // The part of its value that the lobe loses over the texel, at most.
    const V fall = hn::Max(log_slope(lobe, low), log_slope(lobe, high)) * (hn::Min(one, far) * reach);
    const auto whole = hn::And(seen, hn::Lt(high, one));
    const auto faint = hn::And(seen, hn::Ge(low, broadcast(thresholds.faint)));
    const auto few = hn::Or(faint, hn::And(whole, hn::Lt(fall, broadcast(t.simple ? 0.05 : 0.0))));
    const auto many = hn::AndNot(few, hn::And(whole, hn::Le(fall, broadcast(thresholds.max_variation))));
    V part = hn::Zero(d);
    if (!hn::AllFalse(d, few)) part = hn::IfThenElseZero(few, over_points(lobe, sums, k, t.few, t.few_weights));
    if (!hn::AllFalse(d, many)) part = hn::IfThenElse(many, over_points(lobe, sums, k, t.many, t.many_weights), part);
    for (std::size_t c = 0; c < 3; ++c) {
      double* to = &sums.flux[c][k];
      hn::StoreU(hn::LoadU(d, to) + part * broadcast(t.radiance[c]), d, to);
    }
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::AndNot(hn::Or(few, many), seen), bits);
    for (std::size_t n = 0; n < hn::Lanes(d) && k + n < sums.count; ++n)
      if (bits[0] >> n & 1) left.push_back(std::uint32_t(k + n));
  }
}

void AddTexel(const LobeFormula& lobe, const SampleThresholds& thresholds, const ExactTexel& texel, ExactSums& sums,
              std::vector<std::uint32_t>& left) {
  std::visit([&](const auto& l) HWY_ATTR { add_lanes(l, thresholds, texel, sums, left); }, lobe);
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace envmap::prefiltering {

HWY_EXPORT(AddTexel);

ExactSums::ExactSums(std::span<const Direction> directions) : count(directions.size()) {
  const std::size_t padded = (count + lanes - 1) / lanes * lanes;
  for (std::size_t n = 0; n < 3; ++n) {
    direction[n].resize(padded, 0), flux[n].resize(padded, 0);
    for (std::size_t k = 0; k < count; ++k) direction[n][k] = directions[k][int(n)];
  }
}

void add_texel(const LobeFormula& lobe, const SampleThresholds& thresholds, const ExactTexel& texel, ExactSums& sums,
               std::vector<std::uint32_t>& left) {
  left.clear();
  HWY_DYNAMIC_DISPATCH(AddTexel)(lobe, thresholds, texel, sums, left);
}

}  // namespace envmap::prefiltering
#endif  // HWY_ONCE

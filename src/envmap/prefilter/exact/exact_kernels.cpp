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

// rate() of lobe.h: slope over value, without the division. A cosine is a line: points do whatever it loses.
HWY_INLINE V rate(const Cosine&, V /*x*/) { return hn::Zero(D()); }
HWY_INLINE V rate(const Phong& l, V x) {
  const D d;
  return hn::Div(hn::Set(d, l.exponent), hn::Sub(hn::Set(d, 1), x));
}
HWY_INLINE V rate(const Ggx& l, V x) {
  const D d;
  const V q = hn::Add(hn::Set(d, l.a), hn::Mul(hn::Set(d, l.b), x));
  return hn::Add(hn::Div(hn::Set(d, 1), hn::Sub(hn::Set(d, 1), x)), hn::Div(hn::Set(d, 2 * l.b), q));
}
HWY_INLINE V rate(const BlinnPhong& l, V x) {
  const D d;
  return hn::Add(hn::Div(hn::Set(d, 1), hn::Sub(hn::Set(d, 1), x)),
                 hn::Div(hn::Set(d, l.power), hn::Sub(hn::Set(d, 2), x)));
}
HWY_INLINE V rate(const Charlie& l, V x) {
  const D d;
  const V y = hn::Max(x, set(d, 1e-300));
  return hn::Add(hn::Div(hn::Set(d, l.power), y), hn::Div(hn::Set(d, 1), hn::Sub(hn::Set(d, 1), x)));
}

HWY_INLINE V square_of(const ExactSums& sums, std::size_t k, const Direction& p) {
  const D d;
  const V x = hn::Sub(hn::LoadU(d, &sums.direction[0][k]), hn::Set(d, p.x)),
          y = hn::Sub(hn::LoadU(d, &sums.direction[1][k]), hn::Set(d, p.y)),
          z = hn::Sub(hn::LoadU(d, &sums.direction[2][k]), hn::Set(d, p.z));
  return hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
}

template <class L, std::size_t N>
HWY_INLINE V over_points(const L& lobe, const ExactSums& sums, std::size_t k, const std::array<Direction, N>& points,
                         const std::array<double, N>& weights) {
  const D d;
  V sum = hn::Zero(d);
  for (std::size_t n = 0; n < N; ++n) {
    const V x = hn::Mul(hn::Set(d, 0.5), square_of(sums, k, points[n]));
    sum = hn::Add(sum, hn::Mul(hn::Set(d, weights[n]), value(lobe, d, x)));
  }
  return sum;
}

template <class L>
void add_lanes(const L& lobe, const Closeness& close, const ExactTexel& t, ExactSums& sums,
               std::vector<std::uint32_t>& left) {
  const D d;
  const V one = hn::Set(d, 1), half = hn::Set(d, 0.5), reach = hn::Set(d, t.reach);
  for (std::size_t k = 0; k < sums.direction[0].size(); k += hn::Lanes(d)) {
    const V distance = hn::Sqrt(square_of(sums, k, t.centre));
    const V near = hn::Max(hn::Zero(d), hn::Sub(distance, reach)), far = hn::Add(distance, reach);
    const V low = hn::Mul(half, hn::Mul(near, near)), high = hn::Mul(half, hn::Mul(far, far));
    const auto seen = hn::And(hn::Lt(low, hn::Set(d, close.end)), hn::Gt(high, hn::Set(d, close.start)));
    if (hn::AllFalse(d, seen)) continue;
    // How much of its value the lobe loses over the texel, at most.
    const V fall = hn::Mul(hn::Max(rate(lobe, low), rate(lobe, high)), hn::Mul(hn::Min(one, far), reach));
    const auto whole = hn::And(seen, hn::Lt(high, one));
    const auto faint = hn::And(seen, hn::Ge(low, hn::Set(d, close.faint)));
    const auto few = hn::Or(faint, hn::And(whole, hn::Lt(fall, hn::Set(d, t.simple ? 0.05 : 0.0))));
    const auto many = hn::AndNot(few, hn::And(whole, hn::Le(fall, hn::Set(d, close.most_uneven))));
    V part = hn::Zero(d);
    if (!hn::AllFalse(d, few)) part = hn::IfThenElseZero(few, over_points(lobe, sums, k, t.few, t.few_weights));
    if (!hn::AllFalse(d, many)) part = hn::IfThenElse(many, over_points(lobe, sums, k, t.many, t.many_weights), part);
    for (std::size_t c = 0; c < 3; ++c) {
      double* to = &sums.flux[c][k];
      hn::StoreU(hn::Add(hn::LoadU(d, to), hn::Mul(part, hn::Set(d, t.radiance[c]))), d, to);
    }
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::AndNot(hn::Or(few, many), seen), bits);
    for (std::size_t n = 0; n < hn::Lanes(d) && k + n < sums.count; ++n)
      if (bits[0] >> n & 1) left.push_back(std::uint32_t(k + n));
  }
}

void AddTexel(const Lobe& lobe, const Closeness& close, const ExactTexel& texel, ExactSums& sums,
              std::vector<std::uint32_t>& left) {
  std::visit([&](const auto& l) HWY_ATTR { add_lanes(l, close, texel, sums, left); }, lobe);
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

void add_texel(const Lobe& lobe, const Closeness& close, const ExactTexel& texel, ExactSums& sums,
               std::vector<std::uint32_t>& left) {
  left.clear();
  HWY_DYNAMIC_DISPATCH(AddTexel)(lobe, close, texel, sums, left);
}

}  // namespace envmap::prefiltering
#endif  // HWY_ONCE

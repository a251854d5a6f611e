/// @file
/// The formulae of lobe.h for vectors of float or double, for any Highway target. Included once a target, by files that
/// foreach_target.h compiles. Every target gives the same bits (fast_math-inl.h).
#if defined(ENVMAP_PREFILTER_LOBE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ENVMAP_PREFILTER_LOBE_LANES_INL_H_
#undef ENVMAP_PREFILTER_LOBE_LANES_INL_H_
#else
#define ENVMAP_PREFILTER_LOBE_LANES_INL_H_
#endif

#include "envmap/prefilter/fast_math-inl.h"
#include "envmap/prefilter/lobe_formulas.h"

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {
// value(): lobe.h's. It may be asked for a little below x = 0, where a series goes on, and then at most doubles or so.

template <class D, class V>
HWY_INLINE V value(const Cosine&, D d, V x) {
  return broadcast(d, 1 / pi) * hn::Max(hn::Zero(d), broadcast(d, 1) - x);
}

template <class D, class V>
HWY_INLINE V value(const Phong& l, D d, V x) {
  const V power = exp2_small(d, broadcast(d, l.exponent) * log2_one_minus(d, x));
  return hn::IfThenElseZero(hn::Lt(x, broadcast(d, 1)), broadcast(d, l.scale()) * power);
}

// With q = a + b x, s = b / q and c = 1 - x: value = k c / q^2.
template <class D, class V>
HWY_INLINE V ggx_base(const Ggx& l, D d, V x) {
  return hn::Max(broadcast(d, 0.5 * l.a), broadcast(d, l.a) + broadcast(d, l.b) * x);
}
template <class D, class V>
HWY_INLINE V value(const Ggx& l, D d, V x) {
  const V q = ggx_base(l, d, x);
  return broadcast(d, l.scale) * hn::Max(hn::Zero(d), broadcast(d, 1) - x) / (q * q);
}

// With q = 1 - x/2, c = 1 - x and p the power: value = k c q^p, and by Leibniz's rule, each derivative of q^p brings p
// / (2q). All keep their sign and rise or fall throughout [0,1].
template <class D, class V>
HWY_INLINE V blinn_power(const BlinnPhong& l, D d, V x) {
  const V log = log2_one_minus(d, broadcast(d, 0.5) * x);
  return broadcast(d, l.scale) * exp2_small(d, broadcast(d, l.power) * log);
}
template <class D, class V>
HWY_INLINE V value(const BlinnPhong& l, D d, V x) {
  return blinn_power(l, d, hn::Min(x, broadcast(d, 1))) * hn::Max(hn::Zero(d), broadcast(d, 1) - x);
}

template <class D, class V>
HWY_INLINE V charlie_power(const Charlie& l, D d, V x) {
  const V y = hn::Max(x, broadcast(d, 1e-30)), log = log2_of(d, y, broadcast(d, 1) - y);
  return broadcast(d, l.scale()) * exp2_small(d, broadcast(d, l.power) * log);
}
template <class D, class V>
HWY_INLINE V value(const Charlie& l, D d, V x) {
  const V inside = hn::IfThenElseZero(hn::Gt(x, hn::Zero(d)), charlie_power(l, d, hn::Min(x, broadcast(d, 1))));
  return inside * hn::Max(hn::Zero(d), broadcast(d, 1) - x);
}
}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();

#endif  // ENVMAP_PREFILTER_LOBE_LANES_INL_H_

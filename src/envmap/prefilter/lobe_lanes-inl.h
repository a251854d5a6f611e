/// @file
/// The formulae of the lobes for vectors of float or double, for any Highway target. Included once a target, by files
/// that foreach_target.h compiles. Only operations that IEEE 754 rounds in one way: every target gives the same bits.
#if defined(ENVMAP_PREFILTER_LOBE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ENVMAP_PREFILTER_LOBE_LANES_INL_H_
#undef ENVMAP_PREFILTER_LOBE_LANES_INL_H_
#else
#define ENVMAP_PREFILTER_LOBE_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

#include "envmap/maths/portable.h"
#include "envmap/prefilter/lobe.h"

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// A number as a vector of lanes.
template <class D>
HWY_INLINE hn::Vec<D> set(D d, double c) {
  return hn::Set(d, static_cast<hn::TFromD<D>>(c));
}

/// c0 + c1 z + c2 z^2 + ...: even and odd powers apart, so that a step waits for half as many before it.
template <class D, class V, class... C>
HWY_INLINE V series(D d, V z, C... all) {
  constexpr std::size_t count = sizeof...(C), last = count - 1;
  static_assert(count >= 2);
  const double c[] = {double(all)...};
  const V zz = hn::Mul(z, z);
  V high = set(d, c[last]), next = set(d, c[last - 1]);
  for (std::size_t k = last - 1; k-- > 0;) {
    V& same = (last - k) % 2 == 0 ? high : next;
    same = hn::Add(set(d, c[k]), hn::Mul(zz, same));
  }
  return last % 2 == 0 ? hn::Add(high, hn::Mul(z, next)) : hn::Add(next, hn::Mul(z, high));
}

/// What a lane type's logarithms and powers need.
template <class T>
struct Binary;
template <>
struct Binary<float> {
  static constexpr int mantissa = 23;
  static constexpr std::int32_t three_quarters = 0x3f400000;
  static constexpr double tiny = 1e-30, lowest = -100, shift = 0x1.8p23;
};
template <>
struct Binary<double> {
  static constexpr int mantissa = 52;
  static constexpr std::int64_t three_quarters = 0x3fe8000000000000;
  static constexpr double tiny = 1e-300, lowest = -1000, shift = 0x1.8p52;
};

/// log2(y), y below 2: -2 atanh(x / (2 - x)) / ln 2 of y = 1 - x, after y is brought to [3/4, 3/2) by its exponent; x
/// itself where that is 0, so that small x keep their digits. Relative error 3e-7 of floats, 3e-16 of doubles.
/// @param x 1 - y.
template <class D, class V>
HWY_INLINE V log2_of(D d, V y, V x) {
  using T = hn::TFromD<D>;
  using B = Binary<T>;
  const hn::RebindToSigned<D> di;
  const V one = set(d, 1);
  const auto bits = hn::BitCast(di, hn::Max(y, set(d, B::tiny)));
  const auto exponent = hn::ShiftRight<B::mantissa>(hn::Sub(bits, hn::Set(di, B::three_quarters)));
  const V rest = hn::Sub(one, hn::BitCast(d, hn::Sub(bits, hn::ShiftLeft<B::mantissa>(exponent))));
  const V z = hn::IfThenElse(hn::RebindMask(d, hn::Eq(exponent, hn::Zero(di))), x, rest);
  const V t = hn::Div(z, hn::Sub(set(d, 2), z)), tt = hn::Mul(t, t);
  const auto sum = [&]() HWY_ATTR {
    if constexpr (sizeof(T) == 4)
      return series(d, tt, -2.885390082, -0.9617966939, -0.5770780164, -0.4121985831, -0.3205988980);
    else
      return series(d, tt, -2.8853900817779268, -0.96179669392597555, -0.57707801635558531, -0.41219858311113239,
                    -0.32059889797532518, -0.26230818925253879, -0.22195308321368667, -0.1923593387851951,
                    -0.16972872833987804, -0.15186263588304878, -0.13739952770371080, -0.12545174268599681,
                    -0.11541560327111707);
  };
  return hn::Add(hn::ConvertTo(d, exponent), hn::Mul(t, sum()));
}
template <class D, class V>
HWY_INLINE V log2_one_minus(D d, V x) {
  return log2_of(d, hn::Sub(set(d, 1), x), x);
}

/// 2^y up to y = 1; beyond as that, and below -100 (floats) or -1000 as there. Relative error 2e-7 and 3e-16.
template <class D, class V>
HWY_INLINE V exp2_small(D d, V y) {
  using T = hn::TFromD<D>;
  using B = Binary<T>;
  const hn::RebindToSigned<D> di;
  y = hn::Min(hn::Max(y, set(d, B::lowest)), set(d, 1));
  const V shift = set(d, B::shift), shifted = hn::Add(y, shift), f = hn::Sub(y, hn::Sub(shifted, shift));
  const auto power = [&]() HWY_ATTR {
    if constexpr (sizeof(T) == 4)
      return series(d, f, 1, 0.6931471806, 0.2402265070, 0.05550410866, 0.009618129108, 0.001333355815, 0.0001540353039,
                    0.00001525273380);
    else
      return series(d, f, 1, 0.69314718055994529, 0.24022650695910072, 0.055504108664821583, 0.0096181291076284769,
                    0.0013333558146428443, 0.00015403530393381609, 1.5252733804059841e-05, 1.3215486790144309e-06,
                    1.0178086009239699e-07, 7.0549116208011234e-09, 4.4455382718708116e-10, 2.5678435993488206e-11,
                    1.3691488853904128e-12, 6.7787263548225457e-14);
  };
  return hn::BitCast(d, hn::Add(hn::BitCast(di, power()), hn::ShiftLeft<B::mantissa>(hn::BitCast(di, shifted))));
}

// value(): lobe.h's. It may be asked for a little below x = 0, where a series goes on, and then at most doubles or so.

template <class D, class V>
HWY_INLINE V value(const Cosine&, D d, V x) {
  return hn::Mul(set(d, 1 / pi), hn::Max(hn::Zero(d), hn::Sub(set(d, 1), x)));
}

template <class D, class V>
HWY_INLINE V value(const Phong& l, D d, V x) {
  const V power = exp2_small(d, hn::Mul(set(d, l.exponent), log2_one_minus(d, x)));
  return hn::IfThenElseZero(hn::Lt(x, set(d, 1)), hn::Mul(set(d, l.scale()), power));
}

// With q = a + b x, s = b / q and c = 1 - x: value = k c / q^2.
template <class D, class V>
HWY_INLINE V ggx_base(const Ggx& l, D d, V x) {
  return hn::Max(set(d, 0.5 * l.a), hn::Add(set(d, l.a), hn::Mul(set(d, l.b), x)));
}
template <class D, class V>
HWY_INLINE V value(const Ggx& l, D d, V x) {
  const V q = ggx_base(l, d, x);
  return hn::Div(hn::Mul(set(d, l.scale), hn::Max(hn::Zero(d), hn::Sub(set(d, 1), x))), hn::Mul(q, q));
}

// With q = 1 - x/2, c = 1 - x and p the power: value = k c q^p, and by Leibniz's rule, each derivative of q^p brings p
// / (2q). All keep their sign and rise or fall throughout [0,1].
template <class D, class V>
HWY_INLINE V blinn_power(const BlinnPhong& l, D d, V x) {
  const V log = log2_one_minus(d, hn::Mul(set(d, 0.5), x));
  return hn::Mul(set(d, l.scale), exp2_small(d, hn::Mul(set(d, l.power), log)));
}
template <class D, class V>
HWY_INLINE V value(const BlinnPhong& l, D d, V x) {
  return hn::Mul(blinn_power(l, d, hn::Min(x, set(d, 1))), hn::Max(hn::Zero(d), hn::Sub(set(d, 1), x)));
}

template <class D, class V>
HWY_INLINE V charlie_power(const Charlie& l, D d, V x) {
  const V y = hn::Max(x, set(d, 1e-30)), log = log2_of(d, y, hn::Sub(set(d, 1), y));
  return hn::Mul(set(d, l.scale()), exp2_small(d, hn::Mul(set(d, l.power), log)));
}
template <class D, class V>
HWY_INLINE V value(const Charlie& l, D d, V x) {
  const V inside = hn::IfThenElseZero(hn::Gt(x, hn::Zero(d)), charlie_power(l, d, hn::Min(x, set(d, 1))));
  return hn::Mul(inside, hn::Max(hn::Zero(d), hn::Sub(set(d, 1), x)));
}
}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();

#endif  // ENVMAP_PREFILTER_LOBE_LANES_INL_H_

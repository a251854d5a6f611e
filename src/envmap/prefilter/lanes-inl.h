/// @file
/// Values of the lobes for vectors of floats, for any Highway target. Included once a target, by files that
/// foreach_target.h compiles. Only operations that IEEE 754 rounds in one way: every target gives the same bits.
#if defined(ENVMAP_PREFILTER_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ENVMAP_PREFILTER_LANES_INL_H_
#undef ENVMAP_PREFILTER_LANES_INL_H_
#else
#define ENVMAP_PREFILTER_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include "envmap/prefilter/lobe.h"

HWY_BEFORE_NAMESPACE();
namespace envmap {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// c0 + c1 z + c2 z^2 + ... by Horner's scheme.
template <class D, class V>
HWY_INLINE V series(D d, V /*z*/, float c) {
  return hn::Set(d, c);
}
template <class D, class V, class... C>
HWY_INLINE V series(D d, V z, float c, C... higher) {
  return hn::Add(hn::Set(d, c), hn::Mul(z, series(d, z, higher...)));
}

/// log2(1 - x) for x in [-1,1): -2 atanh(x / (2 - x)) / ln 2, after 1 - x is brought to [3/4, 3/2) by its exponent; x
/// itself where that is 0, so that small x keep their digits. Relative error 3e-7.
template <class D, class V>
HWY_INLINE V log2_one_minus(D d, V x) {
  const hn::RebindToSigned<D> di;
  const V one = hn::Set(d, 1);
  const auto bits = hn::BitCast(di, hn::Max(hn::Sub(one, x), hn::Set(d, 1e-30F)));
  const auto exponent = hn::ShiftRight<23>(hn::Sub(bits, hn::Set(di, 0x3f400000)));
  const V rest = hn::Sub(one, hn::BitCast(d, hn::Sub(bits, hn::ShiftLeft<23>(exponent))));
  const V z = hn::IfThenElse(hn::RebindMask(d, hn::Eq(exponent, hn::Zero(di))), x, rest);
  const V t = hn::Div(z, hn::Sub(hn::Set(d, 2), z)), tt = hn::Mul(t, t);
  const V sum = series(d, tt, -2.885390082F, -0.9617966939F, -0.5770780164F, -0.4121985831F, -0.3205988980F);
  return hn::Add(hn::ConvertTo(d, exponent), hn::Mul(t, sum));
}

/// 2^y; from 2^-100 to 2, beyond as those. Relative error 2e-7.
template <class D, class V>
HWY_INLINE V exp2_small(D d, V y) {
  const hn::RebindToSigned<D> di;
  y = hn::Min(hn::Max(y, hn::Set(d, -100)), hn::Set(d, 1));
  const V shift = hn::Set(d, 0x1.8p23F), shifted = hn::Add(y, shift), f = hn::Sub(y, hn::Sub(shifted, shift));
  const V power = series(d, f, 1, 0.6931471806F, 0.2402265070F, 0.05550410866F, 0.009618129108F, 0.001333355815F,
                         0.0001540353039F, 0.00001525273380F);
  return hn::BitCast(d, hn::Add(hn::BitCast(di, power), hn::ShiftLeft<23>(hn::BitCast(di, shifted))));
}

/// Values may be asked for a little below x = 0, where the series of a light goes on; no farther than lets them double or so.
/// second() and third(): the sizes of those derivatives by x, of x and the value there. bend(): how much of what the lobe
/// is two lights may miss where the horizon crosses them: more where it breaks off than where it bends.
struct CosineLanes {
  [[nodiscard]] float bend() const { return 0.12F; }
  template <class D, class V>
  HWY_INLINE V value(D d, V x) const {
    return hn::Mul(hn::Set(d, static_cast<float>(1 / pi)), hn::Max(hn::Zero(d), hn::Sub(hn::Set(d, 1), x)));
  }
  template <class D, class V>
  HWY_INLINE V second(D d, V /*x*/, V /*value*/) const {
    return hn::Zero(d);
  }
  template <class D, class V>
  HWY_INLINE V third(D d, V /*x*/, V /*value*/) const {
    return hn::Zero(d);
  }
};

struct PhongLanes {
  float exponent, scale;
  [[nodiscard]] float bend() const { return 0.25F - 0.13F * std::min(exponent, 1.0F); }
  template <class D, class V>
  HWY_INLINE V value(D d, V x) const {
    const V power = exp2_small(d, hn::Mul(hn::Set(d, exponent), log2_one_minus(d, x)));
    return hn::IfThenElseZero(hn::Lt(x, hn::Set(d, 1)), hn::Mul(hn::Set(d, scale), power));
  }
  template <class D, class V>
  HWY_INLINE V second(D d, V x, V value) const {
    const V c = cosine(d, x);
    return hn::Div(hn::Mul(value, hn::Set(d, exponent * std::abs(exponent - 1))), hn::Mul(c, c));
  }
  template <class D, class V>
  HWY_INLINE V third(D d, V x, V value) const {
    return hn::Div(hn::Mul(second(d, x, value), hn::Set(d, std::abs(exponent - 2))), cosine(d, x));
  }

 private:
  template <class D, class V>
  HWY_INLINE V cosine(D d, V x) const {
    return hn::Max(hn::Sub(hn::Set(d, 1), x), hn::Set(d, 1e-6F));
  }
};

struct GgxLanes {
  float a, b, scale;
  [[nodiscard]] float bend() const { return 0.12F; }
  template <class D, class V>
  HWY_INLINE V value(D d, V x) const {
    const V q = hn::Max(hn::Set(d, 0.5F * a), hn::Add(hn::Set(d, a), hn::Mul(hn::Set(d, b), x)));
    const V cosine = hn::Max(hn::Zero(d), hn::Sub(hn::Set(d, 1), x));
    return hn::Div(hn::Mul(hn::Set(d, scale), cosine), hn::Mul(q, q));
  }
  template <class D, class V>
  HWY_INLINE V second(D d, V x, V /*value*/) const {
    const V q = hn::Add(hn::Set(d, a), hn::Mul(hn::Set(d, b), x)), s = hn::Div(hn::Set(d, b), q);
    const V bend = hn::Add(hn::Set(d, 4), hn::Mul(hn::Set(d, 6), hn::Mul(s, hn::Sub(hn::Set(d, 1), x))));
    return hn::Mul(hn::Div(hn::Set(d, scale), hn::Mul(q, q)), hn::Mul(s, bend));
  }
  template <class D, class V>
  HWY_INLINE V third(D d, V x, V /*value*/) const {
    const V q = hn::Add(hn::Set(d, a), hn::Mul(hn::Set(d, b), x)), s = hn::Div(hn::Set(d, b), q);
    const V bend = hn::Add(hn::Set(d, 18), hn::Mul(hn::Set(d, 24), hn::Mul(s, hn::Sub(hn::Set(d, 1), x))));
    return hn::Mul(hn::Mul(hn::Div(hn::Set(d, scale), hn::Mul(q, q)), hn::Mul(s, s)), bend);
  }
};

inline CosineLanes lanes_of(const Cosine&) { return {}; }
inline PhongLanes lanes_of(const Phong& l) { return {static_cast<float>(l.exponent), static_cast<float>(l.scale())}; }
inline GgxLanes lanes_of(const Ggx& l) {
  return {static_cast<float>(l.a), static_cast<float>(l.b), static_cast<float>(l.scale)};
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap
HWY_AFTER_NAMESPACE();

#endif  // ENVMAP_PREFILTER_LANES_INL_H_

/// @file
/// Polynomials, logarithms and powers of vectors of float or double, for any Highway target. Included once a target, by
/// files that foreach_target.h compiles.
///
/// Only operations that IEEE 754 rounds in one way are used, and no fused multiply-add: every target gives the same
/// bits. The coefficients are those of Taylor series of atanh and 2^x on ranges of half an octave.
#if defined(ENVMAP_PREFILTER_FAST_MATH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ENVMAP_PREFILTER_FAST_MATH_INL_H_
#undef ENVMAP_PREFILTER_FAST_MATH_INL_H_
#else
#define ENVMAP_PREFILTER_FAST_MATH_INL_H_
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// A number in every lane.
template <class D, class T>
HWY_INLINE hn::Vec<D> broadcast(D d, T c) {
  return hn::Set(d, static_cast<hn::TFromD<D>>(c));
}

/// c0 + c1 z + c2 z^2 + ...: even and odd powers are summed apart, so that each step waits for half as many before it
/// (Estrin 1960).
template <class D, class V, class... C>
HWY_INLINE V polynomial(D d, V z, C... all) {
  constexpr std::size_t count = sizeof...(C), last = count - 1;
  static_assert(count >= 2);
  const double c[] = {double(all)...};
  const V zz = z * z;
  V high = broadcast(d, c[last]), next = broadcast(d, c[last - 1]);
  for (std::size_t k = last - 1; k-- > 0;) {
    V& same = (last - k) % 2 == 0 ? high : next;
    same = broadcast(d, c[k]) + zz * same;
  }
  return last % 2 == 0 ? high + z * next : next + z * high;
}

/// The binary format of a lane, and the range of logarithms and powers.
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

/// Returns log2(y) of y below 2, as -2 atanh(x / (2 - x)) / ln 2 with x = 1 - y. First y is brought to [3/4, 3/2) by
/// its exponent. Where the exponent is 0, x itself is used, so that small x keep their digits. Relative error: 3e-7 of
/// floats, 3e-16 of doubles.
/// @param x 1 - y.
template <class D, class V>
HWY_INLINE V log2_of(D d, V y, V x) {
  using T = hn::TFromD<D>;
  using B = Binary<T>;
  const hn::RebindToSigned<D> di;
  const V one = broadcast(d, 1);
  const auto bits = hn::BitCast(di, hn::Max(y, broadcast(d, B::tiny)));
  const auto exponent = hn::ShiftRight<B::mantissa>(bits - hn::Set(di, B::three_quarters));
  const V rest = one - hn::BitCast(d, bits - hn::ShiftLeft<B::mantissa>(exponent));
  const V z = hn::IfThenElse(hn::RebindMask(d, hn::Eq(exponent, hn::Zero(di))), x, rest);
  const V t = z / (broadcast(d, 2) - z), tt = t * t;
  const auto sum = [&]() HWY_ATTR {
    if constexpr (sizeof(T) == 4)
      return polynomial(d, tt, -2.885390082, -0.9617966939, -0.5770780164, -0.4121985831, -0.3205988980);
    else
      return polynomial(d, tt, -2.8853900817779268, -0.96179669392597555, -0.57707801635558531, -0.41219858311113239,
                        -0.32059889797532518, -0.26230818925253879, -0.22195308321368667, -0.1923593387851951,
                        -0.16972872833987804, -0.15186263588304878, -0.13739952770371080, -0.12545174268599681,
                        -0.11541560327111707);
  };
  return hn::ConvertTo(d, exponent) + t * sum();
}
template <class D, class V>
HWY_INLINE V log2_one_minus(D d, V x) {
  return log2_of(d, broadcast(d, 1) - x, x);
}

/// Returns 2^y of y clamped to [-100, 1] (floats) or [-1000, 1] (doubles). Relative error: 2e-7 of floats, 3e-16 of
/// doubles.
template <class D, class V>
HWY_INLINE V exp2_small(D d, V y) {
  using T = hn::TFromD<D>;
  using B = Binary<T>;
  const hn::RebindToSigned<D> di;
  y = hn::Min(hn::Max(y, broadcast(d, B::lowest)), broadcast(d, 1));
  const V shift = broadcast(d, B::shift), shifted = y + shift, f = y - (shifted - shift);
  const auto power = [&]() HWY_ATTR {
    if constexpr (sizeof(T) == 4)
      return polynomial(d, f, 1, 0.6931471806, 0.2402265070, 0.05550410866, 0.009618129108, 0.001333355815,
                        0.0001540353039, 0.00001525273380);
    else
      return polynomial(d, f, 1, 0.69314718055994529, 0.24022650695910072, 0.055504108664821583, 0.0096181291076284769,
                        0.0013333558146428443, 0.00015403530393381609, 1.5252733804059841e-05, 1.3215486790144309e-06,
                        1.0178086009239699e-07, 7.0549116208011234e-09, 4.4455382718708116e-10, 2.5678435993488206e-11,
                        1.3691488853904128e-12, 6.7787263548225457e-14);
  };
  return hn::BitCast(d, hn::BitCast(di, power()) + hn::ShiftLeft<B::mantissa>(hn::BitCast(di, shifted)));
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();

#endif  // ENVMAP_PREFILTER_FAST_MATH_INL_H_

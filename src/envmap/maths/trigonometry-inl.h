/// @file
/// Sine, cosine and arctangent of vectors of doubles, for any Highway target. Included once a target, by files that
/// foreach_target.h compiles.
///
/// Angles are in units of pi (IEEE 754's sinPi, cosPi, atan2Pi): quarters of a turn are exact numbers then, and
/// reducing an argument rounds nothing. Only operations that IEEE 754 rounds in one way are used, and no fused
/// multiply-add: every target gives the same bits. Coefficients: trigonometry.py, which also tells how far each series
/// is from its function.
#if defined(ENVMAP_MATHS_TRIGONOMETRY_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ENVMAP_MATHS_TRIGONOMETRY_INL_H_
#undef ENVMAP_MATHS_TRIGONOMETRY_INL_H_
#else
#define ENVMAP_MATHS_TRIGONOMETRY_INL_H_
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace envmap {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// c0 + c1 z + c2 z^2 + ... by Horner's scheme.
template <class D, class V>
HWY_INLINE V polynomial(D d, V /*z*/, double c) {
  return hn::Set(d, c);
}
template <class D, class V, class... C>
HWY_INLINE V polynomial(D d, V z, double c, C... higher) {
  return hn::Add(hn::Set(d, c), hn::Mul(z, polynomial(d, z, higher...)));
}

/// sin(pi (r + k/2)) and cos(pi (r + k/2)) for |r| <= 1/4 and whole k, |k| < 2^31. Error below 2 units in the last
/// place of the result.
template <class D, class V>
HWY_INLINE void sin_cos_quarters(D d, V k, V r, V& sine, V& cosine) {
  const V z = hn::Mul(r, r);
  // pi in two parts: its rounding alone would cost a third of a unit.
  const V sine_tail = hn::Mul(z, polynomial(d, z, -5.167712780049969, 2.5501640398766154, -0.5992645291845385,
                                            0.08214587730641625, -0.0073701436437935495, 0.00046221110224187623));
  const V s = hn::Add(hn::Mul(r, hn::Set(d, 3.141592653589793)),
                      hn::Mul(r, hn::Add(hn::Set(d, 1.2246467991473532e-16), sine_tail)));
  const V cosine_tail =
      polynomial(d, z, -4.934802200544679, 4.058712126416765, -1.3352627688538095, 0.23533063028399223,
                 -0.025806887964701878, 0.001929493874894941, -0.00010370082971594627);
  const V c = hn::Add(hn::Set(d, 1), hn::Mul(z, cosine_tail));
  // Added to 1.5 x 2^52 a whole number stands in the lowest bits: bit 0 swaps, bit 1 negates.
  const hn::RebindToSigned<D> di;
  const auto bits = hn::BitCast(di, hn::Add(k, hn::Set(d, 0x1.8p52)));
  const auto one = hn::Set(di, 1);
  const auto sign = hn::SignBit(d);
  const auto odd = hn::RebindMask(d, hn::TestBit(bits, one));
  const V flip_sine = hn::And(hn::BitCast(d, hn::ShiftLeft<62>(bits)), sign);
  const V flip_cosine = hn::And(hn::BitCast(d, hn::ShiftLeft<62>(hn::Add(bits, one))), sign);
  sine = hn::Xor(hn::IfThenElse(odd, c, s), flip_sine);
  cosine = hn::Xor(hn::IfThenElse(odd, s, c), flip_cosine);
}

/// The nearest whole number, of |x| < 2^51; halves to even.
template <class D, class V>
HWY_INLINE V nearest_whole(D d, V x) {
  const V shift = hn::Set(d, 0x1.8p52);
  return hn::Sub(hn::Add(x, shift), shift);
}

/// sin(pi x) and cos(pi x), |x| < 2^30.
template <class D, class V>
HWY_INLINE void sin_cos_pi(D d, V x, V& sine, V& cosine) {
  const V k = nearest_whole(d, hn::Add(x, x));
  sin_cos_quarters(d, k, hn::Sub(x, hn::Mul(k, hn::Set(d, 0.5))), sine, cosine);
}

/// sin(pi a / n) and cos(pi a / n). Where a and n are multiples of 1/2 with fewer than 50 bits the quotient is reduced
/// before it is rounded: near every multiple of pi/2 the result keeps its digits. Rounding it adds half a unit to
/// the error. @param inverse 1 / n, roughly.
template <class D, class V>
HWY_INLINE void sin_cos_pi_ratio(D d, V a, V n, V inverse, V& sine, V& cosine) {
  const V k = nearest_whole(d, hn::Mul(hn::Add(a, a), inverse));
  sin_cos_quarters(d, k, hn::Div(hn::Sub(a, hn::Mul(k, hn::Mul(n, hn::Set(d, 0.5)))), n), sine, cosine);
}

/// atan2(y, x) / pi, in [-1,1], with the signs of zero of std::atan2; 0 and 1 for x = y = 0. For |x|, |y| < 2^1020,
/// subnormal numbers among them. Error below 2 units in the last place.
template <class D, class V>
HWY_INLINE V atan2_pi(D d, V y, V x) {
  const V zero = hn::Zero(d), one = hn::Set(d, 1);
  const V ay = hn::Abs(y), ax = hn::Abs(x), low = hn::Min(ay, ax), high = hn::Max(ay, ax);
  // atan(l/h) = pi/4 + atan((l-h)/(l+h)) above 5/12, so that the series runs over [-5/12, 5/12]: near enough to
  // tan(pi/8), which would balance the two, and exact for subnormal numbers.
  const auto wide = hn::Gt(hn::Mul(low, hn::Set(d, 12)), hn::Mul(high, hn::Set(d, 5)));
  const V numerator = hn::IfThenElse(wide, hn::Sub(low, high), low);
  const V denominator = hn::IfThenElse(wide, hn::Add(low, high), high);
  const V q = hn::Div(numerator, hn::IfThenElse(hn::Eq(high, zero), one, denominator));
  const V z = hn::Mul(q, q), zz = hn::Mul(z, z);
  // Even and odd powers apart: two short chains rather than one long one.
  const V even = polynomial(d, zz, -0.10610329539459688, -0.04547284087972353, -0.028937246917597824,
                            -0.021213443734901288, -0.01617153929840856, -0.0060484263546489135);
  const V odd = polynomial(d, zz, 0.06366197723674223, 0.03536776479922883, 0.024484954201581935, 0.01864400098615914,
                           0.01244201852214326);
  const V tail = hn::Mul(z, hn::Add(even, hn::Mul(z, odd)));
  const V angle = hn::Add(hn::Mul(q, hn::Set(d, 0.3183098861837907)),
                          hn::Mul(q, hn::Add(hn::Set(d, -1.9678676675182486e-17), tail)));
  // Back through the octants: base + angle, or base - angle.
  const V sign = hn::SignBit(d);
  const V steep = hn::IfThenElseZero(hn::Gt(ay, ax), sign), left = hn::And(x, sign);
  V base = hn::IfThenElseZero(wide, hn::Set(d, 0.25));
  base = hn::IfThenElse(hn::Gt(ay, ax), hn::Sub(hn::Set(d, 0.5), base), base);
  base = hn::IfThenElse(hn::Lt(hn::Or(left, one), zero), hn::Sub(one, base), base);
  return hn::CopySign(hn::Add(base, hn::Xor(angle, hn::Xor(steep, left))), y);
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap
HWY_AFTER_NAMESPACE();

#endif  // ENVMAP_MATHS_TRIGONOMETRY_INL_H_

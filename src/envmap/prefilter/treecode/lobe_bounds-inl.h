/// @file
/// What a treecode's nodes sum of a lobe (K of lobe_bounds.h), for any Highway target: its Taylor series at a cosine,
/// and the ranges of its derivatives over an interval of cosines. All derivatives are by u, the cosine.
#if defined(ENVMAP_PREFILTER_TREECODE_LOBE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ENVMAP_PREFILTER_TREECODE_LOBE_INL_H_
#undef ENVMAP_PREFILTER_TREECODE_LOBE_INL_H_
#else
#define ENVMAP_PREFILTER_TREECODE_LOBE_INL_H_
#endif

#include "envmap/prefilter/error_floor.h"
#include "envmap/prefilter/lobe_lanes-inl.h"
#include "envmap/prefilter/treecode/lobe_bounds.h"

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {

using LaneTag = hn::CappedTag<float, 16>;
using V = hn::Vec<LaneTag>;

HWY_INLINE V number(double c) { return hn::Set(LaneTag(), float(c)); }

/// K, K' and K''/2.
struct Taylor {
  V value, slope, bend;
};

/// Over an interval [lo, hi] of cosines, 0 <= lo, and over [0, hi] and what is below the horizon where that cuts it.
struct Bounds {
  V least, most;          ///< Of K, plus `line` x u.
  V line;                 ///< What a constant in the place of K does better without: its integral over a node is known.
  V osc2;                 ///< Of K'', its largest less its least value.
  V third, fourth;        ///< max |K'''|, max |K''''|.
  V size0, size1, size2;  ///< Of all terms that taylor() adds up: what rounding is relative to.
};

/// The part of a lobe with its constants; `smooth` as in TreecodeLobe.
template <class L>
struct Rest;

// A number, made larger by what the formulae of bounds may round off.
HWY_INLINE V padded(V x) { return x * number(1 + 1e-5); }
HWY_INLINE V larger(V a, V b) { return hn::Max(hn::Abs(a), hn::Abs(b)); }

/// What the powers of a lobe may be off by, relative: log2_of() by 3e-7 of the logarithm, exp2_small() by 2e-7. Values
/// below the floor of errors count next to nothing, so that logarithms need not be counted beyond there.
template <class L>
double power_rounding(const L& l) {
  if constexpr (std::is_same_v<L, Ggx>) return 0;
  const double most = std::max(1.0, l.value(l.peak()) / floor_density);
  return 1.5 * (2e-7 + 3e-7 * portable::log(most));
}

// ---- Phong: k u^m --------------------------------------------------------------------------------------------------

template <>
struct Rest<Phong> {
  double m, scale;
  explicit Rest(const Phong& l) : m(l.exponent), scale(l.scale()) {}

  static constexpr double least_cosine = 1e-6;
  // k u^(m-1) of x = 1 - u.
  HWY_INLINE V power(V x) const {
    const LaneTag d;
    return number(scale) * exp2_small(d, number(m - 1) * log2_one_minus(d, x));
  }
  HWY_INLINE Taylor taylor(V x) const {
    const LaneTag d;
    const V u = number(1) - x, lit = hn::Max(u, number(least_cosine));
    const V p = hn::IfThenElseZero(hn::Gt(u, hn::Zero(d)), power(x));
    return {p * u, number(m) * p, number(0.5 * m * (m - 1)) * (p / lit)};
  }
  // Every derivative keeps its sign, and rises or falls throughout.
  HWY_INLINE Bounds over(V lo, V hi, hn::Mask<LaneTag> cut) const {
    const LaneTag d;
    const V a = hn::Max(lo, number(least_cosine)), b = hn::Max(hi, number(least_cosine)), zero = hn::Zero(d);
    const V pa = power(number(1) - a), pb = power(number(1) - b);
    const V second_a = number(m * (m - 1)) * (pa / a), second_b = number(m * (m - 1)) * (pb / b);
    const V third_a = number(m - 2) * (second_a / a), third_b = number(m - 2) * (second_b / b);
    const V fourth_a = number(m - 3) * (third_a / a), fourth_b = number(m - 3) * (third_b / b);
    const V highest = hn::Max(second_a, second_b), lowest = hn::IfThenElse(cut, zero, hn::Min(second_a, second_b));
    return {.least = hn::IfThenElse(cut, zero, pa * a),
            .most = pb * b,
            .line = zero,
            .osc2 = hn::Max(zero, highest - lowest) + highest * number(4e-6),
            .third = larger(third_a, third_b),
            .fourth = larger(fourth_a, fourth_b),
            .size0 = pb * b,
            .size1 = number(m) * pb,
            .size2 = number(0.5) * highest};
  }
};

// ---- Trowbridge and Reitz: k u / (a + b x)^2 less three terms of its series in u ----------------------------------
// With z = b u / (a + b): K = k' (z / (1 - z)^2 - z - 2 z^2 - 3 z^3), whose derivatives are all above 0 and rise.

template <>
struct Rest<Ggx> {
  double a, b, whole, ratio, scale;
  explicit Rest(const Ggx& l)
      : a(l.a), b(l.b), whole(l.a + l.b), ratio(l.b / whole), scale(l.scale / (whole * std::max(1e-30, l.b))) {}

  HWY_INLINE V inverse(V x) const { return number(whole) / (number(a) + number(b) * x); }  // 1 / (1 - z)
  HWY_INLINE Taylor taylor(V x) const {
    const LaneTag d;
    const V u = number(1) - x, w = inverse(x), w2 = w * w;
    const V z = number(ratio) * u, zz = z * z;
    const V k = hn::IfThenElseZero(hn::Gt(u, hn::Zero(d)), number(scale) * w2);
    const V value = zz * zz * (number(4) - number(3) * z);
    const V slope = zz * z * (number(16) + z * (number(9) * z - number(23)));
    const V bend = zz * (number(24) + z * (number(-46) + z * (number(34) - number(9) * z)));
    return {k * value, number(ratio) * (k * w) * slope, number(ratio * ratio) * (k * w2) * bend};
  }
  HWY_INLINE Bounds over(V lo, V hi, hn::Mask<LaneTag> /*cut*/) const {
    const LaneTag d;
    const Taylor low = taylor(number(1) - lo), high = taylor(number(1) - hi);
    const V z = number(ratio) * hi, w = inverse(number(1) - hi), w2 = w * w, k = number(scale) * w2;
    const V bend_of_all = number(ratio * ratio) * k * w2 * (number(2) + z);
    return {.least = low.value,
            .most = high.value,
            .line = hn::Zero(d),
            .osc2 = number(2) * (hn::Max(hn::Zero(d), high.bend - low.bend) + number(1e-5) * high.bend),
            .third = number(ratio * ratio * ratio) * k * w2 * w * (number(18) + number(6) * z) -
                     number(18 * scale * ratio * ratio * ratio * (1 - 1e-5)),
            .fourth = number(ratio * ratio * ratio * ratio) * k * w2 * w2 * (number(96) + number(24) * z),
            .size0 = k * z,
            .size1 = number(ratio) * k * w * (number(1) + z),
            .size2 = bend_of_all};
  }
};

// ---- Blinn: k u q^p, q = (1 + u) / 2, less the first terms of its series ------------------------------------------

template <>
struct Rest<BlinnPhong> {
  BlinnPhong lobe;
  double p;
  std::array<double, 3> hinges;  ///< Factors of u, u^2 and u^3.
  explicit Rest(const BlinnPhong& l) : lobe(l), p(l.power), hinges(blinn_hinges(l).factors) {}

  HWY_INLINE Taylor taylor(V x) const {
    const LaneTag d;
    const V u = number(1) - x, q = number(1) - number(0.5) * x, power = blinn_power(lobe, d, hn::Min(x, number(1)));
    const V part = power / q;
    const V value = u * (power - (number(hinges[0]) + u * (number(hinges[1]) + u * number(hinges[2]))));
    const V slope = power + number(0.5 * p) * u * part -
                    (number(hinges[0]) + u * (number(2 * hinges[1]) + u * number(3 * hinges[2])));
    const V bend = number(0.5 * p) * part + number(0.125 * p * (p - 1)) * u * (part / q) -
                   (number(hinges[1]) + u * number(3 * hinges[2]));
    const auto lit = hn::Gt(u, hn::Zero(d));
    return {hn::IfThenElseZero(lit, value), hn::IfThenElseZero(lit, slope), hn::IfThenElseZero(lit, bend)};
  }
  // The n-th derivative of q^p, one sign throughout, and rising or falling.
  HWY_INLINE V of_power(V power, V q, int n) const {
    double factor = 1;
    for (int k = 0; k < n; ++k) factor *= 0.5 * (p - k), power = power / q;
    return number(factor) * power;
  }
  // K and two derivatives are 0 at the horizon, so that nothing changes where it cuts.
  HWY_INLINE Bounds over(V lo, V hi, hn::Mask<LaneTag> /*cut*/) const {
    const LaneTag d;
    const V one = number(1), qa = number(0.5) * (one + lo), qb = number(0.5) * (one + hi);
    const V pa = blinn_power(lobe, d, one - lo), pb = blinn_power(lobe, d, one - hi), wide = hi - lo;
    const V fourth = padded(hi * larger(of_power(pa, qa, 4), of_power(pb, qb, 4)) +
                            number(4) * larger(of_power(pa, qa, 3), of_power(pb, qb, 3)));
    const auto third_at = [&](V u, V q, V power) HWY_ATTR {
      return u * of_power(power, q, 3) + number(3) * of_power(power, q, 2) - number(6 * hinges[2]);
    };
    const V size = number(3) * larger(of_power(pa, qa, 2), of_power(pb, qb, 2)) + number(6 * hinges[2]);
    const V third =
        larger(third_at(lo, qa, pa), third_at(hi, qb, pb)) + number(0.5) * wide * fourth + number(1e-5) * size;
    const Taylor low = taylor(one - lo), high = taylor(one - hi);
    const V half = number(0.5) * wide, bend = number(2) * larger(low.bend, high.bend) + half * third;
    const V slope = larger(low.slope, high.slope) + half * bend;
    const V middle = number(0.5) * (low.value + high.value), spread = number(0.5) * hn::Abs(high.value - low.value);
    return {.least = middle - spread - half * slope,
            .most = middle + spread + half * slope,
            .line = hn::Zero(d),
            .osc2 = wide * third,
            .third = third,
            .fourth = fourth,
            .size0 = number(2) * hi * pb,
            .size1 = number(2) * (pb + number(p) * hi * pb),
            .size2 = number(2 * p * (1 + std::abs(p - 1))) * pb};
  }
};

// ---- Estevez and Kulla: k u x^p less k u --------------------------------------------------------------------------

template <>
struct Rest<Charlie> {
  Charlie lobe;
  double p, scale;
  explicit Rest(const Charlie& l) : lobe(l), p(l.power), scale(l.scale()) {}

  static constexpr double tip = 1e-5;  // x below which derivatives are not to be had.
  HWY_INLINE Taylor taylor(V x) const {
    const LaneTag d;
    const V u = number(1) - x, y = hn::Max(x, number(0.1 * tip)), power = charlie_power(lobe, d, hn::Min(y, number(1)));
    const V part = power / y;
    const auto lit = hn::Gt(u, hn::Zero(d));
    return {hn::IfThenElseZero(lit, u * (power - number(scale))),
            hn::IfThenElseZero(lit, power - number(p) * u * part - number(scale)),
            hn::IfThenElseZero(lit, number(p) * part * (number(0.5 * (p - 1)) * (u / y) - number(1)))};
  }
  HWY_INLINE Bounds over(V lo, V hi, hn::Mask<LaneTag> cut) const {
    const LaneTag d;
    const V one = number(1), zero = hn::Zero(d), xa = one - lo, xb = hn::Max(one - hi, number(tip)), wide = hi - lo;
    const V pa = charlie_power(lobe, d, xa), pb = charlie_power(lobe, d, xb);
    // Every power of x is largest at an end.
    const auto most = [&](int n) HWY_ATTR {
      V a = pa, b = pb;
      for (int k = 0; k < n; ++k) a = a / xa, b = b / xb;
      return hn::Max(a, b);
    };
    const double q = p * (p - 1), r = q * (p - 2), s = r * (p - 3);
    const V fourth = padded(number(4 * std::abs(r)) * most(3) + number(std::abs(s)) * hi * most(4));
    const V third = padded(number(3 * std::abs(q)) * most(2) + number(std::abs(r)) * hi * most(3));
    const auto second_at = [&](V u, V x, V power)
                               HWY_ATTR { return number(p) * (power / x) * (number(p - 1) * (u / x) - number(2)); };
    const V second_a = second_at(lo, xa, pa), second_b = second_at(hi, xb, pb), half = number(0.5) * wide * third;
    const V highest = hn::Max(second_a, second_b) + half, lowest = hn::Min(second_a, second_b) - half;
    const V with_horizon = hn::Max(highest, zero) - hn::Min(lowest, zero);
    const V size2 = number(p) * most(1) * number(2) + number(std::abs(q)) * most(2);
    // At the tip only the range of the lobe itself is known.
    const auto at_tip = hn::Lt(one - hi, number(2 * tip));
    const V none = number(1e30);
    const V peak = hn::Min(hn::Max(number(lobe.peak()), one - hi), xa);
    const V ends = hn::IfThenElse(cut, zero, hn::Min(value(lobe, d, one - hi), value(lobe, d, xa)));
    const V bend = hn::IfThenElseZero(cut, number(scale) * hi);
    return {.least = ends - bend,
            .most = value(lobe, d, peak),
            .line = hn::IfThenElse(cut, zero, number(scale)),
            .osc2 =
                hn::IfThenElse(at_tip, none, hn::IfThenElse(cut, with_horizon, wide * third) + number(1e-5) * size2),
            .third = hn::IfThenElse(at_tip, none, third),
            .fourth = hn::IfThenElse(at_tip, none, fourth),
            .size0 = number(2 * scale),
            .size1 = hn::Min(none, number(2) * (number(scale) + pb + number(p) * hi * most(1))),
            .size2 = hn::Min(none, size2)};
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();

#endif  // ENVMAP_PREFILTER_TREECODE_LOBE_INL_H_

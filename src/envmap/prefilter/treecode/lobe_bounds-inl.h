/// @file
/// The part K of a lobe that the treecode's nodes sum (lobe_bounds.h), for any Highway target: its Taylor series at a
/// cosine, and the ranges of its derivatives over an interval of cosines. All derivatives are by the cosine u.
#if defined(ENVMAP_PREFILTER_LOBE_BOUNDS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ENVMAP_PREFILTER_LOBE_BOUNDS_INL_H_
#undef ENVMAP_PREFILTER_LOBE_BOUNDS_INL_H_
#else
#define ENVMAP_PREFILTER_LOBE_BOUNDS_INL_H_
#endif

#include "envmap/prefilter/error_floor.h"
#include "envmap/prefilter/lobe_lanes-inl.h"
#include "envmap/prefilter/treecode/lobe_bounds.h"

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {

using LaneTag = hn::CappedTag<float, 16>;
using V = hn::Vec<LaneTag>;

template <class T>
HWY_INLINE V broadcast(T c) {
  return broadcast(LaneTag(), c);
}

/// K, K' and K''/2.
struct Taylor {
  V value, slope, bend;
};

/// Ranges over an interval [lo, hi] of cosines, 0 <= lo. Where the horizon cuts the interval, it is [0, hi] and all
/// below.
struct Bounds {
  V least, most;          ///< Extremes of K + line x u.
  V line;                 ///< Slope of a line whose integral over a node is known: K + line x u varies less than K.
  V osc2;                 ///< max K'' - min K''.
  V third, fourth;        ///< max |K'''|, max |K''''|.
  V size0, size1, size2;  ///< Sums of the absolute terms of taylor(): rounding is relative to them.
};

/// K of one kind of lobe: taylor() and over(), the ranges over an interval.
template <class L>
struct Rest;

// A bound, enlarged by the rounding of its own formula.
HWY_INLINE V padded(V x) { return x * broadcast(1 + 1e-5); }
HWY_INLINE V larger(V a, V b) { return hn::Max(hn::Abs(a), hn::Abs(b)); }

/// Relative error of the powers of a lobe: log2_of() has 3e-7 of the logarithm, exp2_small() has 2e-7. Values below the
/// floor of errors count next to nothing, so the logarithm is that of the peak over the floor.
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
    return broadcast(scale) * exp2_small(d, broadcast(m - 1) * log2_one_minus(d, x));
  }
  HWY_INLINE Taylor taylor(V x) const {
    const LaneTag d;
    const V u = broadcast(1) - x, lit = hn::Max(u, broadcast(least_cosine));
    const V p = hn::IfThenElseZero(hn::Gt(u, hn::Zero(d)), power(x));
    return {p * u, broadcast(m) * p, broadcast(0.5 * m * (m - 1)) * (p / lit)};
  }
  // Every derivative keeps its sign and is monotonic, so that its extremes are at the ends.
  HWY_INLINE Bounds over(V lo, V hi, hn::Mask<LaneTag> cut) const {
    const LaneTag d;
    const V a = hn::Max(lo, broadcast(least_cosine)), b = hn::Max(hi, broadcast(least_cosine)), zero = hn::Zero(d);
    const V pa = power(broadcast(1) - a), pb = power(broadcast(1) - b);
    const V second_a = broadcast(m * (m - 1)) * (pa / a), second_b = broadcast(m * (m - 1)) * (pb / b);
    const V third_a = broadcast(m - 2) * (second_a / a), third_b = broadcast(m - 2) * (second_b / b);
    const V fourth_a = broadcast(m - 3) * (third_a / a), fourth_b = broadcast(m - 3) * (third_b / b);
    const V highest = hn::Max(second_a, second_b), lowest = hn::IfThenElse(cut, zero, hn::Min(second_a, second_b));
    return {.least = hn::IfThenElse(cut, zero, pa * a),
            .most = pb * b,
            .line = zero,
            .osc2 = hn::Max(zero, highest - lowest) + highest * broadcast(4e-6),
            .third = larger(third_a, third_b),
            .fourth = larger(fourth_a, fourth_b),
            .size0 = pb * b,
            .size1 = broadcast(m) * pb,
            .size2 = broadcast(0.5) * highest};
  }
};

// ---- Trowbridge and Reitz: k u / (a + b x)^2 less three terms of its series in u ----------------------------------
// With z = b u / (a + b): K = k' (z / (1 - z)^2 - z - 2 z^2 - 3 z^3), whose derivatives are all above 0 and rise.

template <>
struct Rest<Ggx> {
  double a, b, whole, ratio, scale;
  explicit Rest(const Ggx& l)
      : a(l.a), b(l.b), whole(l.a + l.b), ratio(l.b / whole), scale(l.scale / (whole * std::max(1e-30, l.b))) {}

  HWY_INLINE V inverse(V x) const { return broadcast(whole) / (broadcast(a) + broadcast(b) * x); }  // 1 / (1 - z)
  HWY_INLINE Taylor taylor(V x) const {
    const LaneTag d;
    const V u = broadcast(1) - x, w = inverse(x), w2 = w * w;
    const V z = broadcast(ratio) * u, zz = z * z;
    const V k = hn::IfThenElseZero(hn::Gt(u, hn::Zero(d)), broadcast(scale) * w2);
    const V value = zz * zz * (broadcast(4) - broadcast(3) * z);
    const V slope = zz * z * (broadcast(16) + z * (broadcast(9) * z - broadcast(23)));
    const V bend = zz * (broadcast(24) + z * (broadcast(-46) + z * (broadcast(34) - broadcast(9) * z)));
    return {k * value, broadcast(ratio) * (k * w) * slope, broadcast(ratio * ratio) * (k * w2) * bend};
  }
  HWY_INLINE Bounds over(V lo, V hi, hn::Mask<LaneTag> /*cut*/) const {
    const LaneTag d;
    const Taylor low = taylor(broadcast(1) - lo), high = taylor(broadcast(1) - hi);
    const V z = broadcast(ratio) * hi, w = inverse(broadcast(1) - hi), w2 = w * w, k = broadcast(scale) * w2;
    const V bend_of_all = broadcast(ratio * ratio) * k * w2 * (broadcast(2) + z);
    return {.least = low.value,
            .most = high.value,
            .line = hn::Zero(d),
            .osc2 = broadcast(2) * (hn::Max(hn::Zero(d), high.bend - low.bend) + broadcast(1e-5) * high.bend),
            .third = broadcast(ratio * ratio * ratio) * k * w2 * w * (broadcast(18) + broadcast(6) * z) -
                     broadcast(18 * scale * ratio * ratio * ratio * (1 - 1e-5)),
            .fourth = broadcast(ratio * ratio * ratio * ratio) * k * w2 * w2 * (broadcast(96) + broadcast(24) * z),
            .size0 = k * z,
            .size1 = broadcast(ratio) * k * w * (broadcast(1) + z),
            .size2 = bend_of_all};
  }
};

// ---- Blinn: k u q^p, q = (1 + u) / 2, less the first terms of its series ------------------------------------------

template <>
struct Rest<BlinnPhong> {
  BlinnPhong lobe;
  double p;
  std::array<double, 3> horizon_terms;  ///< Factors of u, u^2 and u^3.
  explicit Rest(const BlinnPhong& l) : lobe(l), p(l.power), horizon_terms(blinn_horizon_terms(l).factors) {}

  HWY_INLINE Taylor taylor(V x) const {
    const LaneTag d;
    const V u = broadcast(1) - x, q = broadcast(1) - broadcast(0.5) * x,
            power = blinn_power(lobe, d, hn::Min(x, broadcast(1)));
    const V part = power / q;
    const V value =
        u *
        (power - (broadcast(horizon_terms[0]) + u * (broadcast(horizon_terms[1]) + u * broadcast(horizon_terms[2]))));
    const V slope =
        power + broadcast(0.5 * p) * u * part -
        (broadcast(horizon_terms[0]) + u * (broadcast(2 * horizon_terms[1]) + u * broadcast(3 * horizon_terms[2])));
    const V bend = broadcast(0.5 * p) * part + broadcast(0.125 * p * (p - 1)) * u * (part / q) -
                   (broadcast(horizon_terms[1]) + u * broadcast(3 * horizon_terms[2]));
    const auto lit = hn::Gt(u, hn::Zero(d));
    return {hn::IfThenElseZero(lit, value), hn::IfThenElseZero(lit, slope), hn::IfThenElseZero(lit, bend)};
  }
  // The n-th derivative of q^p, which keeps its sign and is monotonic.
  HWY_INLINE V of_power(V power, V q, int n) const {
    double factor = 1;
    for (int k = 0; k < n; ++k) factor *= 0.5 * (p - k), power = power / q;
    return broadcast(factor) * power;
  }
  // K and its first two derivatives are 0 at the horizon: a cut interval needs no case of its own.
  HWY_INLINE Bounds over(V lo, V hi, hn::Mask<LaneTag> /*cut*/) const {
    const LaneTag d;
    const V one = broadcast(1), qa = broadcast(0.5) * (one + lo), qb = broadcast(0.5) * (one + hi);
    const V pa = blinn_power(lobe, d, one - lo), pb = blinn_power(lobe, d, one - hi), wide = hi - lo;
    const V fourth = padded(hi * larger(of_power(pa, qa, 4), of_power(pb, qb, 4)) +
                            broadcast(4) * larger(of_power(pa, qa, 3), of_power(pb, qb, 3)));
    const auto third_at = [&](V u, V q, V power) HWY_ATTR {
      return u * of_power(power, q, 3) + broadcast(3) * of_power(power, q, 2) - broadcast(6 * horizon_terms[2]);
    };
    const V size = broadcast(3) * larger(of_power(pa, qa, 2), of_power(pb, qb, 2)) + broadcast(6 * horizon_terms[2]);
    const V third =
        larger(third_at(lo, qa, pa), third_at(hi, qb, pb)) + broadcast(0.5) * wide * fourth + broadcast(1e-5) * size;
    const Taylor low = taylor(one - lo), high = taylor(one - hi);
    const V half = broadcast(0.5) * wide, bend = broadcast(2) * larger(low.bend, high.bend) + half * third;
    const V slope = larger(low.slope, high.slope) + half * bend;
    const V middle = broadcast(0.5) * (low.value + high.value),
            spread = broadcast(0.5) * hn::Abs(high.value - low.value);
    return {.least = middle - spread - half * slope,
            .most = middle + spread + half * slope,
            .line = hn::Zero(d),
            .osc2 = wide * third,
            .third = third,
            .fourth = fourth,
            .size0 = broadcast(2) * hi * pb,
            .size1 = broadcast(2) * (pb + broadcast(p) * hi * pb),
            .size2 = broadcast(2 * p * (1 + std::abs(p - 1))) * pb};
  }
};

// ---- Estevez and Kulla: k u x^p less k u --------------------------------------------------------------------------

template <>
struct Rest<Charlie> {
  Charlie lobe;
  double p, scale;
  explicit Rest(const Charlie& l) : lobe(l), p(l.power), scale(l.scale()) {}

  static constexpr double tip = 1e-5;  // x below which derivatives are unbounded or lose their digits.
  HWY_INLINE Taylor taylor(V x) const {
    const LaneTag d;
    const V u = broadcast(1) - x, y = hn::Max(x, broadcast(0.1 * tip)),
            power = charlie_power(lobe, d, hn::Min(y, broadcast(1)));
    const V part = power / y;
    const auto lit = hn::Gt(u, hn::Zero(d));
    return {hn::IfThenElseZero(lit, u * (power - broadcast(scale))),
            hn::IfThenElseZero(lit, power - broadcast(p) * u * part - broadcast(scale)),
            hn::IfThenElseZero(lit, broadcast(p) * part * (broadcast(0.5 * (p - 1)) * (u / y) - broadcast(1)))};
  }
  HWY_INLINE Bounds over(V lo, V hi, hn::Mask<LaneTag> cut) const {
    const LaneTag d;
    const V one = broadcast(1), zero = hn::Zero(d), xa = one - lo, xb = hn::Max(one - hi, broadcast(tip)),
            wide = hi - lo;
    const V pa = charlie_power(lobe, d, xa), pb = charlie_power(lobe, d, xb);
    // Every power of x is monotonic, so that it is largest at an end.
    const auto most = [&](int n) HWY_ATTR {
      V a = pa, b = pb;
      for (int k = 0; k < n; ++k) a = a / xa, b = b / xb;
      return hn::Max(a, b);
    };
    const double q = p * (p - 1), r = q * (p - 2), s = r * (p - 3);
    const V fourth = padded(broadcast(4 * std::abs(r)) * most(3) + broadcast(std::abs(s)) * hi * most(4));
    const V third = padded(broadcast(3 * std::abs(q)) * most(2) + broadcast(std::abs(r)) * hi * most(3));
    const auto second_at = [&](V u, V x, V power) HWY_ATTR {
      return broadcast(p) * (power / x) * (broadcast(p - 1) * (u / x) - broadcast(2));
    };
    const V second_a = second_at(lo, xa, pa), second_b = second_at(hi, xb, pb), half = broadcast(0.5) * wide * third;
    const V highest = hn::Max(second_a, second_b) + half, lowest = hn::Min(second_a, second_b) - half;
    const V with_horizon = hn::Max(highest, zero) - hn::Min(lowest, zero);
    const V size2 = broadcast(p) * most(1) * broadcast(2) + broadcast(std::abs(q)) * most(2);
    // At the tip only the range of the lobe itself is bounded.
    const auto at_tip = hn::Lt(one - hi, broadcast(2 * tip));
    const V none = broadcast(1e30);
    const V peak = hn::Min(hn::Max(broadcast(lobe.peak()), one - hi), xa);
    const V ends = hn::IfThenElse(cut, zero, hn::Min(value(lobe, d, one - hi), value(lobe, d, xa)));
    const V bend = hn::IfThenElseZero(cut, broadcast(scale) * hi);
    return {.least = ends - bend,
            .most = value(lobe, d, peak),
            .line = hn::IfThenElse(cut, zero, broadcast(scale)),
            .osc2 =
                hn::IfThenElse(at_tip, none, hn::IfThenElse(cut, with_horizon, wide * third) + broadcast(1e-5) * size2),
            .third = hn::IfThenElse(at_tip, none, third),
            .fourth = hn::IfThenElse(at_tip, none, fourth),
            .size0 = broadcast(2 * scale),
            .size1 = hn::Min(none, broadcast(2) * (broadcast(scale) + pb + broadcast(p) * hi * most(1))),
            .size2 = hn::Min(none, size2)};
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();

#endif  // ENVMAP_PREFILTER_LOBE_BOUNDS_INL_H_

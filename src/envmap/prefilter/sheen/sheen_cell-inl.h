// The mean of sheen over a cell of a texel, for lanes of float or double. Included once a target.
#include "envmap/prefilter/lobe_lanes-inl.h"

#if defined(ENVMAP_PREFILTER_SHEEN_CELL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ENVMAP_PREFILTER_SHEEN_CELL_INL_H_
#undef ENVMAP_PREFILTER_SHEEN_CELL_INL_H_
#else
#define ENVMAP_PREFILTER_SHEEN_CELL_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {

// t over a cell: centre + across x + down y, x and y in [-1, 1], in a density of 1 + uneven_x x + uneven_y y.
template <class V>
struct Cell {
  V centre, across, down, uneven_x, uneven_y, area;
};

// (1 - t)^power.
template <class D, class V>
HWY_INLINE V sheen_power(D d, double power, V t) {
  return exp2_small(d, hn::Mul(set(d, power), log2_one_minus(d, t)));
}

// Of a cell above the horizon: the Taylor series about the mean, to the second order.
template <class D, class V>
HWY_INLINE V mean_above(D d, double power, const Cell<V>& c) {
  const V third = set(d, 1.0 / 3);
  const V t = hn::Add(c.centre, hn::Mul(third, hn::Add(hn::Mul(c.uneven_x, c.across), hn::Mul(c.uneven_y, c.down))));
  const V half = hn::Mul(set(d, 1.0 / 6), hn::Add(hn::Mul(c.across, c.across), hn::Mul(c.down, c.down)));
  const V steep = hn::Div(set(d, power), hn::Max(hn::Sub(set(d, 1), t), set(d, 0.02)));
  const V bend = hn::Mul(steep, hn::Sub(hn::Mul(hn::Mul(steep, set(d, (power - 1) / power)), t), set(d, 2)));
  return hn::Mul(sheen_power(d, power, t), hn::Max(hn::Zero(d), hn::Add(t, hn::Mul(half, bend))));
}

// Of a cell that the horizon cuts. With M_k the means of t+^k, differences over its corners: M_1 x the power at t of
// the mean weighted by t, M_2 / M_1, and its second and third order about it. All is counted in `unit`, so that no cell
// is too small for floats.
template <class D, class V>
HWY_INLINE V mean_cut(D d, double power, const Cell<V>& c) {
  const V zero = hn::Zero(d), tiny = set(d, 1e-30), one = set(d, 1);
  const V unit = hn::Add(hn::Max(hn::Abs(c.centre), hn::Max(hn::Abs(c.across), hn::Abs(c.down))), tiny);
  const V inverse_unit = hn::Div(one, unit), centre = hn::Mul(c.centre, inverse_unit);
  const V thinnest = set(d, sizeof(hn::TFromD<D>) == 4 ? 0.01 : 1e-4);
  const V a = hn::Max(hn::Mul(hn::Abs(c.across), inverse_unit), thinnest),
          b = hn::Max(hn::Mul(hn::Abs(c.down), inverse_unit), thinnest);
  V third[4], fourth[4], fifths = zero, sixths = zero;
  for (int k = 0; k < 4; ++k) {  // The corners ++, +-, -+, --.
    const V q = hn::Max(zero, hn::Add(hn::Add(centre, k < 2 ? a : hn::Neg(a)), k % 2 == 0 ? b : hn::Neg(b)));
    third[k] = hn::Mul(hn::Mul(q, q), q), fourth[k] = hn::Mul(third[k], q);
    const V fifth = hn::Mul(fourth[k], q);
    fifths = k == 0 || k == 3 ? hn::Add(fifths, fifth) : hn::Sub(fifths, fifth);
    sixths = k == 0 || k == 3 ? hn::Add(sixths, hn::Mul(fifth, q)) : hn::Sub(sixths, hn::Mul(fifth, q));
  }
  const V ia = hn::Div(one, a), ib = hn::Div(one, b);
  const V fourths = hn::Sub(hn::Sub(fourth[0], fourth[1]), hn::Sub(fourth[2], fourth[3]));
  const V along_x = hn::Sub(hn::Add(third[0], third[2]), hn::Add(third[1], third[3]));
  const V along_y = hn::Sub(hn::Add(third[0], third[1]), hn::Add(third[2], third[3]));
  const V cubes = hn::Sub(hn::Sub(third[0], third[1]), hn::Sub(third[2], third[3]));
  const V plain = hn::Mul(set(d, 1.0 / 24), hn::Mul(cubes, hn::Mul(ia, ib)));
  // Means of t+ x and t+ y, by parts.
  const auto tilt = [&](V cube_sum, V other, V own) HWY_ATTR {
    const V inner = hn::Sub(hn::Mul(set(d, 1.0 / 24), cube_sum), hn::Mul(set(d, 1.0 / 96), hn::Mul(fourths, own)));
    return hn::Mul(inner, hn::Mul(other, own));
  };
  const V x = hn::CopySign(tilt(along_x, ib, ia), c.across), y = hn::CopySign(tilt(along_y, ia, ib), c.down);
  const V top = hn::Max(zero, hn::Add(centre, hn::Add(a, b)));
  const V first = hn::Max(zero, hn::Add(plain, hn::Add(hn::Mul(c.uneven_x, x), hn::Mul(c.uneven_y, y))));
  const V inverse = hn::Div(one, hn::Max(cubes, tiny));
  const V mean = hn::Min(top, hn::Mul(set(d, 0.5), hn::Mul(hn::Max(zero, fourths), inverse)));
  const V square = hn::Mul(set(d, 0.3), hn::Mul(fifths, inverse)), mean_square = hn::Mul(mean, mean);
  const V cube = hn::Mul(set(d, 0.2), hn::Mul(sixths, inverse));
  const V most = hn::Mul(set(d, 0.1), hn::Mul(top, top));
  const V variance = hn::Min(most, hn::Max(zero, hn::Sub(square, mean_square)));
  const V skew =
      hn::Add(hn::Sub(cube, hn::Mul(set(d, 3), hn::Mul(mean, square))), hn::Mul(set(d, 2), hn::Mul(mean_square, mean)));
  const V limit = hn::Mul(set(d, 0.1), hn::Mul(most, top));
  const V t = hn::Mul(unit, mean);
  const V steep = hn::Div(unit, hn::Max(hn::Sub(one, t), set(d, 0.02)));
  const double half = 0.5 * power * (power - 1), sixth = half * (power - 2) / 3;
  const V second = hn::Mul(set(d, half), variance);
  const V last = hn::Mul(hn::Mul(set(d, sixth), steep), hn::Max(hn::Neg(limit), hn::Min(limit, skew)));
  const V bent = hn::Mul(hn::Mul(steep, steep), hn::Sub(second, last));
  return hn::Mul(hn::Mul(sheen_power(d, power, t), unit), hn::Mul(first, hn::Add(one, bent)));
}

// How far half a cell reaches in t.
template <class V>
HWY_INLINE V extent(const Cell<V>& c) {
  return hn::Add(hn::Abs(c.across), hn::Abs(c.down));
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();
#endif

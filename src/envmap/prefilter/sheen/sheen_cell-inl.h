// The mean of sheen, t+ (1 - t)^power, over a cell of a texel, for lanes of float or double. Included once a target.
//
// t is a plane over the cell. Above the horizon the mean is a Taylor series to the second order. Where the horizon cuts
// the cell, t+ itself is integrated in closed form, by differences over the corners, and the power is a Taylor series
// about the mean of t that t+ weights.
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

// t over a cell: centre + across x + down y, x and y in [-1, 1], in a density of 1 + density_x x + density_y y.
template <class V>
struct Cell {
  V centre, across, down, density_x, density_y, area;
};

// (1 - t)^power.
template <class D, class V>
HWY_INLINE V sheen_power(D d, double power, V t) {
  return exp2_small(d, broadcast(d, power) * log2_one_minus(d, t));
}

// The mean over a cell above the horizon: the Taylor series about the mean of t, to the second order.
template <class D, class V>
HWY_INLINE V mean_above(D d, double power, const Cell<V>& c) {
  const V third = broadcast(d, 1.0 / 3);
  const V t = c.centre + third * (c.density_x * c.across + c.density_y * c.down);
  const V half = broadcast(d, 1.0 / 6) * (c.across * c.across + c.down * c.down);
  const V steep = broadcast(d, power) / hn::Max(broadcast(d, 1) - t, broadcast(d, 0.02));
  const V bend = steep * (steep * broadcast(d, (power - 1) / power) * t - broadcast(d, 2));
  return sheen_power(d, power, t) * hn::Max(hn::Zero(d), t + half * bend);
}

// The mean over a cell that the horizon cuts. M_k, the mean of t+^k, is a difference over the corners. The result is
// M_1 x the power at t = M_2 / M_1, the mean of t weighted by t+, with the second and third order about it. All of t is
// in units of the largest extent, so that no cell is too small for floats.
template <class D, class V>
HWY_INLINE V mean_cut(D d, double power, const Cell<V>& c) {
  const V zero = hn::Zero(d), tiny = broadcast(d, 1e-30), one = broadcast(d, 1);
  const V unit = hn::Max(hn::Abs(c.centre), hn::Max(hn::Abs(c.across), hn::Abs(c.down))) + tiny;
  const V inverse_unit = one / unit, centre = c.centre * inverse_unit;
  const V thinnest = broadcast(d, sizeof(hn::TFromD<D>) == 4 ? 0.01 : 1e-4);
  const V a = hn::Max(hn::Abs(c.across) * inverse_unit, thinnest),
          b = hn::Max(hn::Abs(c.down) * inverse_unit, thinnest);
  V third[4], fourth[4], fifths = zero, sixths = zero;
  for (int k = 0; k < 4; ++k) {  // The corners ++, +-, -+, --.
    const V q = hn::Max(zero, centre + (k < 2 ? a : hn::Neg(a)) + (k % 2 == 0 ? b : hn::Neg(b)));
    third[k] = q * q * q, fourth[k] = third[k] * q;
    const V fifth = fourth[k] * q;
    fifths = k == 0 || k == 3 ? fifths + fifth : fifths - fifth;
    sixths = k == 0 || k == 3 ? sixths + fifth * q : sixths - fifth * q;
  }
  const V ia = one / a, ib = one / b;
  const V fourths = fourth[0] - fourth[1] - (fourth[2] - fourth[3]);
  const V along_x = third[0] + third[2] - (third[1] + third[3]);
  const V along_y = third[0] + third[1] - (third[2] + third[3]);
  const V cubes = third[0] - third[1] - (third[2] - third[3]);
  const V plain = broadcast(d, 1.0 / 24) * (cubes * (ia * ib));
  // The means of t+ x and t+ y, integrated by parts.
  const auto tilt = [&](V cube_sum, V other, V own) HWY_ATTR {
    const V inner = broadcast(d, 1.0 / 24) * cube_sum - broadcast(d, 1.0 / 96) * (fourths * own);
    return inner * (other * own);
  };
  const V x = hn::CopySign(tilt(along_x, ib, ia), c.across), y = hn::CopySign(tilt(along_y, ia, ib), c.down);
  const V top = hn::Max(zero, centre + (a + b));
  const V first = hn::Max(zero, plain + (c.density_x * x + c.density_y * y));
  const V inverse = one / hn::Max(cubes, tiny);
  const V mean = hn::Min(top, broadcast(d, 0.5) * (hn::Max(zero, fourths) * inverse));
  const V square = broadcast(d, 0.3) * (fifths * inverse), mean_square = mean * mean;
  const V cube = broadcast(d, 0.2) * (sixths * inverse);
  const V most = broadcast(d, 0.1) * (top * top);
  const V variance = hn::Min(most, hn::Max(zero, square - mean_square));
  const V skew = cube - broadcast(d, 3) * (mean * square) + broadcast(d, 2) * (mean_square * mean);
  const V limit = broadcast(d, 0.1) * (most * top);
  const V t = unit * mean;
  const V steep = unit / hn::Max(one - t, broadcast(d, 0.02));
  const double half = 0.5 * power * (power - 1), sixth = half * (power - 2) / 3;
  const V second = broadcast(d, half) * variance;
  const V last = broadcast(d, sixth) * steep * hn::Max(hn::Neg(limit), hn::Min(limit, skew));
  const V bent = steep * steep * (second - last);
  return sheen_power(d, power, t) * unit * (first * (one + bent));
}

// Half the range of t over a cell.
template <class V>
HWY_INLINE V extent(const Cell<V>& c) {
  return hn::Abs(c.across) + hn::Abs(c.down);
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();
#endif

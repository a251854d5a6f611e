// The inner loops of the sums at the horizon, compiled once for every instruction set and chosen at run time.
#include "envmap/prefilter/prefix_sums/prefix_kernels.h"

#include <algorithm>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/prefilter/prefix_sums/prefix_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "envmap/maths/trigonometry-inl.h"
#include "envmap/prefilter/fast_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {

using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;
using F = hn::CappedTag<float, 4>;
using Lanes = hn::Vec<F>;

// acos(x) = atan2(sqrt(1 - x^2), x), 0 and pi beyond 1 and -1.
void BorderAngles(double slope, std::span<const double> y, std::vector<double>& angles) {
  const D d;
  const std::size_t step = hn::Lanes(d);
  angles.resize(y.size() + step);
  const V one = broadcast(d, 1), minus = broadcast(d, -1), s = broadcast(d, -slope);
  for (std::size_t k = 0; k < y.size(); k += step) {
    V x;
    if (k + step <= y.size()) {
      x = hn::LoadU(d, &y[k]);
    } else {
      std::copy(y.begin() + std::ptrdiff_t(k), y.end(), angles.begin() + std::ptrdiff_t(k));
      x = hn::LoadU(d, &angles[k]);
    }
    x = hn::Max(minus, hn::Min(one, s * x));
    const V sine = hn::Sqrt((one + x) * (one - x));
    V w = envmap::HWY_NAMESPACE::atan2_pi(d, sine, x) * broadcast(d, pi);
    w = hn::IfThenElse(hn::Ge(x, one), hn::Zero(d), hn::IfThenElse(hn::Le(x, minus), broadcast(d, pi), w));
    hn::StoreU(w, d, &angles[k]);
  }
}

// Means over a rectangle of |p| and of p+^2, p = middle + x + y a plane, x within `wide` and y within `tall`:
// differences over its corners of |p|^3 / 24 and p+^4 / 48, over wide x tall.
struct PlaneMeans {
  V size, square;

  HWY_INLINE PlaneMeans(V middle, V wide, V tall) {
    const D d;
    V cubes = hn::Zero(d), fourths = cubes;
    for (int corner = 0; corner < 4; ++corner) {
      const V x = middle + (corner % 2 == 0 ? wide : hn::Neg(wide)), q = x + (corner < 2 ? tall : hn::Neg(tall));
      const V p = hn::Max(q, hn::Zero(d)), p2 = p * p, m = hn::Abs(q), cube = m * m * m, fourth = p2 * p2;
      const bool plus = corner == 0 || corner == 3;
      cubes = plus ? cubes + cube : cubes - cube;
      fourths = plus ? fourths + fourth : fourths - fourth;
    }
    const V scale = broadcast(d, 1.0 / 48) / (wide * tall);
    size = cubes * scale * broadcast(d, 2), square = hn::Max(hn::Zero(d), fourths * scale);
  }
};

// Sets the ranges of t of all cells, and the integral of the weight over each: the sum of uniform light of radiance 1.
// The integral of t+ is half of that of t, which is known, and half of that of |t|. L is replaced by a plane and 1 / r
// by its value in the middle: `bend` and the variation of the powers of 1 / r bound the error. The integral of t+^2 is
// that of the plane, and t+^3 lies between 0 and high t+^2.
void CellIntegrals(const ClampedCosinePolynomial& weight, CellBatch& batch) {
  const D d;
  const auto at = [&](CellBatch::Field f, std::size_t k) HWY_ATTR { return hn::LoadU(d, batch.field(f) + k); };
  const hn::Rebind<float, D> floats;
  const auto put = [&](CellBatch::Derived f, std::size_t k, V v)
                       HWY_ATTR { hn::StoreU(hn::DemoteTo(floats, v), floats, batch.derived(f) + k); };
  const V zero = hn::Zero(d), half = broadcast(d, 0.5), one = broadcast(d, 1), two = broadcast(d, 2);
  const V g1 = broadcast(d, weight.factors[0]), g2 = broadcast(d, weight.factors[1]),
          g3 = broadcast(d, weight.factors[2]);
  for (std::size_t k = 0; k < batch.count(); k += hn::Lanes(d)) {
    const V middle = at(CellBatch::middle, k), a = at(CellBatch::across, k), b = at(CellBatch::down, k);
    // Where an extent is below 1e-4 of the other, differences over the corners vanish. It is enlarged, which moves the
    // means by less than 1e-8 of the other.
    const V widest = hn::Max(a, b), least = widest * broadcast(d, 1e-4) + broadcast(d, 1e-30);
    const V bend = at(CellBatch::bend, k) + widest * broadcast(d, 1e-8);
    const V extent = a + b + bend, bottom = middle - extent, top = middle + extent, near = at(CellBatch::near, k);
    const V low = bottom * hn::IfThenElse(hn::Lt(bottom, zero), near, at(CellBatch::far, k)), high = top * near;
    const V omega = at(CellBatch::solid_angle, k), mean = at(CellBatch::mean, k);
    put(CellBatch::low, k, low), put(CellBatch::high, k, high);
    put(CellBatch::slope, k, high / hn::Max(high - low, broadcast(d, 1e-300)));
    put(CellBatch::steep, k, g1 + high * (g2 + high * g3));
    put(CellBatch::omega, k, omega), put(CellBatch::average, k, mean);

    const PlaneMeans plane(middle, hn::Max(a, least), hn::Max(b, least));
    const V w1 = at(CellBatch::weight1, k) * omega, variation1 = at(CellBatch::variation1, k);
    const V first = half * (omega * mean + w1 * plane.size);
    const V error1 = half * w1 * (variation1 * plane.size + (one + variation1) * bend);
    const V w2 = at(CellBatch::weight2, k) * omega, variation2 = at(CellBatch::variation2, k);
    const V second = w2 * plane.square, steepest = two * (hn::Abs(middle) + extent);
    const V error2 = w2 * (variation2 * plane.square + (one + variation2) * (bend * steepest));
    const V third = half * g3 * (hn::Max(zero, high) * (second + error2));
    put(CellBatch::uniform, k, g1 * first + g2 * second + third);
    put(CellBatch::error, k, g1 * error1 + g2 * error2 + third);
  }
}

// Rounding of a term and of its bound, as a part of the cell's flux: up to 16 roundings to float each, of t <= 1.
constexpr float rounding_of_flux = 2e-6F;

// The factors of the weight, and the rounding of a term.
struct Weights {
  Lanes g1, g2, g3, rounding;
  explicit Weights(const ClampedCosinePolynomial& w)
      : g1(broadcast(F(), w.factors[0])),
        g2(broadcast(F(), w.factors[1])),
        g3(broadcast(F(), w.factors[2])),
        rounding(broadcast(F(), rounding_of_flux * float(w.slope(1)))) {}
};

// The term of a cell wholly above the horizon. The weight is convex: its mean is at least the weight of the mean t, by
// Jensen's inequality, and the second derivative at `high` limits how much larger it is.
// @param f flux. @param m first moment. @param c the first channel.
HWY_INLINE void above(float low, float high, const Weights& w, Lanes f, Lanes m, CellTerm& out, std::size_t c) {
  const F d;
  const Lanes mean = m / hn::Max(f, broadcast(d, 1e-37F));
  const Lanes variance = (broadcast(d, high) - mean) * (m - f * broadcast(d, low));
  const Lanes half_bend = broadcast(d, 0.5) * (w.g2 + broadcast(d, 3 * high) * w.g3);
  const Lanes gap = half_bend * hn::Max(hn::Zero(d), variance);
  const Lanes least = m * (w.g1 + mean * (w.g2 + mean * w.g3));
  hn::Store(least + gap, d, &out.middle[c]);
  hn::Store(gap + f * w.rounding, d, &out.error[c]);
}

// The term of a cell that the horizon cuts: uniform light of the least radiance e, and the rest, which is not negative.
// The integral of t+ over the rest lies between max(0, its moment) and the chord from low to high, and the weight
// between g1 t+ and t+ x its slope at high.
HWY_INLINE void cut(const float* derived, std::size_t room, const Weights& w, Lanes f, Lanes m, Lanes e, CellTerm& out,
                    std::size_t c) {
  const F d;
  const auto of = [&](CellBatch::Derived which) HWY_ATTR { return broadcast(d, derived[which * room]); };
  const Lanes zero = hn::Zero(d), half = broadcast(d, 0.5);
  const Lanes light = e * of(CellBatch::omega);
  const Lanes rest = hn::Max(zero, f - light), moment = m - light * of(CellBatch::average);
  const Lanes jensen = hn::Max(zero, moment);
  const Lanes chord = hn::Max(jensen, (moment - rest * of(CellBatch::low)) * of(CellBatch::slope));
  const Lanes least = w.g1 * jensen, most = of(CellBatch::steep) * chord;
  hn::Store(half * (least + most) + e * of(CellBatch::uniform), d, &out.middle[c]);
  hn::Store(half * (most - least) + e * of(CellBatch::error) + f * w.rounding, d, &out.error[c]);
}

void BoundCells(const FaceDirection& n, const ClampedCosinePolynomial& weight, CellBatch& batch,
                std::vector<CellTerm>& out) {
  CellIntegrals(weight, batch);
  const F d;
  const Weights weights(weight);
  const Lanes x = broadcast(d, n.x), y = broadcast(d, n.y), z = broadcast(d, n.z);
  const float* derived = batch.derived(CellBatch::low);
  const std::size_t room = std::size_t(batch.derived(CellBatch::high) - derived);
  std::size_t used = out.size();
  out.resize(used + batch.count());
  for (std::size_t k = 0; k < batch.count(); ++k) {
    const float low = derived[k], high = derived[k + room];
    if (high <= 0) continue;
    const CellBatch::Place& place = batch.place(k);
    const float* p = place.light->m;
    CellTerm& term = out[used++];
    term.face = place.face, term.row = place.row, term.column = place.column;
    for (std::size_t c = 0; c < 4; c += hn::Lanes(d), p += hn::Lanes(d)) {
      const Lanes m = hn::LoadU(d, p) * x + hn::LoadU(d, p + 3) * y + hn::LoadU(d, p + 6) * z;
      if (low >= 0)
        above(low, high, weights, hn::LoadU(d, p + 9), m, term, c);
      else
        cut(derived + k, room, weights, hn::LoadU(d, p + 9), m, hn::LoadU(d, p + 12), term, c);
    }
  }
  out.resize(used);
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace envmap::prefiltering {
HWY_EXPORT(BorderAngles);
HWY_EXPORT(BoundCells);

void CellBatch::grow() {
  constexpr std::size_t least = 256, vector = 24;
  const std::size_t size = std::max(least, 2 * count_), before = std::exchange(room_, size + vector);
  std::vector<double> wider(fields * room_, 0.0);
  for (std::size_t f = 0; f < fields && count_ > 0; ++f) std::copy_n(&fields_[f * before], count_, &wider[f * room_]);
  fields_ = std::move(wider);
  derived_.assign(derived_fields * room_, 0.0F), places_.resize(size);
}

void bound_cells(const FaceDirection& n, const ClampedCosinePolynomial& weight, CellBatch& batch,
                 std::vector<CellTerm>& out) {
  if (batch.count() > 0) HWY_DYNAMIC_DISPATCH(BoundCells)(n, weight, batch, out);
}
void border_angles(double slope, std::span<const double> y, std::vector<double>& angles) {
  HWY_DYNAMIC_DISPATCH(BorderAngles)(slope, y, angles);
}

}  // namespace envmap::prefiltering
#endif  // HWY_ONCE

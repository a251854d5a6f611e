// The inner loops of the sums at the horizon, compiled once for every instruction set and chosen at run time.
#include "envmap/prefilter/prefix_sums/prefix_kernels.h"

#include <algorithm>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/prefilter/prefix_sums/prefix_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "envmap/maths/trigonometry-inl.h"

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;
using F = hn::CappedTag<float, 4>;
using Lanes = hn::Vec<F>;

// acos(x) = atan2(sqrt(1 - x^2), x), 0 and pi beyond 1 and -1.
void BorderAngles(double slope, std::span<const double> y, std::vector<double>& angles) {
  const D d;
  const std::size_t step = hn::Lanes(d);
  angles.resize(y.size() + step);
  const V one = hn::Set(d, 1), minus = hn::Set(d, -1), s = hn::Set(d, -slope);
  for (std::size_t k = 0; k < y.size(); k += step) {
    V x;
    if (k + step <= y.size()) {
      x = hn::LoadU(d, &y[k]);
    } else {
      std::copy(y.begin() + std::ptrdiff_t(k), y.end(), angles.begin() + std::ptrdiff_t(k));
      x = hn::LoadU(d, &angles[k]);
    }
    x = hn::Max(minus, hn::Min(one, hn::Mul(s, x)));
    const V sine = hn::Sqrt(hn::Mul(hn::Add(one, x), hn::Sub(one, x)));
    V w = hn::Mul(envmap::HWY_NAMESPACE::atan2_pi(d, sine, x), hn::Set(d, pi));
    w = hn::IfThenElse(hn::Ge(x, one), hn::Zero(d), hn::IfThenElse(hn::Le(x, minus), hn::Set(d, pi), w));
    hn::StoreU(w, d, &angles[k]);
  }
}

// Ranges of t, and what even light of radiance 1 adds: half of the mean of t, which is known, and half of that of |t|,
// which is that of a plane over a rectangle, but for its bend and the unevenness of the weight.
// Of t+^2 that of the plane itself. t+^3 is between 0 and high t+^2.
void CellRanges(const HingePolynomial& weight, HingeBatch& batch) {
  const D d;
  auto at = [&](HingeBatch::Field f, std::size_t k) HWY_ATTR { return hn::LoadU(d, batch.field(f) + k); };
  const hn::Rebind<float, D> floats;
  auto put = [&](HingeBatch::Found f, std::size_t k, V v)
                 HWY_ATTR { hn::StoreU(hn::DemoteTo(floats, v), floats, batch.found(f) + k); };
  const V zero = hn::Zero(d), half = hn::Set(d, 0.5), one = hn::Set(d, 1);
  const V g1 = hn::Set(d, weight.factors[0]), g2 = hn::Set(d, weight.factors[1]), g3 = hn::Set(d, weight.factors[2]);
  for (std::size_t k = 0; k < batch.count(); k += hn::Lanes(d)) {
    const V middle = at(HingeBatch::middle, k), a = at(HingeBatch::across, k), b = at(HingeBatch::down, k);
    // No extent is below 1e-4 of the other, or differences vanish: that moves the means by less than 1e-8 of it.
    const V widest = hn::Max(a, b), least = hn::Add(hn::Mul(widest, hn::Set(d, 1e-4)), hn::Set(d, 1e-30));
    const V wide = hn::Max(a, least), tall = hn::Max(b, least);
    const V bend = hn::Add(at(HingeBatch::bend, k), hn::Mul(widest, hn::Set(d, 1e-8)));
    const V extent = hn::Add(hn::Add(a, b), bend), bottom = hn::Sub(middle, extent), top = hn::Add(middle, extent);
    const V near = at(HingeBatch::near, k),
            low = hn::Mul(bottom, hn::IfThenElse(hn::Lt(bottom, zero), near, at(HingeBatch::far, k)));
    const V high = hn::Mul(top, near), omega = at(HingeBatch::solid_angle, k);
    put(HingeBatch::omega, k, omega), put(HingeBatch::average, k, at(HingeBatch::mean, k));
    put(HingeBatch::low, k, low), put(HingeBatch::high, k, high);
    put(HingeBatch::slope, k, hn::Div(high, hn::Max(hn::Sub(high, low), hn::Set(d, 1e-300))));
    const V steep = hn::Add(g1, hn::Mul(high, hn::Add(g2, hn::Mul(high, g3))));
    put(HingeBatch::steep, k, steep);
    V cubes = zero, fourths = zero;
    for (int corner = 0; corner < 4; ++corner) {
      const V x = hn::Add(middle, corner % 2 == 0 ? wide : hn::Neg(wide)),
              q = hn::Add(x, corner < 2 ? tall : hn::Neg(tall));
      const V p = hn::Max(q, zero), p2 = hn::Mul(p, p), m = hn::Abs(q), cube = hn::Mul(hn::Mul(m, m), m),
              fourth = hn::Mul(p2, p2);
      const bool plus = corner == 0 || corner == 3;
      cubes = plus ? hn::Add(cubes, cube) : hn::Sub(cubes, cube);
      fourths = plus ? hn::Add(fourths, fourth) : hn::Sub(fourths, fourth);
    }
    const V scale = hn::Div(hn::Set(d, 1.0 / 48), hn::Mul(wide, tall));
    const V w1 = hn::Mul(at(HingeBatch::weight1, k), omega), u1 = at(HingeBatch::uneven1, k);
    const V size = hn::Mul(hn::Mul(cubes, scale), hn::Set(d, 2));
    const V even1 = hn::Mul(half, hn::Add(hn::Mul(omega, at(HingeBatch::mean, k)), hn::Mul(w1, size)));
    const V off1 = hn::Mul(hn::Mul(half, w1), hn::Add(hn::Mul(u1, size), hn::Mul(hn::Add(one, u1), bend)));
    const V square = hn::Max(zero, hn::Mul(fourths, scale));
    const V w2 = hn::Mul(at(HingeBatch::weight2, k), omega), u2 = at(HingeBatch::uneven2, k);
    const V even2 = hn::Mul(w2, square), reach = hn::Mul(hn::Set(d, 2), hn::Add(hn::Abs(middle), extent));
    const V off2 = hn::Mul(w2, hn::Add(hn::Mul(u2, square), hn::Mul(hn::Add(one, u2), hn::Mul(bend, reach))));
    const V third = hn::Mul(hn::Mul(half, g3), hn::Mul(hn::Max(zero, high), hn::Add(even2, off2)));
    put(HingeBatch::even, k, hn::Add(hn::Add(hn::Mul(g1, even1), hn::Mul(g2, even2)), third));
    put(HingeBatch::off, k, hn::Add(hn::Add(hn::Mul(g1, off1), hn::Mul(g2, off2)), third));
  }
}

// Parts of a cell's flux that rounding may move a term and its bound by: up to 16 roundings to float each, of t <= 1.
constexpr float rounding_of_flux = 2e-6F;

// What the terms of one sum have in common.
struct Weights {
  Lanes g1, g2, g3, rounding;
  explicit Weights(const HingePolynomial& w)
      : g1(hn::Set(F(), float(w.factors[0]))),
        g2(hn::Set(F(), float(w.factors[1]))),
        g3(hn::Set(F(), float(w.factors[2]))),
        rounding(hn::Set(F(), rounding_of_flux * float(w.slope(1)))) {}
};

// Wholly above. The weight is convex: at least that of the mean t, by Jensen's inequality, and the second derivative at
// `high` limits how much more. @param f flux. @param m first moment. @param c the first channel.
HWY_INLINE void above(float low, float high, const Weights& w, Lanes f, Lanes m, HingeTerm& out, std::size_t c) {
  const F d;
  const Lanes mean = hn::Div(m, hn::Max(f, hn::Set(d, 1e-37F)));
  const Lanes spread = hn::Mul(hn::Sub(hn::Set(d, high), mean), hn::Sub(m, hn::Mul(f, hn::Set(d, low))));
  const Lanes bent = hn::Mul(hn::Set(d, 0.5F), hn::Add(w.g2, hn::Mul(hn::Set(d, 3 * high), w.g3)));
  const Lanes gap = hn::Mul(bent, hn::Max(hn::Zero(d), spread));
  const Lanes least = hn::Mul(m, hn::Add(w.g1, hn::Mul(mean, hn::Add(w.g2, hn::Mul(mean, w.g3)))));
  hn::Store(hn::Add(least, gap), d, &out.middle[c]);
  hn::Store(hn::Add(gap, hn::Mul(f, w.rounding)), d, &out.off[c]);
}

// Even light and the rest, which is not negative: t+ of the rest lies between max(0, its moment) and the chord from low
// to high, and the weight between g1 t+ and t+ x its slope at high.
HWY_INLINE void cut(const float* found, std::size_t room, const Weights& w, Lanes f, Lanes m, Lanes e, HingeTerm& out,
                    std::size_t c) {
  const F d;
  const auto of = [&](HingeBatch::Found which) HWY_ATTR { return hn::Set(d, found[which * room]); };
  const Lanes zero = hn::Zero(d), half = hn::Set(d, 0.5F);
  const Lanes light = hn::Mul(e, of(HingeBatch::omega));
  const Lanes rest = hn::Max(zero, hn::Sub(f, light)), moment = hn::Sub(m, hn::Mul(light, of(HingeBatch::average)));
  const Lanes jensen = hn::Max(zero, moment);
  const Lanes chord =
      hn::Max(jensen, hn::Mul(hn::Sub(moment, hn::Mul(rest, of(HingeBatch::low))), of(HingeBatch::slope)));
  const Lanes least = hn::Mul(w.g1, jensen), most = hn::Mul(of(HingeBatch::steep), chord);
  hn::Store(hn::Add(hn::Mul(half, hn::Add(least, most)), hn::Mul(e, of(HingeBatch::even))), d, &out.middle[c]);
  hn::Store(hn::Add(hn::Add(hn::Mul(half, hn::Sub(most, least)), hn::Mul(e, of(HingeBatch::off))),
                    hn::Mul(f, w.rounding)),
            d, &out.off[c]);
}

void BoundCells(const FaceDirection& n, const HingePolynomial& weight, HingeBatch& batch, std::vector<HingeTerm>& out) {
  CellRanges(weight, batch);
  const F d;
  const Weights weights(weight);
  const Lanes x = hn::Set(d, float(n.x)), y = hn::Set(d, float(n.y)), z = hn::Set(d, float(n.z));
  const float* found = batch.found(HingeBatch::low);
  const std::size_t room = std::size_t(batch.found(HingeBatch::high) - found);
  std::size_t used = out.size();
  out.resize(used + batch.count());
  for (std::size_t k = 0; k < batch.count(); ++k) {
    const float low = found[k], high = found[k + room];
    if (high <= 0) continue;
    const HingeBatch::Place& place = batch.place(k);
    const float* p = place.light->m;
    HingeTerm& term = out[used++];
    term.face = place.face, term.row = place.row, term.column = place.column;
    for (std::size_t c = 0; c < 4; c += hn::Lanes(d), p += hn::Lanes(d)) {
      const Lanes m = hn::Add(hn::Add(hn::Mul(hn::LoadU(d, p), x), hn::Mul(hn::LoadU(d, p + 3), y)),
                              hn::Mul(hn::LoadU(d, p + 6), z));
      if (low >= 0)
        above(low, high, weights, hn::LoadU(d, p + 9), m, term, c);
      else
        cut(found + k, room, weights, hn::LoadU(d, p + 9), m, hn::LoadU(d, p + 12), term, c);
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

void HingeBatch::grow() {
  constexpr std::size_t least = 256, vector = 24;
  const std::size_t size = std::max(least, 2 * count_), before = std::exchange(room_, size + vector);
  std::vector<double> wider(fields * room_, 0.0);
  for (std::size_t f = 0; f < fields && count_ > 0; ++f) std::copy_n(&fields_[f * before], count_, &wider[f * room_]);
  fields_ = std::move(wider);
  found_.assign(founds * room_, 0.0F), places_.resize(size);
}

void bound_cells(const FaceDirection& n, const HingePolynomial& weight, HingeBatch& batch,
                 std::vector<HingeTerm>& out) {
  if (batch.count() > 0) HWY_DYNAMIC_DISPATCH(BoundCells)(n, weight, batch, out);
}
void border_angles(double slope, std::span<const double> y, std::vector<double>& angles) {
  HWY_DYNAMIC_DISPATCH(BorderAngles)(slope, y, angles);
}

}  // namespace envmap::prefiltering
#endif  // HWY_ONCE

// Kernels of multilevel sums for lanes: what a LevelKernel is, over x = 1 - cos. Included once a target.
#include <numbers>

#include "envmap/prefilter/lobe_lanes-inl.h"

#if defined(ENVMAP_PREFILTER_LEVEL_KERNEL_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ENVMAP_PREFILTER_LEVEL_KERNEL_INL_H_
#undef ENVMAP_PREFILTER_LEVEL_KERNEL_INL_H_
#else
#define ENVMAP_PREFILTER_LEVEL_KERNEL_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {

constexpr std::size_t virtual_lanes = 8;
using D = hn::CappedTag<float, virtual_lanes>;
using V = hn::Vec<D>;
constexpr std::size_t lanes = hn::MaxLanes(D()), parts = virtual_lanes / lanes;
constexpr float narrow_end = 5e-3F;

// The sum of the virtual lanes, in one order on every processor.
HWY_INLINE double sum_of(const V (&total)[parts]) {
  float s[virtual_lanes];
  for (std::size_t part = 0; part < parts; ++part) hn::StoreU(total[part], D(), s + part * lanes);
  const auto pair = [&](std::size_t k) { return double(s[k]) + double(s[k + 4]); };
  return (pair(0) + pair(2)) + (pair(1) + pair(3));
}

// Three channels of virtual lanes.
struct Sums {
  V of[3][parts];

  HWY_INLINE Sums() {
    for (auto& channel : of)
      for (V& v : channel) v = hn::Zero(D());
  }
  // @param values the red ones; green and blue follow `stride` floats apart.
  HWY_INLINE void add(std::size_t part, V weight, const float* values, std::size_t stride) {
    for (std::size_t c = 0; c < 3; ++c)
      of[c][part] = hn::Add(of[c][part], hn::Mul(weight, hn::LoadU(D(), values + c * stride)));
  }
  HWY_INLINE void add(const Sums& more) {
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t part = 0; part < parts; ++part) of[c][part] = hn::Add(of[c][part], more.of[c][part]);
  }
  [[nodiscard]] HWY_INLINE Flux whole() const { return {sum_of(of[0]), sum_of(of[1]), sum_of(of[2])}; }
};

// 2 sin(angle)^2 of column - at, half a column's width of longitude each.
HWY_INLINE void versines(double at, int columns, int low, int high, float* out) {
  const D d;
  const int whole = int(std::floor(at));
  const V step = hn::Set(d, float(pi / columns)), offset = hn::Set(d, float(at - whole));
  for (int k = low; k < high; k += int(lanes)) {
    const V t = hn::Mul(step, hn::Sub(hn::Iota(d, float(k - whole)), offset)), tt = hn::Mul(t, t);
    const V s = hn::Mul(t, series(d, tt, 1, -1.0 / 6, 1.0 / 120, -1.0 / 5040, 1.0 / 362880, -1.0 / 39916800));
    hn::StoreU(hn::Add(hn::Mul(s, s), hn::Mul(s, s)), d, out + (k - low));
  }
}

template <bool quartic>
HWY_INLINE V softened(const LevelKernel::Softened& s, V x) {
  const D d;
  const V y = hn::Max(hn::Zero(d), hn::Sub(hn::Set(d, s.root), hn::Mul(hn::Set(d, s.root * s.inverse), x))),
          yy = hn::Mul(y, y);
  return hn::Mul(yy, quartic ? yy : y);
}

HWY_INLINE V hinges(const LevelKernel& k, V t) {
  const D d;
  const auto g = [&](std::size_t n) HWY_ATTR { return hn::Set(d, k.hinges[n]); };
  return hn::Mul(t, hn::Add(g(0), hn::Mul(t, hn::Add(g(1), hn::Mul(t, g(2))))));
}

// With W = a + 1, t = 1 - x and q = a + x = W - t: t / q^2 less its first three Taylor terms,
// t / W^2 + 2 t^2 / W^3 + 3 t^3 / W^4, is t^4 (4 W - 3 t) / (q^2 W^4), which has no difference of large numbers.
template <bool inner, bool outer, bool quartic>
struct OfGgx {
  const LevelKernel& k;
  HWY_INLINE V operator()(V x) const {
    const D d;
    const float a1 = k.a + 1;
    const V whole = hn::Set(d, a1), q = hn::Add(hn::Set(d, k.a), x);
    if (!outer) {
      const V zero = hn::Zero(d), t = hn::Max(zero, hn::Sub(hn::Set(d, 1), x));
      const V s = inner ? softened<quartic>(k.inner, x) : zero, t1 = hn::Max(zero, hn::Sub(t, s)),
              q1 = inner ? hn::Add(q, s) : q;
      const V square = hn::Mul(t1, t1), rise = hn::Sub(hn::Set(d, 4 * a1), hn::Mul(hn::Set(d, 3), t1));
      const V rest =
          hn::Div(hn::Mul(hn::Mul(square, square), rise), hn::Mul(hn::Mul(q1, q1), hn::Set(d, a1 * a1 * a1 * a1)));
      if (!inner) return rest;
      const V second = hn::Mul(hn::Set(d, k.hinges[1]), hn::Add(t1, t));
      const V third = hn::Mul(hn::Set(d, k.hinges[2]), hn::Add(square, hn::Mul(t, hn::Add(t1, t))));
      return hn::Sub(rest, hn::Mul(s, hn::Add(hn::Set(d, k.hinges[0]), hn::Add(second, third))));
    }
    const V q1 = inner ? hn::Add(q, softened<quartic>(k.inner, x)) : q;
    const V q2 = hn::Add(q, softened<quartic>(k.outer, x)), product = hn::Mul(q1, q2);
    const V rise = hn::Sub(hn::Mul(whole, hn::Add(q1, q2)), product);
    return hn::Div(hn::Mul(hn::Sub(q2, q1), rise), hn::Mul(product, product));
  }
};

// log2(1 - x) of x up to narrow_end: what the series leaves out changes no lobe by 1e-6 before it is cut off.
HWY_INLINE V log2_near_one(V x) {
  constexpr double unit = -std::numbers::log2e;
  return hn::Mul(x, series(D(), x, unit, unit / 2, unit / 3));
}

// (1 - y)^power
HWY_INLINE V power_of(const LevelKernel& k, V y) {
  const D d;
  const V log = k.part * k.end <= narrow_end ? log2_near_one(hn::Min(y, hn::Set(d, 1))) : log2_one_minus(d, y);
  return exp2_small(d, hn::Mul(hn::Set(d, k.power), log));
}

template <bool cosine>
struct OfPower {
  const LevelKernel& k;
  HWY_INLINE V operator()(V x) const {
    const D d;
    const V t = hn::Max(hn::Zero(d), hn::Sub(hn::Set(d, 1), x));
    V value = power_of(k, hn::Mul(hn::Set(d, k.part), x));
    if (cosine) value = hn::Sub(hn::Mul(value, t), hinges(k, t));
    return hn::IfThenElseZero(hn::Lt(x, hn::Set(d, k.end)), value);
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();
#endif

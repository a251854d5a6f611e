// The formulae of LevelKernel for lanes, over x = 1 - cos. Included once a target.
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

template <class T>
HWY_INLINE V broadcast(T c) {
  return broadcast(D(), c);
}

// The sum of the virtual lanes, in one order on every processor.
HWY_INLINE double sum_of(const V (&total)[parts]) {
  float s[virtual_lanes];
  for (std::size_t part = 0; part < parts; ++part) hn::StoreU(total[part], D(), s + part * lanes);
  const auto pair = [&](std::size_t k) { return double(s[k]) + double(s[k + 4]); };
  return (pair(0) + pair(2)) + (pair(1) + pair(3));
}

// Sums of three channels in virtual lanes.
struct Sums {
  V of[3][parts];

  HWY_INLINE Sums() {
    for (auto& channel : of)
      for (V& v : channel) v = hn::Zero(D());
  }
  // @param values of red; those of green and blue follow `stride` floats apart.
  HWY_INLINE void add(std::size_t part, V weight, const float* values, std::size_t stride) {
    for (std::size_t c = 0; c < 3; ++c) of[c][part] += weight * hn::LoadU(D(), values + c * stride);
  }
  HWY_INLINE void add(const Sums& more) {
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t part = 0; part < parts; ++part) of[c][part] += more.of[c][part];
  }
  [[nodiscard]] HWY_INLINE Flux whole() const { return {sum_of(of[0]), sum_of(of[1]), sum_of(of[2])}; }
};

// 2 sin(angle)^2 of column - at, half a column's width of longitude each.
HWY_INLINE void versines(double at, int columns, int low, int high, float* out) {
  const D d;
  const int whole = int(std::floor(at));
  const V step = broadcast(pi / columns), offset = broadcast(at - whole);
  for (int k = low; k < high; k += int(lanes)) {
    const V t = step * (hn::Iota(d, float(k - whole)) - offset), tt = t * t;
    const V s = t * polynomial(d, tt, 1, -1.0 / 6, 1.0 / 120, -1.0 / 5040, 1.0 / 362880, -1.0 / 39916800);
    hn::StoreU(s * s + s * s, d, out + (k - low));
  }
}

template <bool quartic>
HWY_INLINE V flattened(const LevelKernel::Flattening& s, V x) {
  const D d;
  const V y = hn::Max(hn::Zero(d), broadcast(s.root) - broadcast(s.root * s.inverse) * x), yy = y * y;
  return yy * (quartic ? yy : y);
}

HWY_INLINE V horizon_terms(const LevelKernel& k, V t) {
  const auto g = [&](std::size_t n) HWY_ATTR { return broadcast(k.horizon_terms[n]); };
  return t * (g(0) + t * (g(1) + t * g(2)));
}

// GGX, t / q^2 with t = 1 - x, q = a + x = W - t and W = a + 1. Less its first three terms at the horizon, t / W^2 + 2
// t^2 / W^3 + 3 t^3 / W^4, it is t^4 (4 W - 3 t) / (q^2 W^4), which has no difference of large numbers. Flattening adds
// s to q and takes it from t.
template <bool inner, bool outer, bool quartic>
struct GgxKernel {
  const LevelKernel& k;
  HWY_INLINE V operator()(V x) const {
    const D d;
    const float a1 = k.a + 1;
    const V whole = broadcast(a1), q = broadcast(k.a) + x;
    if (!outer) {
      const V zero = hn::Zero(d), t = hn::Max(zero, broadcast(1) - x);
      const V s = inner ? flattened<quartic>(k.inner, x) : zero, t1 = hn::Max(zero, t - s), q1 = inner ? q + s : q;
      const V square = t1 * t1, rise = broadcast(4 * a1) - broadcast(3) * t1;
      const V rest = square * square * rise / (q1 * q1 * broadcast(a1 * a1 * a1 * a1));
      if (!inner) return rest;
      const V second = broadcast(k.horizon_terms[1]) * (t1 + t);
      const V third = broadcast(k.horizon_terms[2]) * (square + t * (t1 + t));
      return rest - s * (broadcast(k.horizon_terms[0]) + (second + third));
    }
    const V q1 = inner ? q + flattened<quartic>(k.inner, x) : q;
    const V q2 = q + flattened<quartic>(k.outer, x), product = q1 * q2;
    const V rise = whole * (q1 + q2) - product;
    return (q2 - q1) * rise / (product * product);
  }
};

// log2(1 - x) of x up to narrow_end, to three terms: the rest changes no lobe by 1e-6 before its end.
HWY_INLINE V log2_near_one(V x) {
  constexpr double unit = -std::numbers::log2e;
  return x * polynomial(D(), x, unit, unit / 2, unit / 3);
}

// The binary logarithm of (1 - y)^power, and the power.
HWY_INLINE V log2_of_power(const LevelKernel& k, V y) {
  const bool narrow = k.part * k.end <= narrow_end;
  return broadcast(k.power) * (narrow ? log2_near_one(hn::Min(y, broadcast(1))) : log2_one_minus(D(), y));
}
HWY_INLINE V power_of(const LevelKernel& k, V y) { return exp2_small(D(), log2_of_power(k, y)); }

template <bool cosine>
struct PowerKernel {
  const LevelKernel& k;
  HWY_INLINE V operator()(V x) const {
    const D d;
    const V t = hn::Max(hn::Zero(d), broadcast(1) - x);
    V value = power_of(k, broadcast(k.part) * x);
    if (cosine) value = value * t - horizon_terms(k, t);
    return hn::IfThenElseZero(hn::Lt(x, broadcast(k.end)), value);
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();
#endif

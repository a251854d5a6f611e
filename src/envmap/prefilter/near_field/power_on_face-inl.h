// A narrow power of the cosine over the texels of a cube's face. Included once a target.
//
// A panel is a texel or a part of one. The logarithm of the mean of power x solid angle over a panel is a smooth
// function of where the panel's middle lies on the face: that of the power itself is nearly a parabola, and what the
// mean adds is about log(sinh(g) / g) of a power that falls as e^(-g u) along a panel of width 2. So it is computed at
// 8 x 8 Chebyshev nodes of the window that the lobe covers on a face, by sixteen Gauss points each, and a polynomial
// gives it for every panel, which takes one power of two. tests/bench/kappa.cpp measures the error of all.
#include "envmap/prefilter/near_field/gauss_points-inl.h"
#include "envmap/prefilter/near_field/narrow_power-inl.h"
#include "envmap/prefilter/near_field/point_rules.h"

#if defined(ENVMAP_PREFILTER_POWER_ON_FACE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ENVMAP_PREFILTER_POWER_ON_FACE_INL_H_
#undef ENVMAP_PREFILTER_POWER_ON_FACE_INL_H_
#else
#define ENVMAP_PREFILTER_POWER_ON_FACE_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {

// The Chebyshev nodes of [-1, 1].
inline constexpr std::size_t terms_on_face = virtual_lanes;
inline constexpr Interpolation<terms_on_face> on_face({-0.980785280403230449, -0.831469612302545237,
                                                       -0.555570233019602225, -0.195090322016128268,
                                                       0.195090322016128268, 0.555570233019602225, 0.831469612302545237,
                                                       0.980785280403230449});

// The places of the middles of panels along one side of a face, from the output's place.
struct MiddlesAlong {
  double middle, half;  // half > 0
  MiddlesAlong(double from, double to) : middle(0.5 * (from + to)), half(std::max(1e-6, 0.5 * (to - from))) {}
};

// The binary logarithm of the mean of power x solid angle over a panel.
template <bool cosine>
class PanelMeans {
 public:
  static_assert(panel_values == terms_on_face * terms_on_face * 16);

  // @param panel the side of a panel.
  PanelMeans(const OnCube& place, const LevelKernel& k, const MiddlesAlong& across, const MiddlesAlong& down,
             double panel)
      : down_(down) {
    double logs[terms_on_face][terms_on_face];
    for (std::size_t j = 0; j < terms_on_face; ++j) {
      double row[terms_on_face];
      set_logs(place, k, across, down.middle + down.half * double(on_face.nodes[j]), panel, row);
      for (std::size_t n = 0; n < terms_on_face; ++n) {
        logs[j][n] = 0;
        for (std::size_t i = 0; i < terms_on_face; ++i) logs[j][n] += on_face.weight[n][i] * row[i];
      }
    }
    for (std::size_t m = 0; m < terms_on_face; ++m)
      for (std::size_t n = 0; n < terms_on_face; ++n) {
        factors_[m][n] = 0;
        for (std::size_t j = 0; j < terms_on_face; ++j) factors_[m][n] += on_face.weight[m][j] * logs[j][n];
      }
  }

  // The factors of t^n for a row of panels, with t from -1 to 1 across. @param y of their middles.
  struct Row {
    float factor[terms_on_face];
    HWY_INLINE V at(V t) const {
      const V tt = t * t;
      const auto f = [&](std::size_t n) HWY_ATTR { return broadcast(factor[n]); };
      const V even = f(0) + tt * (f(2) + tt * (f(4) + tt * f(6)));
      const V odd = f(1) + tt * (f(3) + tt * (f(5) + tt * f(7)));
      return even + t * odd;
    }
  };
  [[nodiscard]] Row row(double y) const {
    const double t = (y - down_.middle) / down_.half;
    Row row{};
    for (std::size_t n = 0; n < terms_on_face; ++n) {
      double sum = 0;
      for (std::size_t m = terms_on_face; m-- > 0;) sum = factors_[m][n] + t * sum;
      row.factor[n] = float(sum);
    }
    return row;
  }

 private:
  // At the nodes of a row.
  static void set_logs(const OnCube& place, const LevelKernel& k, const MiddlesAlong& across, double y, double panel,
                       double (&logs)[terms_on_face]) {
    const D d;
    alignas(32) float more[virtual_lanes];
    for (std::size_t part = 0; part < parts; ++part) {
      const V x = broadcast(across.middle) + broadcast(across.half) * hn::Load(d, on_face.nodes + part * lanes);
      hn::Store(log_of_mean(place, k, x, y, panel), d, more + part * lanes);
    }
    // Tails have logarithms of -100, which floats would leave with 1e-5 of error.
    const hn::CappedTag<double, 2> two;
    for (std::size_t i = 0; i < terms_on_face; i += hn::Lanes(two)) {
      alignas(16) double versine[2];
      for (std::size_t n = 0; n < hn::Lanes(two); ++n)
        versine[n] = place.exact_versine(across.middle + across.half * double(on_face.nodes[i + n]), y);
      const auto log = log2_one_minus(two, hn::Set(two, double(k.part)) * hn::Load(two, versine));
      hn::StoreU(hn::Set(two, double(k.power)) * log, two, logs + i);
      for (std::size_t n = 0; n < hn::Lanes(two); ++n) logs[i + n] += double(more[i + n]);
    }
  }

  // The mean over the power in the middle.
  static HWY_INLINE V log_of_mean(const OnCube& place, const LevelKernel& k, V x, double y, double panel) {
    const D d;
    constexpr float room = 8;  // exp2_small() takes no more than 1.
    const V log = log2_of_power(k, broadcast(k.part) * place.versine(x, broadcast(y))) + broadcast(room);
    V sum = hn::Zero(d);
    for (std::size_t g = 0; g < 16; ++g) {
      const V ds = x + broadcast(0.5 * panel * double(points.x[g])),
              dt = broadcast(y + 0.5 * panel * double(points.y[g])), versine = place.versine(ds, dt);
      V value = exp2_small(d, log2_of_power(k, broadcast(k.part) * versine) - log) * place.area(ds, dt);
      if (cosine) value = value * (broadcast(1) - versine);
      sum += broadcast(0.25F * points.weight[g]) * value;
    }
    return log2_of(d, sum, broadcast(1) - sum) + broadcast(room);
  }

  MiddlesAlong down_;
  double factors_[terms_on_face][terms_on_face];
};

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();
#endif

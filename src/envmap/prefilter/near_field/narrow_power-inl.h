// A narrow power of the cosine over the texels of latlong rows away from the poles. Included once a target.
//
// With v = 1 - cos(longitude from the output), a point has x = c + g v, where c and g depend on its polar angle
// alone, and
//   (1 - part x)^m = (1 - part c)^m (1 - w)^m,   w = gamma v,   gamma = part g / (1 - part c).
// The first factor is integrated over the height of a row by Gauss points. gamma changes little over that height: its
// mean, variance and third moment stand for it (PowerRow). The logarithm of the mean of (1 - w)^m over a texel's width
// is a polynomial of v of degree 5 through six Chebyshev nodes, where four Gauss points integrate it. Its coefficients
// are parabolas of gamma (PowerPolynomials). So a texel takes one power of two.
//
// Blinn's lobe has a factor 1 - x, which is (1 - c) (1 - w / part) but for c w. That is below 2e-5 in lobes this
// narrow, which have no horizon terms. tests/bench/kappa.cpp measures the error of all.
#include "envmap/prefilter/near_field/gauss_points-inl.h"

#if defined(ENVMAP_PREFILTER_NARROW_POWER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ENVMAP_PREFILTER_NARROW_POWER_INL_H_
#undef ENVMAP_PREFILTER_NARROW_POWER_INL_H_
#else
#define ENVMAP_PREFILTER_NARROW_POWER_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {

// The polynomial through values at nodes.
template <std::size_t terms>
struct Interpolation {
  alignas(32) float nodes[virtual_lanes] = {};  // Padded with 0.
  // Through values y_i at the nodes it is the sum of weight[k][i] y_i x^k.
  double weight[terms][terms] = {};

  constexpr explicit Interpolation(const double (&x)[terms]) {
    for (std::size_t i = 0; i < terms; ++i) {
      nodes[i] = float(x[i]);
      double basis[terms] = {1}, gaps = 1;
      for (std::size_t j = 0, degree = 0; j < terms; ++j) {
        if (j == i) continue;
        gaps *= x[i] - x[j];
        for (std::size_t k = ++degree; k > 0; --k) basis[k] = basis[k - 1] - x[j] * basis[k];
        basis[0] *= -x[j];
      }
      for (std::size_t k = 0; k < terms; ++k) weight[k][i] = basis[k] / gaps;
    }
  }
};
// The Chebyshev nodes of [0, 1].
inline constexpr std::size_t terms_across = 6;
inline constexpr Interpolation<terms_across> chebyshev({0.017037086855465844, 0.146446609406726238,
                                                        0.370590477448739670, 0.629409522551260330,
                                                        0.853553390593273762, 0.982962913144534156});

// The Gauss points in the right half of a panel: 1 - cos and sin of their longitudes from its middle.
struct AcrossPanel {
  static constexpr std::size_t points = 2;
  float versine[points], sine[points], weight[points];
  // @param half the width of the panel.
  explicit AcrossPanel(double half) {
    for (std::size_t k = 0; k < points; ++k) {
      const SmallAngle angle(half * quadrature::gauss_4.node[points + k]);
      versine[k] = float(angle.versine), sine[k] = float(angle.sine),
      weight[k] = float(0.5 * quadrature::gauss_4.weight[points + k]);
    }
  }
};

// The height of a row integrated, as a function of w.
struct PowerRow {
  double height = 0;              // The integral at w = 0, over the sides of a texel.
  double gamma = 0;               // The mean.
  double variance = 0, skew = 0;  // The terms of w^2 and w^3 that the variance and third moment add to the binary log.

  // @param row of points down.
  template <bool cosine>
  static PowerRow of(const LevelKernel& k, const OnLatlong::Row& row, std::size_t points) {
    const D d;
    alignas(32) float value[SideRule::most], factor[SideRule::most];
    for (std::size_t j = 0; j < points; j += lanes) {
      const V one = broadcast(1), c = hn::Load(d, row.c + j), y = broadcast(k.part) * c;
      const V all = hn::Load(d, row.weight + j) * power_of(k, y);
      hn::Store(cosine ? all * (one - c) : all, d, value + j);
      hn::Store(broadcast(k.part) * hn::Load(d, row.g + j) / (one - y), d, factor + j);
    }
    double height = 0, first = 0, second = 0, third = 0;
    for (std::size_t j = 0; j < points; ++j) height += double(value[j]), first += double(value[j]) * double(factor[j]);
    const double gamma = first / height, steep = double(k.power) / gamma;
    for (std::size_t j = 0; j < points; ++j) {
      const double deviation = steep * (double(factor[j]) - gamma), part = double(value[j]) * deviation * deviation;
      second += part, third -= part * deviation;
    }
    return {height, gamma, std::numbers::log2e / 2 * second / height, std::numbers::log2e / 6 * third / height};
  }
};

// The binary logarithm of a row's mean over a panel of a texel's width, as a polynomial of t = w / most at the middle
// of the panel.
struct PowerPolynomial {
  float per_v;  // t / v
  float factor[terms_across];

  HWY_INLINE V mean_of(V v) const {
    const D d;
    const V t = v * broadcast(per_v), tt = t * t;
    const auto f = [&](std::size_t n) HWY_ATTR { return broadcast(factor[n]); };
    const V even = f(0) + tt * (f(2) + tt * f(4));
    const V odd = f(1) + tt * (f(3) + tt * f(5));
    return exp2_small(d, even + t * odd);
  }
};

// The polynomials of all rows, whose factors are parabolas of gamma.
template <bool cosine>
class PowerPolynomials {
 public:
  // @param half the width of a panel, in longitude. @param most of w.
  PowerPolynomials(const LevelKernel& k, double half, double least_gamma, double most_gamma, double most)
      : most_(most), middle_(0.5 * (least_gamma + most_gamma)), reach_(std::max(1e-37, most_gamma - middle_)) {
    const AcrossPanel across(half);
    for (std::size_t i = 0; i < 3; ++i) {
      const D d;
      const V gamma = broadcast(middle_ + (double(i) - 1) * reach_);
      alignas(32) float logs[virtual_lanes];
      for (std::size_t part = 0; part < parts; ++part) {
        const V w = broadcast(most) * hn::Load(d, chebyshev.nodes + part * lanes);
        hn::Store(log_of_mean(k, across, gamma, w / gamma), d, logs + part * lanes);
      }
      for (std::size_t n = 0; n < terms_across; ++n) {
        factors_[i][n] = 0;
        for (std::size_t j = 0; j < terms_across; ++j) factors_[i][n] += chebyshev.weight[n][j] * double(logs[j]);
      }
    }
  }

  [[nodiscard]] PowerPolynomial at(const PowerRow& row) const {
    const double t = (row.gamma - middle_) / reach_;
    PowerPolynomial p{float(row.gamma / most_), {}};
    for (std::size_t n = 0; n < terms_across; ++n) {
      const double low = factors_[0][n], here = factors_[1][n], high = factors_[2][n];
      p.factor[n] = float(here + t * (0.5 * (high - low) + t * (0.5 * (high + low) - here)));
    }
    p.factor[2] += float(row.variance * most_ * most_), p.factor[3] += float(row.skew * most_ * most_ * most_);
    return p;
  }

 private:
  static HWY_INLINE V log_of_mean(const LevelKernel& k, const AcrossPanel& across, V gamma, V v) {
    const D d;
    const V one = broadcast(1), cosine_v = one - v, sine_v = hn::Sqrt(v * (one + cosine_v));
    const auto value = [&](V at) HWY_ATTR {
      const V w = gamma * at, power = power_of(k, w);
      return cosine ? power * (one - w * broadcast(1 / k.part)) : power;
    };
    V sum = hn::Zero(d);
    for (std::size_t n = 0; n < AcrossPanel::points; ++n) {
      const V middle = v + cosine_v * broadcast(across.versine[n]), swing = sine_v * broadcast(across.sine[n]);
      const V both = value(middle - swing) + value(middle + swing);
      sum += broadcast(across.weight[n]) * both;
    }
    return log2_of(d, sum, one - sum);
  }

  double most_, middle_, reach_;
  double factors_[3][terms_across];
};

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();
#endif

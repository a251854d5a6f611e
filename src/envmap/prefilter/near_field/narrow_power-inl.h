// A power of the cosine over the texels of a row of a latlong map, away from its poles. Included once a target.
#include "envmap/prefilter/near_field/gauss_points-inl.h"

#if defined(ENVMAP_PREFILTER_POWER_ROW_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ENVMAP_PREFILTER_POWER_ROW_INL_H_
#undef ENVMAP_PREFILTER_POWER_ROW_INL_H_
#else
#define ENVMAP_PREFILTER_POWER_ROW_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {

// Interpolation at Chebyshev's nodes in 0 to 1.
struct Chebyshev {
  static constexpr std::size_t terms = 6;
  alignas(32) float nodes[virtual_lanes] = {};  // The rest is 0.
  // The polynomial through some values has the sum of weight[k][i] x value i as its factor of x^k.
  double weight[terms][terms] = {};

  constexpr Chebyshev() {
    constexpr double x[terms] = {0.017037086855465844, 0.146446609406726238, 0.370590477448739670,
                                 0.629409522551260330, 0.853553390593273762, 0.982962913144534156};
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
inline constexpr Chebyshev chebyshev;

// Gauss's points across a panel, from its middle: 1 - cos and sin of the longitudes right of it.
struct AcrossPanel {
  static constexpr std::size_t points = 2;
  float versine[points], sine[points], weight[points];
  // @param half the width of the panel.
  explicit AcrossPanel(double half) {
    for (std::size_t k = 0; k < points; ++k) {
      const SmallAngle off(half * node[points + k]);
      versine[k] = float(off.versine), sine[k] = float(off.sine), weight[k] = float(0.5 * node_weight[points + k]);
    }
  }
};

// With x = c + g v, v = 1 - cos(longitude), the power (1 - part x)^m is (1 - part c)^m (1 - w)^m, where w = gamma v and
// gamma = part g / (1 - part c). Blinn's factor 1 - x is (1 - c) (1 - w / part) but for c w, which is below 2e-5 in
// lobes this narrow. They have no hinges.

// A row as a factor of w. gamma changes little over its height: its first three moments do.
struct PowerRow {
  double height = 0;  // The row at w = 0, in steradians but for the sides of a texel.
  double gamma = 0;
  double spread = 0, skew = 0;  // Variance and third moment add these to the binary logarithm, times w^2 and w^3.

  // @param row of points down.
  template <bool cosine>
  static PowerRow of(const LevelKernel& k, const OnLatlong::Row& row, std::size_t points) {
    const D d;
    alignas(32) float value[Rule::most], factor[Rule::most];
    for (std::size_t j = 0; j < points; j += lanes) {
      const V one = hn::Set(d, 1), c = hn::Load(d, row.c + j), y = hn::Mul(hn::Set(d, k.part), c);
      const V all = hn::Mul(hn::Load(d, row.weight + j), power_of(k, y));
      hn::Store(cosine ? hn::Mul(all, hn::Sub(one, c)) : all, d, value + j);
      hn::Store(hn::Div(hn::Mul(hn::Set(d, k.part), hn::Load(d, row.g + j)), hn::Sub(one, y)), d, factor + j);
    }
    double height = 0, first = 0, second = 0, third = 0;
    for (std::size_t j = 0; j < points; ++j) height += double(value[j]), first += double(value[j]) * double(factor[j]);
    const double gamma = first / height, steep = double(k.power) / gamma;
    for (std::size_t j = 0; j < points; ++j) {
      const double off = steep * (double(factor[j]) - gamma), part = double(value[j]) * off * off;
      second += part, third -= part * off;
    }
    return {height, gamma, std::numbers::log2e / 2 * second / height, std::numbers::log2e / 6 * third / height};
  }
};

// The mean of a row over a panel of a texel's width, with v in its middle: its binary logarithm is a polynomial of
// t = w / most.
struct PowerPolynomial {
  float per_v;  // t / v
  float factor[Chebyshev::terms];

  HWY_INLINE V mean_of(V v) const {
    const D d;
    const V t = hn::Mul(v, hn::Set(d, per_v)), tt = hn::Mul(t, t);
    const auto f = [&](std::size_t n) HWY_ATTR { return hn::Set(d, factor[n]); };
    const V even = hn::Add(f(0), hn::Mul(tt, hn::Add(f(2), hn::Mul(tt, f(4)))));
    const V odd = hn::Add(f(1), hn::Mul(tt, hn::Add(f(3), hn::Mul(tt, f(5)))));
    return exp2_small(d, hn::Add(even, hn::Mul(t, odd)));
  }
};

// The polynomials of all rows: the factors are parabolas of gamma.
template <bool cosine>
class PowerPolynomials {
 public:
  // @param half the width of a panel, in longitude. @param most of w.
  PowerPolynomials(const LevelKernel& k, double half, double least_gamma, double most_gamma, double most)
      : most_(most), middle_(0.5 * (least_gamma + most_gamma)), reach_(std::max(1e-37, most_gamma - middle_)) {
    const AcrossPanel across(half);
    for (std::size_t i = 0; i < 3; ++i) {
      const D d;
      const V gamma = hn::Set(d, float(middle_ + (double(i) - 1) * reach_));
      alignas(32) float logs[virtual_lanes];
      for (std::size_t part = 0; part < parts; ++part) {
        const V w = hn::Mul(hn::Set(d, float(most)), hn::Load(d, chebyshev.nodes + part * lanes));
        hn::Store(log_of_mean(k, across, gamma, hn::Div(w, gamma)), d, logs + part * lanes);
      }
      for (std::size_t n = 0; n < Chebyshev::terms; ++n) {
        factors_[i][n] = 0;
        for (std::size_t j = 0; j < Chebyshev::terms; ++j) factors_[i][n] += chebyshev.weight[n][j] * double(logs[j]);
      }
    }
  }

  [[nodiscard]] PowerPolynomial at(const PowerRow& row) const {
    const double t = (row.gamma - middle_) / reach_;
    PowerPolynomial p{float(row.gamma / most_), {}};
    for (std::size_t n = 0; n < Chebyshev::terms; ++n) {
      const double low = factors_[0][n], here = factors_[1][n], high = factors_[2][n];
      p.factor[n] = float(here + t * (0.5 * (high - low) + t * (0.5 * (high + low) - here)));
    }
    p.factor[2] += float(row.spread * most_ * most_), p.factor[3] += float(row.skew * most_ * most_ * most_);
    return p;
  }

 private:
  static HWY_INLINE V log_of_mean(const LevelKernel& k, const AcrossPanel& across, V gamma, V v) {
    const D d;
    const V one = hn::Set(d, 1), cosine_v = hn::Sub(one, v), sine_v = hn::Sqrt(hn::Mul(v, hn::Add(one, cosine_v)));
    const auto value = [&](V at) HWY_ATTR {
      const V w = hn::Mul(gamma, at), power = power_of(k, w);
      return cosine ? hn::Mul(power, hn::Sub(one, hn::Mul(w, hn::Set(d, 1 / k.part)))) : power;
    };
    V sum = hn::Zero(d);
    for (std::size_t n = 0; n < AcrossPanel::points; ++n) {
      const V middle = hn::Add(v, hn::Mul(cosine_v, hn::Set(d, across.versine[n]))),
              off = hn::Mul(sine_v, hn::Set(d, across.sine[n]));
      const V both = hn::Add(value(hn::Sub(middle, off)), value(hn::Add(middle, off)));
      sum = hn::Add(sum, hn::Mul(hn::Set(d, across.weight[n]), both));
    }
    return log2_of(d, sum, hn::Sub(one, sum));
  }

  double most_, middle_, reach_;
  double factors_[3][Chebyshev::terms];
};

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();
#endif

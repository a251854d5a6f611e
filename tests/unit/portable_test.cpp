// Elementary functions of our own against long double, and where their values are known exactly.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "envmap/maths/portable.h"

namespace envmap::portable_test {
namespace {

using Real = long double;

// How far off, in units in the last place of the exact result.
double ulps(double found, Real exact) {
  const double rounded = std::abs(double(exact));
  const double unit = std::max(rounded - std::nextafter(rounded, 0.0), std::numeric_limits<double>::denorm_min());
  return double(std::abs(found - exact) / unit);
}

// The largest error of f against g, for 200,000 arguments spread evenly over [low, high], and as many by their
// logarithms.
template <class F, class G>
double worst(double low, double high, F f, G g) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> even(low, high), exponent(-40, 0);
  double most = 0;
  for (int k = 0; k < 200000; ++k) {
    const double x = even(random), tiny = x * std::ldexp(1.0, int(exponent(random)));
    most = std::max(most, ulps(f(x), g(Real(x))));
    if (tiny >= low && tiny <= high) most = std::max(most, ulps(f(tiny), g(Real(tiny))));
  }
  return most;
}

TEST(Portable, SinesAndArcsKeepTheirBounds) {
  EXPECT_LT(worst(-3.2, 3.2, portable::sin, [](Real x) { return std::sin(x); }), 3);
  EXPECT_LT(worst(-3.2, 3.2, portable::cos, [](Real x) { return std::cos(x); }), 3);
  EXPECT_LT(worst(-1, 1, portable::asin, [](Real x) { return std::asin(x); }), 4);
  EXPECT_LT(worst(-1, 1, portable::acos, [](Real x) { return std::acos(x); }), 4);
  for (const double y : {0.3, -0.7, 1e-9}) {
    EXPECT_LT(worst(
                  -2, 2, [&](double x) { return portable::atan2(y, x); },
                  [&](Real x) { return std::atan2(Real(y), x); }),
              4);
  }
  // Far out against the arc that is left, as long double reduces no better.
  for (double x = -1e5; x < 1e5; x += 17.3)
    EXPECT_NEAR(portable::sin(x), double(std::sin(Real(x))), 2.3e-16) << x;
}

TEST(Portable, SinesOfHalvesOfPiAreExact) {
  for (int k = -8; k <= 8; ++k) {
    EXPECT_EQ(portable::sin_pi(0.5 * k), (k % 2 == 0 ? 0 : (k % 4 == 1 || k % 4 == -3) ? 1 : -1)) << k;
    EXPECT_EQ(portable::cos_pi(0.5 * k), (k % 2 != 0 ? 0 : k % 4 == 0 ? 1 : -1)) << k;
  }
}

TEST(Portable, ExponentialsKeepTheirBounds) {
  EXPECT_LT(worst(-700, 700, portable::exp, [](Real x) { return std::exp(x); }), 1);
  EXPECT_LT(worst(-1000, 1000, portable::exp2, [](Real x) { return std::exp2(x); }), 2);
  EXPECT_LT(worst(-30, 30, portable::expm1, [](Real x) { return std::expm1(x); }), 4);
  EXPECT_LT(worst(-740, -709, portable::exp, [](Real x) { return std::exp(x); }), 1.5)
      << "subnormal results round twice";
  for (int k = -1074; k < 1024; ++k) EXPECT_EQ(portable::exp2(k), std::ldexp(1.0, k));
  EXPECT_EQ(portable::exp(0), 1);
  EXPECT_EQ(portable::exp(1000), std::numeric_limits<double>::infinity());
  EXPECT_EQ(portable::exp(-1000), 0);
  EXPECT_EQ(portable::expm1(0), 0);
  EXPECT_TRUE(std::isnan(portable::exp(std::nan(""))));
}

TEST(Portable, LogarithmsKeepTheirBounds) {
  EXPECT_LT(worst(1e-300, 4, portable::log, [](Real x) { return std::log(x); }), 1);
  EXPECT_LT(worst(0.9, 1.1, portable::log, [](Real x) { return std::log(x); }), 1);
  EXPECT_LT(worst(1, 1e300, portable::log, [](Real x) { return std::log(x); }), 1);
  EXPECT_LT(worst(-0.99999, 10, portable::log1p, [](Real x) { return std::log1p(x); }), 2);
  EXPECT_LT(worst(1e-6, 1e6, portable::log2, [](Real x) { return std::log2(x); }), 2);
  for (int k = -1074; k < 1024; ++k) EXPECT_EQ(portable::log2(std::ldexp(1.0, k)), k);
  EXPECT_EQ(portable::log(1), 0);
  EXPECT_EQ(portable::log(0), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(portable::log1p(-1), -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(portable::log(-1)));
  EXPECT_LT(ulps(portable::log(5e-324), std::log(Real(5e-324))), 1) << "the least number there is";
}

TEST(Portable, PowersAndRootsKeepTheirBounds) {
  for (const double y : {1 / 2.4, 2.4, 5.0, -0.75, 30.0}) {
    const auto bound = [&](double x) { return 3 + std::abs(y * std::log(x)); };
    EXPECT_LT(worst(
                  1e-6, 10, [&](double x) { return portable::pow(x, y); },
                  [&](Real x) { return std::pow(x, Real(y)); }),
              bound(1e-18))
        << y;
  }
  EXPECT_LT(worst(-1e6, 1e6, portable::cbrt, [](Real x) { return std::cbrt(x); }), 2);
  EXPECT_LT(worst(
                -5, 5, [](double x) { return portable::hypot(x, 0.4); },
                [](Real x) { return std::hypot(x, Real(0.4)); }),
            2);
  EXPECT_EQ(portable::hypot(3e300, 4e300), 5e300);
  EXPECT_EQ(portable::hypot(0, -5e-324), 5e-324);
  EXPECT_EQ(portable::pow(0, 2), 0);
  EXPECT_EQ(portable::pow(7, 0), 1);
}

}  // namespace
}  // namespace envmap::portable_test

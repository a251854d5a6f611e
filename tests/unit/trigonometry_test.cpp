// The vector sine, cosine and arctangent of every target against long double, and against each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "unit/trigonometry_test.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "envmap/maths/trigonometry-inl.h"

HWY_BEFORE_NAMESPACE();
namespace envmap {
namespace HWY_NAMESPACE {

using Lanes = hn::ScalableTag<double>;

// Arrays are as long as a multiple of any vector.
void SinCos(const double* x, double* sine, double* cosine, std::size_t count) {
  const Lanes d;
  for (std::size_t k = 0; k < count; k += hn::Lanes(d)) {
    hn::Vec<Lanes> s, c;
    sin_cos_pi(d, hn::LoadU(d, x + k), s, c);
    hn::StoreU(s, d, sine + k);
    hn::StoreU(c, d, cosine + k);
  }
}

void SinCosRatio(const double* x, double divisor, double* sine, double* cosine, std::size_t count) {
  const Lanes d;
  for (std::size_t k = 0; k < count; k += hn::Lanes(d)) {
    hn::Vec<Lanes> s, c;
    sin_cos_pi_ratio(d, hn::LoadU(d, x + k), hn::Set(d, divisor), hn::Set(d, 1 / divisor), s, c);
    hn::StoreU(s, d, sine + k);
    hn::StoreU(c, d, cosine + k);
  }
}

void Atan2(const double* y, const double* x, double* angle, std::size_t count) {
  const Lanes d;
  for (std::size_t k = 0; k < count; k += hn::Lanes(d))
    hn::StoreU(atan2_pi(d, hn::LoadU(d, y + k), hn::LoadU(d, x + k)), d, angle + k);
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "every_target.h"

namespace envmap {
namespace {

HWY_EXPORT(SinCos);
HWY_EXPORT(SinCosRatio);
HWY_EXPORT(Atan2);

using Real = long double;
const Real pi_long = std::acos(Real(-1));

// How far off, in units in the last place of the exact result.
double ulps(double found, Real exact) {
  const double rounded = double(exact);
  const double least = std::numeric_limits<double>::denorm_min();
  const double unit = std::max(std::abs(std::nextafter(rounded, 0.0) - rounded), least);
  return double(std::abs(found - exact) / unit);
}

// x is taken to [-1/4,1/4] first, where long double's pi x is good to a few units of its own.
Real exact_sin_pi(Real x) {
  const Real k = std::nearbyint(2 * x), r = (x - k / 2) * pi_long;
  switch (static_cast<long long>(k) & 3) {
    case 0: return std::sin(r);
    case 1: return std::cos(r);
    case 2: return -std::sin(r);
    default: return -std::cos(r);
  }
}

void fill_up(std::vector<double>& values) { values.resize((values.size() + 15) / 16 * 16, 1); }

std::vector<double> angles() {
  std::vector<double> x;
  for (int k = -4000; k <= 4000; ++k) x.push_back(k / 1000.0);
  for (double tiny = 1; tiny > 0; tiny /= 7)
    for (const double quarter : {0.0, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0})
      for (const double sign : {1.0, -1.0}) x.push_back(quarter + sign * tiny), x.push_back(-quarter + sign * tiny);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> any(-2, 2), far(-1e9, 1e9);
  for (int k = 0; k < 200000; ++k) x.push_back(any(random));
  for (int k = 0; k < 1000; ++k) x.push_back(far(random));
  fill_up(x);
  return x;
}

TEST(Trigonometry, SineAndCosineWithinTwoUlp) {
  const std::vector<double> x = angles();
  on_every_target([&](const char* target) {
    std::vector<double> s(x.size()), c(x.size());
    HWY_DYNAMIC_DISPATCH(SinCos)(x.data(), s.data(), c.data(), x.size());
    double worst = 0;
    for (std::size_t k = 0; k < x.size(); ++k) {
      const Real sine = exact_sin_pi(x[k]), cosine = exact_sin_pi(Real(x[k]) + Real(0.5));
      ASSERT_LE(std::max(std::abs(s[k]), std::abs(c[k])), 1);
      worst = std::max({worst, ulps(s[k], sine), ulps(c[k], cosine)});
    }
    EXPECT_LT(worst, 2) << target;
    RecordProperty(std::string("ulps_") + target, std::to_string(worst));
  });
}

TEST(Trigonometry, QuartersAreExact) {
  std::vector<double> x{0, 0.5, 1, 1.5, 2, -0.5, -1, -1.5, -2, 1e6, 1e6 + 0.5};
  const std::vector<double> sines{0, 1, 0, -1, 0, -1, 0, 1, 0, 0, 1}, cosines{1, 0, -1, 0, 1, 0, -1, 0, 1, 1, 0};
  fill_up(x);
  on_every_target([&](const char* target) {
    std::vector<double> s(x.size()), c(x.size());
    HWY_DYNAMIC_DISPATCH(SinCos)(x.data(), s.data(), c.data(), x.size());
    for (std::size_t k = 0; k < sines.size(); ++k) {
      EXPECT_EQ(s[k], sines[k]) << target << x[k];
      EXPECT_EQ(c[k], cosines[k]) << target << x[k];
    }
  });
}

// The centres of texels: sin(pi a / n), relative to itself even beside a multiple of pi.
TEST(Trigonometry, RatiosOfWholeNumbersWithinTwoAndAHalfUlp) {
  on_every_target([&](const char* target) {
    double worst = 0;
    for (const int n : {1, 3, 7, 1000, 4096, 32767, 32768}) {
      std::vector<double> a;
      for (int k = -n; k <= n; k += std::max(1, n / 5000)) a.push_back(k);
      for (int k = 0; k < std::min(n, 20); ++k) a.push_back(n - k - 0.5), a.push_back(0.5 * n + k + 0.5);
      fill_up(a);
      std::vector<double> s(a.size()), c(a.size());
      HWY_DYNAMIC_DISPATCH(SinCosRatio)(a.data(), n, s.data(), c.data(), a.size());
      for (std::size_t k = 0; k < a.size(); ++k) {
        // Reduced in whole numbers here as well.
        const Real quarters = std::nearbyint(2 * a[k] / n), r = (2 * Real(a[k]) - quarters * n) / (2 * Real(n));
        const Real sine = exact_sin_pi(r), cosine = std::cos(r * pi_long);
        const Real turned[4][2] = {{sine, cosine}, {cosine, -sine}, {-sine, -cosine}, {-cosine, sine}};
        const auto& exact = turned[static_cast<long long>(quarters) & 3];
        worst = std::max({worst, ulps(s[k], exact[0]), ulps(c[k], exact[1])});
        ASSERT_LT(worst, 2.5) << target << " " << a[k] << "/" << n;
      }
    }
    RecordProperty(std::string("ulps_") + target, std::to_string(worst));
  });
}

struct Points {
  std::vector<double> y, x;
};

Points points() {
  std::vector<double> some{0.0, -0.0,     5e-324, 1e-310, 2.2e-308, 1e-200, 1e-30, 1e-16,
                           0.1, 5.0 / 12, 0.5,    1,      2,        1e30,   1e306};
  for (std::size_t k = 0, n = some.size(); k < n; ++k) {
    some.push_back(-some[k]);
    some.push_back(std::nextafter(some[k], 1.0));
  }
  Points p;
  for (const double y : some)
    for (const double x : some) p.y.push_back(y), p.x.push_back(x);
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> turn(-1, 1);
  for (int k = 0; k < 200000; ++k) {
    const double angle = turn(random) * 3.2;
    p.y.push_back(std::sin(angle)), p.x.push_back(std::cos(angle));
  }
  for (double tiny = 1; tiny > 0; tiny /= 3)
    for (const double sign : {1.0, -1.0}) {
      p.y.insert(p.y.end(), {tiny, sign});
      p.x.insert(p.x.end(), {sign, tiny});
    }
  fill_up(p.y), fill_up(p.x);
  return p;
}

TEST(Trigonometry, ArctangentWithinTwoUlp) {
  const Points p = points();
  on_every_target([&](const char* target) {
    std::vector<double> angle(p.x.size());
    HWY_DYNAMIC_DISPATCH(Atan2)(p.y.data(), p.x.data(), angle.data(), p.x.size());
    double worst = 0;
    for (std::size_t k = 0; k < p.x.size(); ++k) {
      const Real exact = std::atan2(Real(p.y[k]), Real(p.x[k])) / pi_long;
      ASSERT_TRUE(std::isfinite(angle[k])) << p.y[k] << " " << p.x[k];
      ASSERT_EQ(std::signbit(angle[k]), std::signbit(p.y[k])) << p.y[k] << " " << p.x[k];
      const double off = ulps(angle[k], exact);
      ASSERT_LT(off, 2) << target << " " << p.y[k] << " " << p.x[k];
      worst = std::max(worst, off);
    }
    RecordProperty(std::string("ulps_") + target, std::to_string(worst));
  });
}

TEST(Trigonometry, SameBitsOnEveryTarget) {
  const std::vector<double> x = angles();
  const Points p = points();
  std::vector<double> first;
  on_every_target([&](const char* target) {
    std::vector<double> all(2 * x.size() + p.x.size());
    HWY_DYNAMIC_DISPATCH(SinCos)(x.data(), all.data(), all.data() + x.size(), x.size());
    HWY_DYNAMIC_DISPATCH(Atan2)(p.y.data(), p.x.data(), all.data() + 2 * x.size(), p.x.size());
    if (first.empty()) first = all;
    EXPECT_TRUE(std::equal(all.begin(), all.end(), first.begin())) << target;
  });
}

}  // namespace
}  // namespace envmap
#endif  // HWY_ONCE

#include <gtest/gtest.h>

#include <cmath>

#include "envmap/maths/compensated_sum.h"
#include "envmap/maths/quadrature.h"
#include "envmap/maths/vector.h"

namespace envmap::maths_test {
namespace {

TEST(CompensatedSum, KeepsSmallTermsBesideLargeOnes) {
  CompensatedSum sum;
  sum.add(1e16);
  for (int k = 0; k < 1000; ++k) sum.add(1);
  sum.add(-1e16);
  EXPECT_EQ(sum.value(), 1000);
}

TEST(CompensatedSum, OfSums) {
  CompensatedSum a, b;
  a.add(1e16);
  a.add(1);
  b.add(-1e16);
  b.add(1);
  a.add(b);
  EXPECT_EQ(a.value(), 2);
}

TEST(GaussLegendre, IntegratesPolynomialsExactly) {
  // Degree 2N-1 = 5; the integral of x^4 over [0,2] is 32/5, that of x^5 is 64/6.
  EXPECT_NEAR(quadrature::line<3>(0, 2, [](double x) { return x * x * x * x; }), 32.0 / 5, 1e-14);
  EXPECT_NEAR(quadrature::line<3>(0, 2, [](double x) { return x * x * x * x * x; }), 64.0 / 6, 1e-14);
  EXPECT_NEAR(quadrature::line<12>(0, pi, [](double x) { return std::sin(x); }), 2, 1e-15);
}

TEST(InsideDisc, CutsCirclesExactly) {
  const auto one = [](double, double) { return 1.0; };
  EXPECT_NEAR(quadrature::inside_disc({-1, -1, 1, 1}, one), pi, 1e-14);
  EXPECT_NEAR(quadrature::inside_disc({0, 0, 1, 1}, one), pi / 4, 1e-15);
  // The segment right of x = 0.9: acos(h) - h sqrt(1 - h^2).
  EXPECT_NEAR(quadrature::inside_disc({0.9, -1, 1, 1}, one), std::acos(0.9) - 0.9 * std::sqrt(1 - 0.81), 1e-15);
  // The segment above y = 0.9, where the rim is level.
  EXPECT_NEAR(quadrature::inside_disc({-1, 0.9, 1, 1}, one), std::acos(0.9) - 0.9 * std::sqrt(1 - 0.81), 1e-15);
  EXPECT_EQ(quadrature::inside_disc({0.8, 0.8, 1, 1}, one), 0);
}

TEST(Rotation, TurnsAreRightHanded) {
  const auto near = [](const Direction& a, const Direction& b) { return glm::length(a - b) < 1e-15; };
  EXPECT_TRUE(near(rotation(90, 0, 0) * Direction(0, 0, 1), {1, 0, 0}));
  EXPECT_TRUE(near(rotation(0, 90, 0) * Direction(0, 1, 0), {0, 0, 1}));
  EXPECT_TRUE(near(rotation(0, 0, 90) * Direction(1, 0, 0), {0, 1, 0}));
  // Roll first, then pitch, then yaw.
  EXPECT_TRUE(near(rotation(90, 90, 90) * Direction(1, 0, 0), {1, 0, 0}));
}

TEST(Rotation, QuarterTurnsAreExact) {
  for (const double turn : {-270.0, -90.0, 90.0, 180.0, 360.0, 450.0})
    for (int column = 0; column < 3; ++column)
      for (int row = 0; row < 3; ++row) {
        const double x = rotation(turn, 0, 0)[column][row];
        EXPECT_TRUE(x == 0 || x == 1 || x == -1) << turn;
      }
}

TEST(AngleBetween, KeepsTinyAngles) {
  EXPECT_NEAR(angle_between({0, 0, 1}, {1e-10, 0, 1}), 1e-10, 1e-20);
  EXPECT_NEAR(angle_between({0, 0, 1}, {0, 0, -1}), pi, 1e-15);
}

}  // namespace
}  // namespace envmap::maths_test

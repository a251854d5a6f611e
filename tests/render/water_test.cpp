// The water of samples/water: what springs keep, and light at its surface.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "basin.h"

namespace {

using namespace water;

TEST(Water, VolumeStaysAndEnergyDoesNotDrift) {
  constexpr double stiffness = 0.12;
  HeightField field(48, 31);
  field.drop(10, 12, 3, 1);
  field.drop(40, 3, 2, -0.5);
  EXPECT_NEAR(field.volume(), 0, 1e-12);
  const double first = field.energy(stiffness);
  double least = first, most = first;
  for (int k = 0; k < 5000; ++k) {
    field.step(stiffness);
    least = std::min(least, field.energy(stiffness));
    most = std::max(most, field.energy(stiffness));
  }
  EXPECT_NEAR(field.volume(), 0, 1e-9);
  EXPECT_GT(least, 0.85 * first);
  EXPECT_LT(most, 1.15 * first);
  for (int k = 0; k < 3000; ++k) field.step(stiffness, 0.99);
  EXPECT_LT(field.energy(stiffness), 1e-6 * first);
  EXPECT_NEAR(field.volume(), 0, 1e-9);
}

// A straight wave of one cosine. A column has two springs along it and four across corners: it is pulled back with
// (1 + sqrt 2) (2 - 2 cos q) x stiffness of its height, q = pi / columns.
TEST(Water, AWaveIsPulledBackAsTheSpringsSay) {
  constexpr int columns = 40;
  constexpr double stiffness = 0.1, q = std::numbers::pi / columns;
  HeightField field(columns, 3);
  for (int i = 0; i < columns; ++i) field.raise(i, std::cos(q * (i + 0.5)));
  field.step(stiffness);
  const double pull = (1 + std::numbers::sqrt2) * (2 - 2 * std::cos(q)) * stiffness;
  for (int i = 0; i < columns; ++i) EXPECT_NEAR(field.height(i, 1), (1 - pull) * std::cos(q * (i + 0.5)), 1e-12);
}

TEST(Water, FresnelAndCaustics) {
  EXPECT_NEAR(fresnel(1, 0.75), std::pow(0.25 / 1.75, 2), 1e-12);
  EXPECT_NEAR(fresnel(1e-9, 0.75), 1, 1e-6);
  // At Brewster's angle, tan = n, only light across the plane is reflected: half of ((n^2 - 1) / (n^2 + 1))^2.
  const double n2 = 1 / (0.75 * 0.75), brewster = std::cos(std::atan(1 / 0.75));
  EXPECT_NEAR(fresnel(brewster, 0.75), 0.5 * std::pow((n2 - 1) / (n2 + 1), 2), 1e-12);
  EXPECT_EQ(fresnel(0.1, 1.333), 1) << "from below";

  HeightField field(64, 40);
  const Basin basin;
  for (const float light : caustics(basin, field, {0, 1, 0})) ASSERT_NEAR(light, 1, 1e-5);
  field.drop(30, 20, 4, 0.05);
  double sum = 0, most = 0;
  for (const float light : caustics(basin, field, {0, 1, 0})) sum += light, most = std::max<double>(most, light);
  EXPECT_NEAR(sum, 64 * 40, 1e-2) << "light is moved, not made";
  EXPECT_GT(most, 1.1);
}

}  // namespace

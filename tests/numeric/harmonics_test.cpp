// Spherical harmonics against the generator's own formula, closed forms and each other.
#include "envmap/prefilter/harmonics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "envmap/operate/generate.h"
#include "envmap/operate/measure.h"
#include "envmap/prefilter/harmonics_window.h"
#include "envmap/prefilter/prefilter.h"

namespace envmap::harmonics_test {
namespace {

TEST(Harmonics, AreTheBasisThatGenerateDraws) {
  for (const Direction& d :
       {Direction(0, 1, 0), Direction(0, -1, 0), Direction(1, 0, 0), glm::normalize(Direction(1, -2, 3))}) {
    std::vector<double> y(31 * 31);
    harmonics_at(30, d, y);
    for (int l = 0; l <= 30; ++l)
      for (int m = -l; m <= l; ++m)
        EXPECT_NEAR(y[l * (l + 1) + m], real_harmonic(l, m, d), 1e-11) << l << " " << m;
  }
}

TEST(Harmonics, FirstNineAreThePolynomialsStated) {
  const Direction d = glm::normalize(Direction(0.3, -0.5, 0.8));
  std::vector<double> y(9);
  harmonics_at(2, d, y);
  const double truth[] = {0.282095,
                          0.488603 * d.x,
                          0.488603 * d.y,
                          0.488603 * d.z,
                          1.092548 * d.x * d.z,
                          1.092548 * d.x * d.y,
                          0.315392 * (3 * d.y * d.y - 1),
                          1.092548 * d.y * d.z,
                          0.546274 * (d.z * d.z - d.x * d.x)};
  for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(y[k], truth[k], 1e-6) << k;
}

class EachHarmonics : public testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(, EachHarmonics, testing::ValuesIn(all_projections),
                         [](const auto& p) { return identifier(p.param); });

TEST_P(EachHarmonics, ComeBackFromAMapOfOne) {
  for (const auto& [degree, order] : {std::pair{1, 0}, {2, -1}, {3, 3}}) {
    const Forward forward = has_forward(GetParam()) ? Forward::plus_x : Forward::plus_z;
    // The last texel before the rim of a sphere map reaches from 163 degrees to 180; of twice as many, from 168.
    const int size = GetParam() == Projection::sphere ? 192 : 96;
    const EnvironmentMap map = generate(Harmonic{degree, order, 1, 0.5}, {GetParam(), forward}, size);
    const Harmonics h = project(map, 4);
    for (int l = 0; l <= 4; ++l)
      for (int m = -l; m <= l; ++m) {
        const double truth = l == 0 ? std::sqrt(4 * pi) : l == degree && m == order ? 0.5 : 0;
        EXPECT_NEAR(h.coefficients[l * (l + 1) + m].x, truth, 4e-3) << l << " " << m;
      }
    const EnvironmentMap drawn = evaluate(h, GetParam(), 24, forward);
    EXPECT_LT(
        compare(drawn.base(), generate(Harmonic{degree, order, 1, 0.5}, {GetParam(), forward}, 24).base()).maximum,
        2e-2);
  }
}

// By the formula of generate, over a fine grid. Longitude rises from +Z to +X, and to the left in the image.
TEST(Harmonics, OfOneTexelOfALatlongMapAreItsIntegrals) {
  constexpr int height = 9, i = 5, row = 2, steps = 200, order = 4;
  EnvironmentMap map;
  map.levels.emplace_back(Projection::latlong, height);
  map.forward = Forward::minus_x;
  *map.base().texel(0, i, row) = Colour(1, 2, 3);
  const Harmonics h = project(map, order);
  std::vector<double> wanted((order + 1) * (order + 1), 0);
  for (int a = 0; a < steps; ++a)
    for (int b = 0; b < steps; ++b) {
      const double u = (i + (a + 0.5) / steps) / (2 * height), v = (row + (b + 0.5) / steps) / height;
      const double longitude = -pi / 2 + pi * (1 - 2 * u), latitude = pi * (0.5 - v);
      const double solid_angle = std::cos(latitude) * std::pow(pi / height / steps, 2);
      const Direction d(std::cos(latitude) * std::sin(longitude), std::sin(latitude),
                        std::cos(latitude) * std::cos(longitude));
      for (int l = 0; l <= order; ++l)
        for (int m = -l; m <= l; ++m) wanted[l * (l + 1) + m] += solid_angle * real_harmonic(l, m, d);
    }
  for (std::size_t k = 0; k < wanted.size(); ++k)
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(h.coefficients[k][c], (c + 1) * wanted[k], 1e-6) << k;
}

TEST(Harmonics, OfAWhiteMapAreExact) {
  for (const Projection p : all_projections) {
    const Harmonics h = project(generate(Constant{Direction(1)}, p, 5), 6);
    EXPECT_NEAR(h.coefficients[0].x, std::sqrt(4 * pi), 1e-6) << name(p);
    for (std::size_t k = 1; k < h.coefficients.size(); ++k)
      EXPECT_NEAR(h.coefficients[k].x, 0, 1e-6) << name(p) << " " << k;
  }
}

TEST(Harmonics, IrradianceFactorsAreThoseOfThePaperAndOfTheLobe) {
  const std::vector<double> a = irradiance_factors(8), z = zonal(Lobe::diffuse(), 8);
  const double truth[] = {pi, 2 * pi / 3, pi / 4, 0, -pi / 24, 0, pi / 64};
  for (std::size_t k = 0; k < 7; ++k) EXPECT_NEAR(a[k], truth[k], 1e-12) << k;
  for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(a[k], pi * z[k], 1e-9) << k;
}

TEST(Harmonics, ZonalFactorsOfPhong) {
  // Of cos^m: 1, (m+1)/(m+2), and for P_2 (3 (m+1)/(m+3) - 1) / 2.
  for (const double m : {0.0, 0.5, 5.0, 1e3, 1e6}) {
    const std::vector<double> z = zonal(Lobe::phong(m), 2);
    EXPECT_NEAR(z[0], 1, 1e-9) << m;
    EXPECT_NEAR(z[1], (m + 1) / (m + 2), 1e-9) << m;
    EXPECT_NEAR(z[2], (3 * (m + 1) / (m + 3) - 1) / 2, 1e-9) << m;
  }
  for (const double r : {0.0, 0.1, 0.5, 0.99, 1.0}) EXPECT_NEAR(zonal(Lobe::ggx(r), 2)[0], 1, 1e-6) << r;
}

TEST(Harmonics, WindowsLeaveTheMean) {
  const std::vector<double> w = hann_window(4);
  EXPECT_EQ(w[0], 1);
  for (std::size_t k = 1; k < 5; ++k) EXPECT_LT(w[k], w[k - 1]);
}

// The lowest irradiance of 50,000 evenly spread directions (a Fibonacci lattice), of any channel.
double lowest_irradiance(Harmonics h, const std::vector<double>& window) {
  scale_degrees(h, window);
  scale_degrees(h, irradiance_factors(h.order));
  constexpr int count = 50000;
  double least = 1e300;
  for (int k = 0; k < count; ++k) {
    const double y = 1 - (2 * k + 1.0) / count, s = std::sqrt(1 - y * y),
                 turn = 2 * pi * std::fmod(k * 0.6180339887498949, 1);
    const Flux e = evaluate(h, Direction(s * std::sin(turn), y, s * std::cos(turn)));
    least = std::min({least, e.x, e.y, e.z});
  }
  return least;
}

TEST(Harmonics, TheWeakestWindowLeavesNoNegativeIrradianceAndIsNoStronger) {
  EnvironmentMap map = generate(Constant{Direction(0.02)}, Projection::latlong, 32);
  *map.base().texel(0, 13, 7) = Colour(5000, 4000, 3000);
  *map.base().texel(0, 40, 20) = Colour(0, 0, 700);
  for (const int order : {2, 4, 9}) {
    const Harmonics h = project(map, order);
    EXPECT_LT(lowest_irradiance(h, laplacian_window(order, 0)), 0) << order;
    const Deringing found = weakest_window(h);
    const double mean = h.coefficients[0].z * std::sqrt(pi) / 2;
    EXPECT_GE(lowest_irradiance(h, laplacian_window(order, found.lambda)), -1e-12 * mean) << order;
    EXPECT_LT(lowest_irradiance(h, laplacian_window(order, 0.99 * found.lambda)), 0) << order;
    EXPECT_GT(found.rms, 0);
    EXPECT_LT(found.rms, 0.5);
    EXPECT_GT(found.maximum, found.rms);
  }
}

// Of light from one direction, at the cosine x: 1/4 + w1 x / 2 + 5/32 w2 (3 x^2 - 1),
// least at x = -8 w1 / (15 w2) or -1.
TEST(Harmonics, TheWeakestWindowOfOneLightIsThatOfTheClosedForm) {
  Harmonics h{2, std::vector<Flux>(9)};
  std::vector<double> y(9);
  harmonics_at(2, glm::normalize(Direction(1, 2, -3)), y);
  for (std::size_t k = 0; k < 9; ++k) h.coefficients[k] = Flux(y[k]);
  const Deringing found = weakest_window(h);
  const double w1 = 1 / (1 + 4 * found.lambda), w2 = 1 / (1 + 36 * found.lambda);
  const double x = std::max(-1.0, -8 * w1 / (15 * w2));
  EXPECT_GT(found.lambda, 0.01);
  EXPECT_NEAR(0.25 + w1 * x / 2 + 5 * w2 / 32 * (3 * x * x - 1), 0, 1e-6);
  // Parseval by hand: the norms of the degrees are 1/4, 1/2 and 5/16 over sqrt(2l + 1).
  const double lost = (1 - w1) * (1 - w1) / 12 + (1 - w2) * (1 - w2) * 5 / 256, whole = 1.0 / 16 + 1.0 / 12 + 5.0 / 256;
  EXPECT_NEAR(found.rms, std::sqrt(lost / whole), 1e-9);
}

TEST(Harmonics, ASoftEnvironmentNeedsNoWindow) {
  const Deringing found = weakest_window(project(generate(Harmonic{1, 0, 1, 0.5}, Projection::cube, 16), 3));
  EXPECT_EQ(found.lambda, 0);
  EXPECT_EQ(found.rms, 0);
}

TEST(Harmonics, IsTheDiffuseMapOfASoftEnvironment) {
  const EnvironmentMap map = generate(Harmonic{2, 1, 1, 0.5}, Projection::cube, 64);
  Harmonics h = project(map, 4);
  scale_degrees(h, zonal(Lobe::diffuse(), 4));
  const EnvironmentMap series = evaluate(h, Projection::cube, 8, Forward::plus_z);
  const Prefiltered tree = Prefilterer(map).make({.size = 8, .max_error = 1e-4});
  EXPECT_LT(compare(series.base(), tree.map.base()).maximum, 1e-3);
}

}  // namespace
}  // namespace envmap::harmonics_test

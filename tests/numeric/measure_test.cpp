// Facts and metrics on maps whose answers are known by hand.
#include "envmap/operate/measure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "envmap/base/error.h"
#include "envmap/operate/generate.h"
#include "envmap/operate/sampling.h"
#include "envmap/projection/visit.h"

namespace envmap::measure_test {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinite = std::numeric_limits<float>::infinity();

EnvironmentMap grey(Projection p, int size) { return generate(Constant{}, p, size); }

TEST(Measure, FluxOfAConstantIsFourPi) {
  for (const Projection p : all_projections)
    for (const int size : {1, 2, 5, 100}) EXPECT_NEAR(measure(grey(p, size)).flux.y, 4 * pi, 1e-11) << name(p) << size;
}

TEST(Measure, OneTexel) {
  EnvironmentMap map = grey(Projection::latlong, 4);
  *map.base().texel(0, 3, 1) = Colour(5, 1, 0.25F);
  const double w = Latlong::solid_angle({3 / 8.0, 1 / 4.0, 4 / 8.0, 2 / 4.0});
  const Measures m = measure(map);
  EXPECT_NEAR(m.flux.x, 4 * pi + 4 * w, 1e-12);
  EXPECT_NEAR(m.flux.z, 4 * pi - 0.75 * w, 1e-12);
  EXPECT_EQ(m.maximum.x, 5);
  EXPECT_EQ(m.minimum.z, 0.25);
  EXPECT_EQ(m.brightest_texel.i, 3);
  EXPECT_EQ(m.brightest_texel.j, 1);
  EXPECT_NEAR(m.brightest, 0.2126 * 5 + 0.7152 + 0.0722 * 0.25, 1e-6);
}

// Levels halve each side of a latlong map and round it down: 90x45 has one of 45x22.
TEST(Measure, AllColumnsOfALevelOfOddWidthCount) {
  EnvironmentMap map;
  map.levels.emplace_back(Projection::latlong, 22, 45);
  for (const int row : {10, 11}) *map.base().texel(0, 44, row) = Colour(1);
  const Measures m = measure(map);
  EXPECT_EQ(m.brightest_texel.i, 44);
  EXPECT_EQ(m.brightest_texels, 2);
  EXPECT_EQ(std::ssize(texels_of(map.base())), 22 * 45);
}

double degrees_between(const Direction& a, const Direction& b) {
  return 180 / pi * std::acos(std::min(1.0, glm::dot(a, b)));
}

// A disc of equal texels round each direction, over edges, corners, seams and poles.
TEST(Measure, TheBrightestOfAClippedLightIsItsMiddle) {
  for (const Projection p : all_projections)
    for (const Direction& towards : {Direction(1, 1, 1), Direction(0, 1, 0.01), Direction(0.02, 0.3, -1)}) {
      const Direction middle = glm::normalize(towards);
      EnvironmentMap map = generate(Sun{middle, 12, Rgb<double>(50), {Rgb<double>(0.5), Rgb<double>(0.5)}}, p, 64);
      std::int64_t clipped = 0;
      for (const Texel& t : texels_of(map.base()))
        if (Colour& c = *map.base().texel(t.face, t.i, t.j); c.x > 4) c = Colour(4), ++clipped;
      const Measures m = measure(map);
      // Next to a rim texels span degrees.
      EXPECT_LT(degrees_between(m.brightest_direction, middle), on_disc(p) ? 2.5 : 1)
          << name(p) << " " << towards.x << "," << towards.y << "," << towards.z;
      EXPECT_GT(m.brightest_texels, 20) << name(p);
      EXPECT_LE(m.brightest_texels, clipped) << name(p);
      EXPECT_EQ(m.brightest_value, Colour(4));
    }
}

// Their solid angle is 0: they repeat the other half, or hold anything.
TEST(Measure, CornersOfAParaboloidMapDoNotCount) {
  const Direction towards = glm::normalize(Direction(1, 1, 0));
  EnvironmentMap map =
      generate(Sun{.towards = towards, .radius_degrees = 10, .radiance = Flux(100)}, Projection::paraboloid, 64);
  EXPECT_LT(degrees_between(measure(map).brightest_direction, towards), 0.5);
  *map.base().texel(0, 0, 0) = Colour(1000);
  EXPECT_EQ(measure(map).maximum.x, 100);
  EXPECT_EQ(measure(map).brightest_value, Colour(100));
}

TEST(Measure, OfTwoClippedLightsTheLargerCounts) {
  EnvironmentMap map = grey(Projection::latlong, 32);
  for (int j = 8; j < 11; ++j)
    for (int i = 62; i < 66; ++i) *map.base().texel(0, i % 64, j) = Colour(9);  // Over the seam.
  for (int j = 20; j < 23; ++j)
    for (int i = 30; i < 33; ++i) *map.base().texel(0, i, j) = Colour(9);
  const Measures m = measure(map);
  EXPECT_EQ(m.brightest_texels, 12);
  const double latitude = 0.5 * pi - 9.5 / 32 * pi;
  EXPECT_LT(degrees_between(m.brightest_direction, Direction(0, std::sin(latitude), -std::cos(latitude))), 0.3);
}

TEST(Measure, AConstantMapHasABrightestTexel) {
  const Measures m = measure(grey(Projection::cube, 8));
  EXPECT_EQ(m.brightest_texels, 384);
  EXPECT_NEAR(glm::length(m.brightest_direction), 1, 1e-12);
}

TEST(Flaws, AreCountedByKindAndTheFirstIsNamed) {
  EnvironmentMap map = grey(Projection::cube, 4);
  *map.base().texel(2, 1, 3) = Colour(1, nan, 1);
  *map.base().texel(2, 2, 3) = Colour(-1, infinite, 1);
  *map.base().texel(4, 0, 0) = Colour(1, 1, -1e-30F);
  const Flaws flaws = find_flaws(map.base());
  EXPECT_EQ(flaws.nan, 1);
  EXPECT_EQ(flaws.infinite, 1);
  EXPECT_EQ(flaws.negative, 1);
  EXPECT_EQ(flaws.first->face, 2);
  EXPECT_EQ(flaws.first->i, 1);
  EXPECT_EQ(flaws.first->j, 3);
}

TEST(Flaws, OutsideTheDiscDoNotCount) {
  EnvironmentMap map = grey(Projection::sphere, 32);
  *map.base().texel(0, 0, 0) = Colour(nan);
  EXPECT_EQ(find_flaws(map.base()).count(), 0);
}

TEST(Repair, TakesTheMeanOfSoundNeighbours) {
  EnvironmentMap map = generate(Gradient{Direction(0), Direction(2)}, Projection::latlong, 16);
  const double truth = map.base().texel(0, 5, 7)->x;
  for (int j = 6; j <= 8; ++j)
    for (int i = 4; i <= 6; ++i) *map.base().texel(0, i, j) = Colour(nan);
  *map.base().texel(0, 20, 3) = Colour(0.5F, -2, infinite);
  *map.base().texel(0, 25, 3) = Colour(0.5F, -2, 1);
  EXPECT_EQ(repair(map.base()), 11);
  EXPECT_EQ(find_flaws(map.base()).count(), 0);
  EXPECT_NEAR(map.base().texel(0, 5, 7)->x, truth, 0.02);
  EXPECT_EQ(*map.base().texel(0, 25, 3), Colour(0.5F, 0, 1));
}

// A file of a few bytes can hold it; looking at every hole for every ring would take a minute.
TEST(Repair, SpreadsOneSoundTexelOverAMapWithoutAnotherInNoTime) {
  EnvironmentMap map = grey(Projection::latlong, 1024);
  for (int j = 0; j < 1024; ++j)
    for (Colour& c : map.base().row(0, j)) c = Colour(nan);
  *map.base().texel(0, 3, 1000) = Colour(1, 2, 3);
  EXPECT_EQ(repair(map.base()), 2048 * 1024 - 1);
  EXPECT_EQ(find_flaws(map.base()).count(), 0);
  EXPECT_EQ(*map.base().texel(0, 2047, 0), Colour(1, 2, 3));
}

TEST(Repair, NeedsASoundTexel) {
  EnvironmentMap map = grey(Projection::latlong, 2);
  for (int j = 0; j < 2; ++j)
    for (Colour& c : map.base().row(0, j)) c = Colour(nan);
  EXPECT_THROW(repair(map.base()), InputError);
}

TEST(Compare, MetricsOfAKnownDifference) {
  EnvironmentMap b = grey(Projection::latlong, 4), a = grey(Projection::latlong, 4);
  const double w = Latlong::solid_angle({2 / 8.0, 0, 3 / 8.0, 1 / 4.0});
  *a.base().texel(0, 2, 0) = Colour(1, 3, 1);
  const Difference d = compare(a.base(), b.base());
  EXPECT_EQ(d.flux.x, 0);
  EXPECT_NEAR(d.flux.y, 2 * w / (4 * pi), 1e-12);
  EXPECT_NEAR(d.rms, std::sqrt(4 * w / (3 * 4 * pi)), 1e-12);
  EXPECT_NEAR(d.maximum, 2, 1e-12);
  EXPECT_EQ(d.worst.i, 2);
  EXPECT_EQ(d.worst.j, 0);
  // The other way round the reference is larger there.
  EXPECT_NEAR(compare(b.base(), a.base()).maximum, 2.0 / 3, 1e-7);
}

TEST(Compare, DarkTexelsAreMeasuredAgainstTheMean) {
  EnvironmentMap b = grey(Projection::latlong, 64), a = grey(Projection::latlong, 64);
  *b.base().texel(0, 0, 0) = Colour(0);
  *a.base().texel(0, 0, 0) = Colour(1e-4F);
  EXPECT_NEAR(compare(a.base(), b.base()).maximum, 0.1, 1e-4);
}

TEST(Compare, BlackMapsAgreeAndLightAgainstBlackIsInfinite) {
  EnvironmentMap black = generate(Constant{Direction(0)}, Projection::cube, 2), a = grey(Projection::cube, 2);
  EXPECT_EQ(compare(black.base(), black.base()).rms, 0);
  EXPECT_EQ(compare(black.base(), black.base()).maximum, 0);
  EXPECT_TRUE(std::isinf(compare(a.base(), black.base()).maximum));
}

TEST(Sampling, KnownDensities) {
  const auto sphere = sampling_table(Projection::sphere, 512);
  EXPECT_NEAR(sphere.front().relative, 1, 1e-9);  // Equal-area ...
  EXPECT_NEAR(sphere[4].relative, 1, 1e-9);
  EXPECT_GT(sphere.back().anisotropy, 50);  // ... but stretched at the rim.
  const auto cube = sampling_table(Projection::cube, 1024);
  EXPECT_NEAR(cube.front().solid_angle / cube.back().solid_angle, std::pow(3.0, 1.5), 0.02);
  EXPECT_NEAR(cube.back().anisotropy, std::sqrt(3.0), 0.01);
  EXPECT_NEAR(cube.back().angle, 54.7356, 0.2);
  const auto paraboloid = sampling_table(Projection::paraboloid, 1024);
  EXPECT_NEAR(paraboloid.front().anisotropy, 1, 1e-6);  // Conformal.
  EXPECT_NEAR(paraboloid[6].anisotropy, 1, 1e-6);
  const auto latlong = sampling_table(Projection::latlong, 1024);
  EXPECT_NEAR(latlong.front().anisotropy, 1, 1e-4);
  EXPECT_LT(latlong.back().relative, 1e-2);
}

}  // namespace
}  // namespace envmap::measure_test

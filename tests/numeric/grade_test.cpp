// What is done to light, against closed forms.
#include "envmap/operate/grade.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "envmap/base/error.h"
#include "envmap/operate/generate.h"

namespace envmap::grade_test {
namespace {

EnvironmentMap constant(const Frame& frame, int size, const Colour& colour) {
  EnvironmentMap map = blank_map(frame, size);
  for (int face = 0; face < map.base().faces(); ++face)
    for (int j = 0; j < map.base().height(); ++j)
      for (Colour& texel : map.base().row(face, j)) texel = colour;
  return map;
}

TEST(Irradiance, OfAConstantIsPiTimesIt) {
  for (const Projection p : all_projections)
    for (const int size : {1, 4, 37, 128}) {
      SCOPED_TRACE(std::string(name(p)) + " " + std::to_string(size));
      const EnvironmentMap map = constant(p, size, {1, 2, 4});
      for (const Direction& n : {Direction(0, 1, 0), glm::normalize(Direction(1, -2, 3))}) {
        const Flux e = irradiance(map, n);
        const double within = on_disc(p) ? 3e-3 : 4 * 1e-5;
        EXPECT_NEAR(e.x, pi, pi * within);
        EXPECT_NEAR(e.z, 4 * pi, 4 * pi * within);
      }
    }
}

TEST(Irradiance, LooksIntoTheWorld) {
  // Light from the half of +X alone: a plane that faces +X receives pi, one that faces +Z half of it,
  // one that faces -X none.
  for (const Forward forward : {Forward::plus_z, Forward::minus_z, Forward::plus_x}) {
    EnvironmentMap map = blank_map({Projection::latlong, forward}, 256);
    std::vector<Direction> d(512);
    for (int j = 0; j < 256; ++j) {
      texel_directions(Projection::latlong, 256, 0, j, 0, d);
      for (int i = 0; i < 512; ++i)
        if ((image_to_world(forward) * d[std::size_t(i)]).x > 0) *map.base().texel(0, i, j) = Colour(1);
    }
    EXPECT_NEAR(irradiance(map, {1, 0, 0}).x, pi, 1e-4);
    EXPECT_NEAR(irradiance(map, {0, 0, 1}).x, pi / 2, 1e-4);
    EXPECT_NEAR(irradiance(map, {-1, 0, 0}).x, 0, 1e-12);
    EXPECT_EQ(radiance_within(map, {1, 0, 0}, 1), Flux(1));
    EXPECT_EQ(radiance_within(map, {-1, 0, 0}, 1), Flux(0));
  }
}

TEST(Grade, KeepsLuminanceAndNeverFallsBelowZero) {
  const Flux y = luminance_weights(rec709);
  for (const double s : {0.0, 0.5, 2.0, 100.0}) {
    EnvironmentMap map = constant(Projection::cube, 2, {0.9F, 0.5F, 0.1F});
    apply({.saturation = s}, map.base());
    const Flux c(*map.base().texel(0, 0, 0));
    EXPECT_NEAR(glm::dot(c, y), glm::dot(Flux(0.9, 0.5, 0.1), y), 1e-6);
    EXPECT_GE(std::min({c.x, c.y, c.z}), 0);
    if (s == 0) {
      EXPECT_NEAR(c.x, c.z, 1e-7);
    }
    if (s == 0.5) {
      EXPECT_NEAR(c.x - c.z, 0.4, 1e-6);
    }
    if (s == 100) {
      EXPECT_NEAR(c.z, 0, 1e-7);
    }
  }
}

TEST(Grade, BringsColoursIntoTheGamut) {
  EnvironmentMap map = constant(Projection::cube, 1, {1, 0.5F, -0.25F});
  *map.base().texel(0, 0, 0) = Colour(1, 1, -1e-5F);
  *map.base().texel(1, 0, 0) = Colour(-1, 0, 0);
  const Flux y = luminance_weights(rec709);
  EXPECT_EQ(into_gamut(map.base(), y), 5);  // One is but rounded.
  const Flux c(*map.base().texel(2, 0, 0));
  EXPECT_NEAR(c.z, 0, 1e-7);
  EXPECT_NEAR(glm::dot(c, y), glm::dot(Flux(1, 0.5, -0.25), y), 1e-6);
  EXPECT_EQ(*map.base().texel(1, 0, 0), Colour(0));
}

TEST(WhiteBalance, MakesGrey) {
  const Flux y = luminance_weights(rec709), c(2, 1, 0.5), grey = c * white_balance(c, y);
  EXPECT_NEAR(grey.x, grey.y, 1e-12);
  EXPECT_NEAR(grey.x, grey.z, 1e-12);
  EXPECT_NEAR(glm::dot(grey, y), glm::dot(c, y), 1e-12);
  EXPECT_THROW((void)white_balance(Flux(1, 0, 1), y), UsageError);
  // At D65 next to nothing; light of a bulb is red, so that red falls and blue rises.
  const Flux day = white_balance(6504, rec709), bulb = white_balance(2856, rec709);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(day[k], 1, 0.07);
  EXPECT_LT(bulb.x, 0.8);
  EXPECT_GT(bulb.z, 2);
}

}  // namespace
}  // namespace envmap::grade_test

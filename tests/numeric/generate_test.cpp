// Generated environments against their analytic answers.
#include "envmap/operate/generate.h"

#include <gtest/gtest.h>

#include "envmap/base/error.h"
#include "envmap/operate/convert.h"
#include "envmap/operate/lookup.h"
#include "envmap/operate/measure.h"
#include "envmap/projection/matching_size.h"
#include "formulae.h"
#include "numeric/floor.h"

namespace envmap::generate_test {
namespace {

class EachGenerated : public testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(, EachGenerated, testing::ValuesIn(all_projections),
                         [](const auto& p) { return identifier(p.param); });

TEST_P(EachGenerated, OvercastSkyLightsAFloorBySevenNinthsPi) {
  const EnvironmentMap map = generate(Sky{.zenith = Rgb<double>(2), .ground = Rgb<double>(0.1)}, GetParam(), 256);
  EXPECT_NEAR(irradiance_of_floor(map.base()).x / (2 * 7 * pi / 9), 1, 3e-4);
}

// Of a floor: pi (horizon / 3 + 2 zenith / 3).
TEST_P(EachGenerated, AClearSkyRisesFromItsHorizon) {
  const EnvironmentMap map =
      generate(Sky{.zenith = {1, 2, 3}, .ground = Rgb<double>(9), .horizon = Rgb<double>(4, 2, 1)}, GetParam(), 256);
  EXPECT_NEAR(irradiance_of_floor(map.base()).x / (pi * (4.0 / 3 + 2.0 / 3)), 1, 1e-3);
  const Colour top = EnvironmentLookup(map)(Direction(0, 1, 0));
  EXPECT_NEAR(top.x, 1, 0.05);
  EXPECT_NEAR(top.z, 3, 0.05);
}

TEST_P(EachGenerated, GradientHasTheMeanOfItsEnds) {
  const EnvironmentMap map = generate(Gradient{{0.2, 1, 3}, {0.6, 2, 3}}, GetParam(), 128);
  const Measures m = measure(map);
  EXPECT_NEAR(m.mean.x, 0.4, 1e-5);
  EXPECT_NEAR(m.mean.y, 1.5, 1e-4);
  EXPECT_NEAR(m.mean.z, 3, 1e-6);
  EXPECT_NEAR(m.solid_angle, 4 * pi, 1e-11);
}

TEST_P(EachGenerated, SunHasItsFluxAtAnySizeAndPlace) {
  for (const double radius : {0.2666, 100.0})
    for (const int size : {1, 4, 33})
      for (const Direction towards : {Direction(0, 0, -1), Direction(0, 1, 0), glm::normalize(Direction(1, 1, 1))}) {
        const EnvironmentMap map =
            generate(Sun{towards, radius, Direction(1e4), {Rgb<double>(0), Rgb<double>(0)}}, GetParam(), size);
        const double flux = 2 * pi * (1 - std::cos(radius * pi / 180)) * 1e4;
        EXPECT_NEAR(measure(map).flux.x / flux, 1, 2e-3)
            << radius << " at " << size << " towards " << towards.x << "," << towards.y << "," << towards.z;
      }
}

// Texels outside a disc have no solid angle, so that flux does not tell. The sun covers less than half of any texel
// here.
TEST_P(EachGenerated, NoTexelHasMoreOfTheSunThanLiesInIt) {
  for (const int size : {3, 7, 9}) {
    const EnvironmentMap map = generate(Sun{.towards = {0, 1, 0}, .radius_degrees = 2}, GetParam(), size);
    for (int face = 0; face < map.base().faces(); ++face)
      for (int j = 0; j < size; ++j)
        for (const Colour& c : map.base().row(face, j)) EXPECT_LT(c.x, 5e4) << size << ", row " << j;
  }
}

TEST_P(EachGenerated, BrightestTexelIsWhereTheSunIs) {
  for (const Direction towards : {Direction(0, 0, 1), Direction(-1, 0, 0), glm::normalize(Direction(1, 2, 3)),
                                  glm::normalize(Direction(0.3, -1, -2))}) {
    const EnvironmentMap map =
        generate(Sun{.towards = towards, .radius_degrees = 3}, {GetParam(), Forward::minus_x}, 64);
    EXPECT_LT(angle_between(measure(map).brightest_direction, towards), 0.1);
  }
}

TEST_P(EachGenerated, DirectionsAreTheirCode) {
  const int size = 17;
  const EnvironmentMap map = generate(Directions{}, GetParam(), size);
  const Level& level = map.base();
  for (int f = 0; f < level.faces(); ++f)
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < level.width(); ++i)
        if (formulae::in_image(GetParam(), size, i, j)) {
          const auto d =
              formulae::rounded(formulae::direction(GetParam(), f, (i + 0.5L) / level.width(), (j + 0.5L) / size));
          EXPECT_LT(glm::length(Direction(*level.texel(f, i, j)) - 0.5 * (d + 1.0)), 1e-7);
        }
}

// Each face of the cube takes a sixth of the sphere: so much of it is red, and half of it holds red.
TEST_P(EachGenerated, FacesAreSixColours) {
  const EnvironmentMap map = generate(Faces{}, GetParam(), 96);
  const auto m = measure(map);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(m.mean[k], 0.5, 2e-3);
  const EnvironmentMap cube = generate(Faces{}, Projection::cube, 4);
  const Colour colours[] = {{1, 0, 0}, {0, 1, 1}, {0, 1, 0}, {1, 0, 1}, {0, 0, 1}, {1, 1, 0}};
  for (int face = 0; face < 6; ++face)
    for (int j = 0; j < 4; ++j)
      for (const Colour& c : cube.base().row(face, j)) EXPECT_EQ(c, colours[face]);
}

TEST_P(EachGenerated, CheckerIsHalfAndHalf) {
  const EnvironmentMap map = generate(Checker{.squares = 6, .even = Direction(1), .odd = Direction(0)}, GetParam(), 96);
  EXPECT_NEAR(measure(map).mean.x, 0.5, 3e-3);
}

// The harmonics by their polynomials (Sloan 2008, appendix A2, signs as documented, axes turned to +Y up).
TEST(Harmonic, LowDegreesAreThePolynomials) {
  for (const Direction d :
       {glm::normalize(Direction(1, 2, 3)), glm::normalize(Direction(-2, 0.5, 1)), Direction(0, 1, 0)}) {
    const double x = d.z, y = d.x, z = d.y;  // Sloan's axes: z polar, longitude from x to y.
    EXPECT_NEAR(real_harmonic(0, 0, d), std::sqrt(1 / (4 * pi)), 1e-15);
    EXPECT_NEAR(real_harmonic(1, 0, d), std::sqrt(3 / (4 * pi)) * z, 1e-15);
    EXPECT_NEAR(real_harmonic(1, 1, d), std::sqrt(3 / (4 * pi)) * x, 1e-15);
    EXPECT_NEAR(real_harmonic(1, -1, d), std::sqrt(3 / (4 * pi)) * y, 1e-15);
    EXPECT_NEAR(real_harmonic(2, 0, d), std::sqrt(5 / (16 * pi)) * (3 * z * z - 1), 1e-15);
    EXPECT_NEAR(real_harmonic(2, -2, d), std::sqrt(15 / (4 * pi)) * x * y, 1e-15);
    EXPECT_NEAR(real_harmonic(2, 1, d), std::sqrt(15 / (4 * pi)) * x * z, 1e-15);
    EXPECT_NEAR(real_harmonic(3, 2, d), std::sqrt(105 / (16 * pi)) * (x * x - y * y) * z, 2e-15);
    EXPECT_NEAR(real_harmonic(3, -3, d), std::sqrt(35 / (32 * pi)) * (3 * x * x - y * y) * y, 2e-15);
  }
}

// An environment of one harmonic keeps its values through every pair: checked by projecting the result on it.
TEST_P(EachGenerated, AnalyticHarmonicSurvivesConversion) {
  for (const Projection from : all_projections) {
    EnvironmentMap source =
        generate(Harmonic{.degree = 3, .order = 1}, from, matching_size(Projection::latlong, 128, from));
    const EnvironmentMap result = convert(source, {.to = GetParam(), .filter = Filter::bilinear});
    const Level& level = result.base();
    for (int f = 0; f < level.faces(); ++f)
      for (int j = 0; j < level.height(); ++j)
        for (int i = 0; i < level.width(); ++i)
          if (formulae::in_image(GetParam(), level.height(), i, j)) {
            const auto d = formulae::rounded(
                formulae::direction(GetParam(), f, (i + 0.5L) / level.width(), (j + 0.5L) / level.height()));
            const double truth = 1 + 0.5 * real_harmonic(3, 1, d);
            // The rim texels of a sphere map span 15 degrees: a cubic is not straight over those.
            // Nor is it over creases.
            const double bound = from == Projection::sphere ? 8e-2 : is_octahedral(from) ? 1.5e-2 : 1e-3;
            ASSERT_NEAR(level.texel(f, i, j)->x, truth, bound) << name(from);
          }
  }
}

}  // namespace
}  // namespace envmap::generate_test

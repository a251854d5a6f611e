// Pictures of maps against the plain formulae of lenses, and against the faces of a cube.
#include "envmap/operate/photograph.h"

#include <gtest/gtest.h>

#include <cmath>

#include "envmap/base/error.h"
#include "envmap/operate/generate.h"

namespace envmap::photograph_test {
namespace {

EnvironmentMap directions_map(Projection p, int size) { return generate(Directions{}, {p}, size); }

const Colour& pixel(const std::vector<Colour>& picture, const PhotographOptions& o, int i, int row) {
  return picture[std::size_t(row * o.width + i)];
}

// In degrees: how far the direction that a pixel of a picture of directions shows is from the one expected.
double off(const Colour& shown, const Direction& expected) {
  const Direction d = glm::normalize(2.0 * Direction(shown) - 1.0);
  return std::atan2(glm::length(glm::cross(d, expected)), glm::dot(d, expected)) * 180 / pi;
}

TEST(Photograph, ShowsTheFacesOfACube) {
  const int size = 16;
  const EnvironmentMap map = generate(Checker{.squares = 12}, {Projection::cube}, size);
  const struct {
    int face;
    Direction towards;
  } sides[]{{0, {1, 0, 0}}, {1, {-1, 0, 0}}, {4, {0, 0, 1}}, {5, {0, 0, -1}}};
  for (const auto& side : sides) {
    const PhotographOptions o{
        .field_radians = pi / 2, .width = size, .height = size, .towards = side.towards, .samples = 1};
    const std::vector<Colour> picture = photograph(map.clone(), o);
    for (int row = 0; row < size; ++row)
      for (int i = 0; i < size; ++i)
        ASSERT_NEAR(pixel(picture, o, i, row).x, map.base().texel(side.face, i, row)->x, 1e-6)
            << side.face << " " << i << " " << row;
  }
}

TEST(Photograph, PlacesInThePictureLookWhereTheLensSays) {
  // Towards +X: to the right lies +Z, above +Y.
  for (const Projection p : {Projection::latlong, Projection::cube, Projection::angular}) {
    const EnvironmentMap map = directions_map(p, 256);
    PhotographOptions o{.width = 41, .height = 31, .towards = {2, 0, 0}, .samples = 1};
    const auto shown = [&](int i, int row) { return pixel(photograph(map.clone(), o), o, i, row); };
    o.lens = CameraModel::perspective, o.field_radians = pi / 2;
    EXPECT_LT(off(shown(20, 15), {1, 0, 0}), 0.05);
    EXPECT_LT(off(shown(40, 0), glm::normalize(Direction(1, 30.0 / 31, 40.0 / 31))), 0.05);
    o.lens = CameraModel::fisheye, o.field_radians = pi, o.width = 31;
    EXPECT_LT(off(shown(30, 15), {std::cos(pi / 2 * 30 / 31), 0, std::sin(pi / 2 * 30 / 31)}), 0.05);
    EXPECT_LT(off(shown(15, 0), {std::cos(pi / 2 * 30 / 31), std::sin(pi / 2 * 30 / 31), 0}), 0.05);
    EXPECT_EQ(shown(0, 0), Colour(0));
    o.lens = CameraModel::cylinder, o.field_radians = pi / 2, o.width = 97;
    const double turn = 96.0 / 31;
    EXPECT_NEAR(angle_across(o), 2 * 97.0 / 31, 1e-12);
    EXPECT_LT(off(shown(96, 0), glm::normalize(Direction(std::cos(turn), 30.0 / 31, std::sin(turn)))), 0.05);
  }
}

TEST(Photograph, UpIsMinusZOfTheSkyAndPlusZOfTheGround) {
  const EnvironmentMap map = directions_map(Projection::cube, 128);
  PhotographOptions o{.field_radians = pi / 2, .width = 31, .height = 31, .towards = {0, 1, 0}, .samples = 1};
  EXPECT_LT(off(pixel(photograph(map.clone(), o), o, 15, 0), glm::normalize(Direction(0, 1, -30.0 / 31))), 0.05);
  o.towards = {0, -1, 0};
  EXPECT_LT(off(pixel(photograph(map.clone(), o), o, 15, 0), glm::normalize(Direction(0, -1, 30.0 / 31))), 0.05);
}

TEST(Photograph, TurnsTheEnvironmentAndScalesIt) {
  const EnvironmentMap map = directions_map(Projection::latlong, 128);
  // By a quarter turn what was seen towards +Z is seen towards +X.
  const PhotographOptions o{
      .width = 3, .height = 3, .towards = {1, 0, 0}, .samples = 1, .rotation = rotation(90, 0, 0), .gain = 2};
  const Colour shown = pixel(photograph(map.clone(), o), o, 1, 1);
  EXPECT_NEAR(shown.x, 1, 0.01);
  EXPECT_NEAR(shown.z, 2, 0.01);
}

// A pixel of many texels is their mean: that of a fine checker is half way, where one sample is black or white.
TEST(Photograph, WidePixelsAreMeans) {
  const EnvironmentMap map =
      generate(Checker{.squares = 64, .even = Rgb<double>(1), .odd = Rgb<double>(0)}, {Projection::latlong}, 256);
  const PhotographOptions o{.field_radians = 0.7, .width = 5, .height = 5};
  for (const Colour& c : photograph(map.clone(), o)) EXPECT_NEAR(c.x, 0.5, 0.05);
}

// The mean of a fine checker over each pixel of a turned picture, by 16 x 16 bilinear samples; errors in their order.
TEST(Photograph, FiltersThatCoverThePixelAreNearItsMean) {
  const EnvironmentMap map =
      generate(Checker{.squares = 96, .even = Rgb<double>(1), .odd = Rgb<double>(0)}, {Projection::latlong}, 512);
  PhotographOptions o{.field_radians = 2.2, .width = 24, .height = 18, .towards = {0.4, 0.9, 0.3}};
  const auto with = [&](Filter filter, std::optional<int> samples = {}) {
    o.filter = filter, o.samples = samples;
    return photograph(map.clone(), o);
  };
  const std::vector<Colour> truth = with(Filter::bilinear, 16);
  const auto error = [&](const std::vector<Colour>& picture) {
    double sum = 0;
    for (std::size_t k = 0; k < truth.size(); ++k) sum += std::pow(picture[k].x - truth[k].x, 2);
    return std::sqrt(sum / double(truth.size()));
  };
  const double point = error(with(Filter::bilinear, 1)), level = error(with(Filter::nearest_level)),
               trilinear = error(with(Filter::trilinear)), ewa = error(with(Filter::ewa)),
               area = error(with(Filter::area));
  EXPECT_GT(point, 0.2);
  EXPECT_LT(level, 0.5 * point);
  EXPECT_LT(trilinear, 0.5 * point);
  EXPECT_LT(ewa, 0.5 * trilinear);
  EXPECT_LT(area, 0.01);  // Of the truth's own samples.
  EXPECT_LT(area, ewa);
}

// Beyond a field of 90 degrees, off the face of a cube; and scaled.
TEST(Photograph, AreasOfAWideFieldLookWhereTheLensSays) {
  const EnvironmentMap map = directions_map(Projection::cube, 128);
  PhotographOptions o{.field_radians = 2.4, .width = 41, .height = 31, .towards = {2, 0, 0}, .filter = Filter::area};
  const double half = std::tan(1.2);
  for (const Filter filter : {Filter::area, Filter::ewa, Filter::trilinear, Filter::nearest_level}) {
    o.filter = filter;
    EXPECT_LT(off(pixel(photograph(map.clone(), o), o, 40, 0),
                  glm::normalize(Direction(1, half * 30.0 / 31, half * 40.0 / 31))),
              0.7);
    EXPECT_LT(off(pixel(photograph(map.clone(), o), o, 20, 15), {1, 0, 0}), 0.2);
  }
}

TEST(Photograph, OtherLensesAndSamplesRefuseFiltersOfFootprints) {
  const EnvironmentMap map = directions_map(Projection::cube, 8);
  for (const Filter filter : {Filter::area, Filter::ewa, Filter::trilinear, Filter::nearest_level}) {
    EXPECT_THROW(photograph(map.clone(), {.lens = CameraModel::fisheye, .filter = filter}), UsageError);
    EXPECT_THROW(photograph(map.clone(), {.filter = filter, .samples = 2}), UsageError);
  }
  EXPECT_THROW(photograph(map.clone(), {.filter = Filter::sat}), UsageError);
}

}  // namespace
}  // namespace envmap::photograph_test

// Photos whose every pixel is the direction that it shows, by rays and formulae in long double and no code of the
// library. Beside the circle they are brighter than anything a map may hold.
#include "envmap/operate/photo_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "envmap/base/error.h"
#include "envmap/operate/convert.h"
#include "formulae.h"

namespace envmap::photo_map_test {
namespace {

using formulae::Real;
using formulae::Vector;

constexpr float beside = 1e6F;

// @param shown the direction at a place x to the right and y up from the middle of the circle, in radii.
Level photo(int width, int height, const Circle& c, const std::function<Vector(Real x, Real y)>& shown) {
  Level level(Projection::latlong, height, width);
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      const Real x = (i + Real(0.5) - c.x) / c.radius, y = (c.y - j - Real(0.5)) / c.radius;
      *level.texel(0, i, j) = x * x + y * y < 1 ? Colour(0.5 + 0.5 * formulae::rounded(shown(x, y))) : Colour(beside);
    }
  return level;
}

Direction of(const Colour& c) { return glm::normalize(2.0 * Direction(c) - 1.0); }

// A ray from (0, 0, distance) that meets a mirror of radius 1 round the origin.
Vector mirrored(Real distance, Real x, Real y) {
  const Vector ray = formulae::unit({x, y, -std::sqrt(distance * distance - 1)});
  const Real b = distance * ray.z, k = -b - std::sqrt(std::max(Real(0), b * b - distance * distance + 1));
  const Vector n{k * ray.x, k * ray.y, distance + k * ray.z};
  const Real twice = 2 * (n.x * ray.x + n.y * ray.y + n.z * ray.z);
  return {ray.x - twice * n.x, ray.y - twice * n.y, ray.z - twice * n.z};
}

// What a lens shows at r of the radius from the middle: the angle from its axis.
Real angle_at(LensModel model, Real half, Real r) {
  return model == LensModel::equidistant ? half * r : 2 * std::asin(r * std::sin(half / 2));
}

std::function<Vector(Real, Real)> lens(LensModel model, Real half, bool back) {
  return [=](Real x, Real y) {
    const Real r = std::hypot(x, y), angle = angle_at(model, half, r), k = r > 0 ? std::sin(angle) / r : 0;
    // +X is at the left of a camera that looks along +Z.
    return back ? Vector{x * k, y * k, -std::cos(angle)} : Vector{-x * k, y * k, std::cos(angle)};
  };
}

// f(direction, colour) for all texels of a panorama.
template <class F>
void for_each_texel(const EnvironmentMap& map, const F& f) {
  const int size = map.base().height();
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < 2 * size; ++i)
      f(formulae::rounded(formulae::direction(Projection::latlong, 0, (i + 0.5L) / (2 * size), (j + 0.5L) / size)),
        *map.base().texel(0, i, j));
}

TEST(PhotoMap, ABallOnTheEdgesOfPixelsKeepsItsPixels) {
  const Circle c{70, 52, 40};
  const Level picture = photo(160, 100, c, [](Real x, Real y) { return mirrored(5, x, y); });
  const EnvironmentMap map = ball_map(picture, c);
  ASSERT_EQ(map.base().height(), 80);
  for (int j = 0; j < 80; ++j)
    for (int i = 0; i < 80; ++i) {
      const double r = std::hypot(i - 39.5, j - 39.5);
      if (r < 38.5) {
        EXPECT_EQ(*map.base().texel(0, i, j), *picture.texel(0, i + 30, j + 12));
      }
      EXPECT_LE(map.base().texel(0, i, j)->x, 1) << i << ' ' << j;
    }
}

TEST(PhotoMap, ABallAnywhereInAPictureOfAnyShape) {
  const Circle c{151.3, 120.77, 96.45};
  for (const double distance : {2.0, 12.0}) {
    const Level picture = photo(420, 230, c, [=](Real x, Real y) { return mirrored(distance, x, y); });
    for (const Filter filter : {Filter::bilinear, Filter::ewa, Filter::area}) {
      const EnvironmentMap map =
          convert(ball_map(picture, c),
                  {.to = {Projection::latlong}, .size = 48, .filter = filter, .ball = BallCamera{distance}});
      for_each_texel(map, [&](const Direction& d, const Colour& found) {
        for (int k = 0; k < 3; ++k) ASSERT_LE(found[k], 1) << "the background came in";
        if (angle_between(d, {0, 0, -1}) < std::asin(1 / distance) + 0.4 || std::abs(d.y) > 0.97) return;
        ASSERT_LT(angle_between(of(found), d), 0.02) << distance << ' ' << int(filter) << ' ' << d.x << ' ' << d.z;
      });
    }
  }
}

void expect_fisheye(LensModel model, double degrees, bool with_back) {
  SCOPED_TRACE(testing::Message() << int(model) << ' ' << degrees << ' ' << with_back);
  const double half = degrees * pi / 360, texel = 2 * pi / 256;
  const Circle c{180.4, 130.9, 110.3};
  const Level front = photo(400, 260, c, lens(model, half, false)), back = photo(400, 260, c, lens(model, half, true));
  const FisheyeMap made = fisheye_map(front, {model, half, c, 400, 260}, with_back ? &back : nullptr);
  const double covered = std::min(1.0, (1 - std::cos(half)) / 2 * (with_back ? 2 : 1));
  EXPECT_NEAR(made.covered, covered, 2e-4);
  const EnvironmentMap map = convert(made.map, {.to = {Projection::latlong}, .size = 64, .filter = Filter::bilinear});
  for_each_texel(map, [&](const Direction& d, const Colour& found) {
    const double ahead = angle_between(d, {0, 0, 1}), off = with_back ? std::min(ahead, pi - ahead) : ahead;
    for (int k = 0; k < 3; ++k) ASSERT_LE(found[k], 1) << "what is beside the circle came in";
    if (off < half - texel) {
      // Near the seam two photos are mixed, and near -Z texels of an angular map are long.
      ASSERT_LT(angle_between(of(found), d), 0.02) << d.x << ' ' << d.y << ' ' << d.z;
    } else if (off > half + texel) {
      ASSERT_EQ(found, Colour(0));
    }
  });
}

TEST(PhotoMap, Fisheyes) {
  for (const LensModel model : {LensModel::equidistant, LensModel::equisolid})
    for (const double degrees : {120.0, 180.0, 220.0}) expect_fisheye(model, degrees, false);
}

TEST(PhotoMap, TwoFisheyesBackToBack) {
  for (const LensModel model : {LensModel::equidistant, LensModel::equisolid})
    for (const double degrees : {150.0, 180.0, 200.0}) expect_fisheye(model, degrees, true);
}

// Where both show a direction, each counts for less the nearer it is to its own circle: light of two exposures has no
// seam. The weights are linear in the angle.
TEST(PhotoMap, TwoFisheyesAreBlendedWhereBothSee) {
  const double half = 100 * pi / 180;
  const Circle c{100, 100, 100};
  Level bright(Projection::latlong, 200, 200), dark(Projection::latlong, 200, 200);
  for (int j = 0; j < 200; ++j) std::ranges::fill(bright.row(0, j), Colour(2));
  const FisheyeMap made = fisheye_map(bright, {LensModel::equidistant, half, c, 200, 200}, &dark);
  const int size = made.map.base().height();
  for (int i = size / 2; i < size; ++i) {
    const double angle = (2 * i + 1.0 - size) / size * pi;
    const double expected = 2 * std::clamp((half - angle) / (2 * half - pi), 0.0, 1.0);
    EXPECT_NEAR(made.map.base().texel(0, i, size / 2)->x, expected, 0.03) << angle;
  }
}

// A lens whose circle is larger than the picture: what lies beyond the picture's edges is not shown.
TEST(PhotoMap, AFisheyeThatFillsThePicture) {
  const Circle c{150, 100, 175};
  const double half = pi / 2;
  const Fisheye fisheye{LensModel::equidistant, half, c, 300, 200};
  const FisheyeMap made = fisheye_map(photo(300, 200, c, lens(fisheye.model, half, false)), fisheye, nullptr);
  std::mt19937 random(5);
  int shown = 0;
  constexpr int tries = 400000;
  for (int k = 0; k < tries; ++k) {
    const double z = 1 - 2 * double(random()) / double(std::mt19937::max());
    const double turn = 2 * pi * double(random()) / double(std::mt19937::max()), r = 175 * std::acos(z) / half;
    shown += z > 0 && std::abs(r * std::cos(turn)) < 150 && std::abs(r * std::sin(turn)) < 100;
  }
  EXPECT_NEAR(made.covered, shown / double(tries), 0.003);
  const EnvironmentMap map = convert(made.map, {.to = {Projection::latlong}, .size = 64, .filter = Filter::bilinear});
  for_each_texel(map, [&](const Direction& d, const Colour& found) {
    const double angle = angle_between(d, {0, 0, 1}), across = std::hypot(d.x, d.y), r = 175 * angle / half;
    const double x = std::abs(r * d.x / across), y = std::abs(r * d.y / across);
    if (angle < half - 0.03 && x < 147 && y < 97) {
      ASSERT_LT(angle_between(of(found), d), 0.02);
    }
    if (angle > half + 0.03 || x > 153 || y > 103) {
      ASSERT_EQ(found, Colour(0));
    }
  });
}

TEST(PhotoMap, OneHalfOfAParaboloid) {
  Level half(Projection::latlong, 64, 64);
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i) {
      const Real s = (2 * i + 1) / Real(64) - 1, t = 1 - (2 * j + 1) / Real(64), rr = s * s + t * t;
      *half.texel(0, i, j) =
          Colour(0.5 + 0.5 * formulae::rounded(Vector{2 * s / (1 + rr), 2 * t / (1 + rr), (1 - rr) / (1 + rr)}));
    }
  const EnvironmentMap map =
      convert(paraboloid_map(half, nullptr), {.to = {Projection::latlong}, .size = 32, .filter = Filter::bilinear});
  for_each_texel(map, [](const Direction& d, const Colour& found) {
    if (d.z > 0.1) {
      ASSERT_LT(angle_between(of(found), d), 0.02);
    }
    if (d.z < -0.1) {
      ASSERT_EQ(found, Colour(0));
    }
  });
}

TEST(PhotoMap, RefusesWhatIsNotInThePicture) {
  const Level picture(Projection::latlong, 100, 200);
  EXPECT_THROW(ball_map(picture, {50, 50, 52}), InputError);
  EXPECT_THROW(ball_map(picture, {50, 50, 2}), InputError);
  EXPECT_THROW(ball_map(picture, {190, 50, 40}), InputError);
  EXPECT_NO_THROW(ball_map(picture, {50, 50, 50.9}));
  EXPECT_THROW(paraboloid_map(picture, nullptr), InputError);
  EXPECT_THROW(fisheye_map(picture, {LensModel::equidistant, 1e-3, {100, 50, 50}, 200, 100}, nullptr), InputError);
  const Level other(Projection::latlong, 100, 100);
  EXPECT_THROW(fisheye_map(picture, {LensModel::equidistant, 1, {100, 50, 50}, 200, 100}, &other), InputError);
}

}  // namespace
}  // namespace envmap::photo_map_test

// Photos of a mirror ball by a camera near it, against rays that are traced to a ball: a quadratic equation and a
// mirrored vector, in long double, and no formula of the library.
#include "envmap/projection/ball_camera.h"

#include <gtest/gtest.h>

#include <cmath>

#include "envmap/base/error.h"
#include "envmap/operate/convert.h"
#include "envmap/operate/measure.h"
#include "envmap/projection/visit.h"
#include "formulae.h"

namespace envmap::ball_camera_test {
namespace {

using formulae::Real;
using formulae::Vector;

constexpr double distances[] = {BallCamera::nearest, 1.1, 1.5, 3, 10, 100, 1e4, BallCamera::farthest};

Real dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// What a camera at (0,0,distance) that looks along -Z sees in a mirroring ball of radius 1 round the origin, at a place
// of its image in which the silhouette is the unit circle: the cone of rays that touch the ball has the slope 1 /
// sqrt(distance^2 - 1).
Vector traced(Real distance, Real s, Real t) {
  const Vector ray = formulae::unit({s, t, -std::sqrt((distance - 1) * (distance + 1))});
  // |eye + k ray|^2 = 1, the nearer of the two: the ray passes the centre at |eye x ray|.
  // The point is on the ball's near side.
  const Real passes = distance * std::hypot(ray.x, ray.y),
             k = -distance * ray.z - std::sqrt((1 - passes) * (1 + passes));
  const Real x = k * ray.x, y = k * ray.y;
  const Vector normal{x, y, std::sqrt(1 - x * x - y * y)};
  const Real twice = 2 * dot(ray, normal);
  return formulae::unit({ray.x - twice * normal.x, ray.y - twice * normal.y, ray.z - twice * normal.z});
}

// A photo in which every texel is the direction that it mirrors.
EnvironmentMap photo(double distance, int size) {
  EnvironmentMap map;
  map.levels.emplace_back(Projection::sphere, size);
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      const Real s = (2 * i + 1) / Real(size) - 1, t = 1 - (2 * j + 1) / Real(size);
      // Of texels on the rim, what they reach.
      const Real inside = std::min(Real(1), Real(0.999999) / std::hypot(s, t));
      *map.base().texel(0, i, j) = Colour(0.5 + 0.5 * formulae::rounded(traced(distance, inside * s, inside * t)));
    }
  return map;
}

TEST(BallCamera, IsWhereTheTracedRayIs) {
  for (const double distance : distances)
    for (int k = 1; k < 1000; ++k) {
      const Real r = k / Real(1000), s = r * std::cos(Real(k)), t = r * std::sin(Real(k));
      const Direction seen = BallCamera{distance}.seen_from_afar(formulae::rounded(traced(distance, s, t)));
      ASSERT_NEAR(glm::length(seen), 1, 1e-12);
      const Location<double> at = Sphere::locate(seen);
      ASSERT_NEAR(2 * at.u - 1, double(s), 1e-13) << distance << ' ' << k;
      ASSERT_NEAR(1 - 2 * at.v, double(t), 1e-13) << distance << ' ' << k;
    }
}

TEST(BallCamera, FarAwayIsTheSphereProjection) {
  for (int k = 0; k < 1000; ++k) {
    const double z = 1 - (k + 0.5) / 500, h = std::sqrt(1 - z * z);
    const Direction d(h * std::cos(k), h * std::sin(k), z);
    // The angles differ by a (1 - sqrt(1 - ..)): at most of the order of 1 / distance, times how the rim stretches.
    for (const double distance : {1e3, 1e6})
      EXPECT_LT(angle_between(BallCamera{distance}.seen_from_afar(d), d), 2 / distance);
  }
}

TEST(BallCamera, TheAxisStaysWhereItIs) {
  for (const double distance : distances) {
    EXPECT_EQ(BallCamera{distance}.seen_from_afar({0, 0, 1}), Direction(0, 0, 1));
    EXPECT_LT(angle_between(BallCamera{distance}.seen_from_afar({0, 0, -1}), {0, 0, -1}), 1e-5);
  }
}

TEST(BallCamera, WhatItDoesNotSeeIsAtTheRimOfTheSameSide) {
  for (const double distance : distances) {
    const double blind = std::asin(1 / distance);
    EXPECT_NEAR(BallCamera{distance}.blind_angle(), blind, 1e-9);
    EXPECT_NEAR(BallCamera{distance}.blind_part(), (1 - std::cos(blind)) / 2, 1e-9);
    for (const double part : {0.01, 0.5, 0.99}) {
      const double angle = pi - part * blind;
      const auto at = Sphere::locate(
          BallCamera{distance}.seen_from_afar({0.6 * std::sin(angle), 0.8 * std::sin(angle), std::cos(angle)}));
      EXPECT_NEAR(2 * at.u - 1, 0.6, 1e-9);
      EXPECT_NEAR(1 - 2 * at.v, 0.8, 1e-9);
    }
  }
}

TEST(BallCamera, OfAFieldOfView) {
  EXPECT_NEAR(BallCamera::of_field_of_view(60).distance, 2, 1e-12);
  EXPECT_NEAR(BallCamera::of_field_of_view(20).distance, 1 / std::sin(pi / 18), 1e-12);
}

// Every direction that the photo shows comes back. @param most radians that it is off.
void expect_directions(double distance, Filter filter, int size, double most) {
  SCOPED_TRACE(testing::Message() << distance << ' ' << name(filter));
  const EnvironmentMap map =
      convert(photo(distance, 256),
              {.to = {Projection::latlong}, .size = size, .filter = filter, .ball = BallCamera{distance}});
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < 2 * size; ++i) {
      const Direction d =
          formulae::rounded(formulae::direction(Projection::latlong, 0, (i + 0.5L) / (2 * size), (j + 0.5L) / size));
      if (angle_between(d, {0, 0, -1}) < std::asin(1 / distance) + 0.4) continue;  // The rim, where texels are long.
      const Direction found = glm::normalize(2.0 * Direction(*map.base().texel(0, i, j)) - 1.0);
      ASSERT_LT(angle_between(found, d), most) << i << ' ' << j;
    }
}

TEST(BallCamera, AnUnwrappedPhotoShowsTheDirectionsThatWereTraced) {
  for (const double distance : {1.2, 3.0, 20.0})
    for (const Filter filter : {Filter::bilinear, Filter::bicubic}) expect_directions(distance, filter, 64, 0.006);
  // At the poles the mean of a texel lies off its centre, by a sixth of its height.
  expect_directions(3, Filter::area, 16, 0.2 * pi / 16);
  expect_directions(3, Filter::ewa, 64, 0.02);
}

TEST(BallCamera, AWhiteRoomStaysWhite) {
  EnvironmentMap white;
  white.levels.emplace_back(Projection::sphere, 65);
  for (int j = 0; j < 65; ++j) std::ranges::fill(white.base().row(0, j), Colour(1));
  for (const FilterInfo& filter : filters()) {
    const EnvironmentMap map =
        convert(white, {.to = {Projection::cube}, .size = 16, .filter = filter.filter, .ball = BallCamera{2}});
    for (int f = 0; f < 6; ++f)
      for (int j = 0; j < 16; ++j)
        for (const Colour& c : map.base().row(f, j)) ASSERT_NEAR(c.x, 1, 2e-6) << filter.name;
  }
}

}  // namespace
}  // namespace envmap::ball_camera_test

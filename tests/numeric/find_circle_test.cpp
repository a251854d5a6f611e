// Outlines of discs whose place is known: pictures drawn here, each pixel by 3 x 3 samples, and no code of the library.
#include "envmap/operate/find_circle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace envmap::find_circle_test {
namespace {

using Shade = std::function<double(double x, double y)>;

Level picture(int width, int height, const Shade& shade) {
  Level level(Projection::latlong, height, width);
  constexpr int looks = 3;
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      double sum = 0;
      for (int b = 0; b < looks; ++b)
        for (int a = 0; a < looks; ++a) sum += shade(i + (a + 0.5) / looks, j + (b + 0.5) / looks);
      *level.texel(0, i, j) = Colour(float(sum / (looks * looks)));
    }
  return level;
}

// Smooth noise: a sum of waves in random directions. @param finest wave in pixels.
Shade texture(unsigned seed, double finest) {
  std::mt19937 random(seed);
  std::vector<std::array<double, 4>> waves;
  for (int k = 0; k < 12; ++k) {
    const double turn = double(random() % 6283) / 1000, length = finest * (1 + double(random() % 1000) / 100);
    waves.push_back(
        {std::cos(turn) * 2 * pi / length, std::sin(turn) * 2 * pi / length, double(random() % 6283) / 1000, 1});
  }
  return [waves](double x, double y) {
    double sum = 0;
    for (const auto& [a, b, shift, part] : waves) sum += part * std::sin(a * x + b * y + shift);
    return std::exp(0.35 * sum);
  };
}

Shade disc(const Circle& c, const Shade& inside, const Shade& outside) {
  return [=](double x, double y) { return std::hypot(x - c.x, y - c.y) < c.radius ? inside(x, y) : outside(x, y); };
}
Shade plain(double value) {
  return [value](double, double) { return value; };
}

void expect_found(const Level& photo, const Circle& c, double most) {
  const auto found = find_circle(photo);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->sure()) << found->support << ' ' << found->spread << ' ' << found->rival.has_value();
  EXPECT_NEAR(found->circle.x, c.x, most);
  EXPECT_NEAR(found->circle.y, c.y, most);
  EXPECT_NEAR(found->circle.radius, c.radius, most);
}

TEST(FindCircle, APlainDisc) {
  for (const Circle c : {Circle{200.3, 150.7, 90.4}, Circle{60.5, 200, 40.25}, Circle{250, 149.9, 140.1}})
    expect_found(picture(500, 300, disc(c, plain(0.8), plain(0.2))), c, 0.2);
}

TEST(FindCircle, ATexturedBallBeforeATexture) {
  for (unsigned seed = 0; seed < 4; ++seed)
    for (const double finest : {10.0, 25.0}) {
      SCOPED_TRACE(testing::Message() << seed << ' ' << finest);
      const Circle c{150.0 + 13.37 * seed, 140.2 + 3.1 * seed, 70.6 + 8 * seed};
      expect_found(picture(420, 320, disc(c, texture(seed, finest), texture(seed + 100, finest))), c, 0.5);
    }
}

// A background as sharp and as strong as the outline may hide it. It is never taken for another circle.
TEST(FindCircle, IsNotSureOfAWrongCircle) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    const Circle c{150.0 + 13.37 * seed, 140.2 + 3.1 * seed, 50.6 + 8 * seed};
    const auto found = find_circle(picture(420, 320, disc(c, texture(seed, 5), texture(seed + 100, 5))));
    if (!found || !found->sure()) continue;
    EXPECT_NEAR(found->circle.x, c.x, 0.5) << seed;
    EXPECT_NEAR(found->circle.y, c.y, 0.5) << seed;
    EXPECT_NEAR(found->circle.radius, c.radius, 0.5) << seed;
  }
}

// A picture that is made smaller before circles are looked for.
TEST(FindCircle, ALargePicture) {
  const Circle c{900.3, 620.8, 411.7};
  expect_found(picture(1700, 1200, disc(c, texture(1, 20), texture(2, 60))), c, 0.3);
}

TEST(FindCircle, AFisheyeInBlack) {
  const Circle c{320.4, 239.6, 230.2};
  expect_found(picture(640, 480, disc(c, texture(5, 12), plain(0))), c, 0.3);
}

// What is reflected in rings round the middle lies in the outline.
TEST(FindCircle, TheOutermostOfRings) {
  const Circle c{211.5, 190.25, 130.75};
  const Shade rings = [c](double x, double y) { return std::fmod(std::hypot(x - c.x, y - c.y), 24) < 12 ? 1.0 : 0.25; };
  expect_found(picture(420, 380, disc(c, rings, plain(0.5))), c, 0.3);
}

TEST(FindCircle, TellsOfTwoBalls) {
  const Circle a{110, 150, 80}, b{300, 150, 78};
  const auto found = find_circle(picture(420, 300, disc(a, plain(0.9), disc(b, plain(0.5), plain(0.1)))));
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->sure());
  ASSERT_TRUE(found->rival);
  const Circle other = found->circle.x < 200 ? b : a;
  EXPECT_NEAR(found->rival->x, other.x, 3);
  EXPECT_NEAR(found->rival->radius, other.radius, 3);
}

TEST(FindCircle, IsNotSureWhereThereIsNone) {
  const Shade square = [](double x, double y) { return std::abs(x - 200) < 90 && std::abs(y - 150) < 90 ? 0.9 : 0.2; };
  const Shade ellipse = [](double x, double y) { return std::hypot((x - 200) / 1.3, y - 150) < 90 ? 0.9 : 0.2; };
  std::mt19937 random(3);
  const Shade noise = [&random](double, double) { return double(random() % 1000); };
  for (const Level& photo :
       {picture(400, 300, plain(0.3)), picture(400, 300, square), picture(400, 300, ellipse),
        picture(400, 300, texture(7, 8)), picture(400, 300, texture(8, 30)), picture(400, 300, noise)}) {
    const auto found = find_circle(photo);
    EXPECT_FALSE(found && found->sure()) << found->support << ' ' << found->spread << ' ' << found->circle.radius;
  }
  EXPECT_FALSE(find_circle(picture(40, 30, plain(0))));
}

}  // namespace
}  // namespace envmap::find_circle_test

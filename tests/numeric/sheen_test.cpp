// Sums of sheen by blocks against the exact sum, and against an integral of the formula.
#include "envmap/prefilter/sheen/sheen.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "envmap/operate/measure.h"
#include "envmap/prefilter/exact/exact.h"
#include "envmap/prefilter/prefilter.h"
#include "envmap/prefilter/source_cube.h"

namespace {

using namespace envmap;
using namespace envmap::prefiltering;

EnvironmentMap made(Projection projection, int size,
                    const std::function<float(int face, int i, int j, int channel)>& radiance) {
  EnvironmentMap map;
  map.levels.emplace_back(projection, size);
  Level& level = map.base();
  for (int f = 0; f < level.faces(); ++f)
    for (int j = 0; j < level.height(); ++j)
      for (int i = 0; i < level.width(); ++i)
        for (int c = 0; c < 3; ++c) (*level.texel(f, i, j))[c] = radiance(f, i, j, c);
  return map;
}

// A third of them with the light at their horizon, a third with it where the lobe is largest, the rest anywhere.
std::vector<Direction> around(const Direction& light, double power, int count) {
  std::mt19937_64 random(3);
  const auto part = [&] { return double(random() >> 11) * 0x1p-53; };
  const Direction side = unit(glm::cross(light, std::abs(light.y) < 0.9 ? Direction(0, 1, 0) : Direction(1, 0, 0)));
  const Direction other = glm::cross(light, side);
  std::vector<Direction> all;
  for (int k = 0; k < count; ++k) {
    const double up = k % 3 == 0 ? 0.04 * (part() - 0.5) : k % 3 == 1 ? 4 / power * part() : 1 - 2 * part();
    const double level = std::sqrt(std::max(0.0, 1 - up * up)), turn = 2 * pi * part();
    all.push_back(unit(up * light + level * (std::cos(turn) * side + std::sin(turn) * other)));
  }
  return all;
}

// What the largest error of sums is of what is allowed.
double worst_of(const EnvironmentMap& map, double roughness, double error, std::span<const Direction> some) {
  const Charlie lobe(roughness);
  const double mean = mean_radiance(map.base());
  const SheenPlan wanted = *sheen_plan(lobe, error);
  const std::optional<Level> fine = refined(map.base(), wanted.texel());
  const SheenBlocks blocks(fine ? *fine : map.base(), mean);
  const SheenPlan plan = fitted(wanted, blocks);
  std::vector<SheenSum> sums(some.size());
  sheen_sums(plan, blocks, some, sums);
  const std::vector<Flux> truth = exact_prefilter(map.base(), lobe, some);
  double worst = 0;
  for (std::size_t k = 0; k < some.size(); ++k)
    for (int c = 0; c < 3; ++c)
      worst = std::max(worst, std::abs(mean * sums[k].value[c] - truth[k][c]) / std::max(truth[k][c], 1e-3 * mean));
  return worst / error;
}

constexpr double roughnesses[] = {0, 0.1, 0.2, 0.29, 0.35};

#ifdef __SANITIZE_ADDRESS__  // Sums are those of the optimised build. Here memory is looked at.
constexpr double errors[] = {1e-3};
constexpr int latlong_sizes[] = {16}, cube_sizes[] = {16}, directions = 20;
#else
constexpr double errors[] = {1e-2, 1e-3, 1e-4};
constexpr int latlong_sizes[] = {64, 250}, cube_sizes[] = {32, 128}, directions = 150;
#endif

void expect_small_errors(const EnvironmentMap& map, const Direction& light, const std::string& what) {
  for (const double roughness : roughnesses)
    for (const double error : errors)
      EXPECT_LE(worst_of(map, roughness, error, around(light, 0.5 / std::max(9e-4, roughness * roughness), directions)),
                1)
          << fmt::format("roughness {}, error {:g}, {}", roughness, error, what);
}

Direction middle_of(Projection projection, int size, int face, int i, int j) {
  std::vector<Direction> light(1);
  texel_directions(projection, size, face, j, i, light);
  return light[0];
}

TEST(Sheen, LoneLightsOfLatlongMaps) {
  for (const int size : latlong_sizes)
    for (const auto& [i, j] : {std::array{0, 0}, std::array{2 * size - 1, size / 2}, std::array{size / 3, size / 5},
                               std::array{size / 7, 3}, std::array{size, size - 1}}) {
      const EnvironmentMap map = made(Projection::latlong, size, [&, x = i, y = j](int, int a, int b, int ch) {
        return a == x && b == y && ch != 1 ? 1e9F : 0.F;
      });
      expect_small_errors(map, middle_of(Projection::latlong, size, 0, i, j),
                          fmt::format("light {} {} of {}", i, j, size));
    }
}

// The cells of a large map are tiny beside its poles, where the horizons of these texels run along them.
TEST(Sheen, WhiteStaysWhiteWhereHorizonsPassThePolesOfALargeMap) {
  const EnvironmentMap map = made(Projection::latlong, 2048, [](int, int, int, int) { return 1.F; });
  const SheenBlocks blocks(map.base(), 1);
  std::vector<Direction> row(128);
  texel_directions(Projection::cube, 128, 0, 63, 0, row);
  for (const double roughness : {0.2, 0.35}) {
    std::vector<SheenSum> sums(row.size());
    sheen_sums(fitted(*sheen_plan(Charlie(roughness), 1e-3), blocks), blocks, row, sums);
    for (std::size_t k = 0; k < sums.size(); ++k)
      EXPECT_NEAR(sums[k].value[0], 1, 1e-3) << "roughness " << roughness << ", texel " << k;
  }
}

TEST(Sheen, LoneLightsOfCubes) {
  for (const int size : cube_sizes)
    for (const auto& [face, i, j] :
         {std::array{2, 0, 0}, std::array{1, size / 3, size - 1}, std::array{4, size / 2, size / 2}}) {
      const EnvironmentMap map =
          made(Projection::cube, size, [&, x = i, y = j, at = face](int f, int a, int b, int ch) {
            return f == at && a == x && b == y && ch != 1 ? 1e9F : 0.F;
          });
      expect_small_errors(map, middle_of(Projection::cube, size, face, i, j),
                          fmt::format("light {} {} {} of a cube of {}", face, i, j, size));
    }
}

TEST(Sheen, EveryKindOfLight) {
  std::mt19937_64 random(11);
  const auto even = [&] { return float(double(random() >> 11) * 0x1p-53); };
  const std::pair<const char*, std::function<float(int, int, int, int)>> kinds[] = {
      {"even", [](int, int, int, int) { return 0.7F; }},
      {"noise", [&](int, int, int, int) { return even(); }},
      {"lamps", [&](int, int, int, int) { return even() < 0.01F ? 1e4F * even() : 0.F; }},
      {"checkers", [](int, int i, int j, int c) { return ((i >> c) + (j >> c)) % 2 == 0 ? 1.F : 0.F; }},
      {"half", [](int, int, int j, int c) { return j < 20 + 7 * c ? 2.F : 0.F; }},
      {"subnormal", [](int, int i, int j, int) { return i == j ? 1e-44F : 0.F; }},
      {"bright", [](int, int i, int, int) { return i % 3 == 0 ? 3e38F : 1e30F; }}};
  for (const auto& [kind, radiance] : kinds)
    for (const Projection from : {Projection::latlong, Projection::cube})
      for (const double roughness : roughnesses)
        EXPECT_LE(worst_of(made(from, from == Projection::cube ? 30 : 60, radiance), roughness, 1e-3,
                           around(unit(Direction(0.3, 0.8, -0.2)), 10, directions / 20)),
                  1)
            << kind << " " << roughness;
}

// The formula of the lobe over a texel, by many points in long double: without the library's lobes and rules.
TEST(Sheen, IsItsIntegral) {
  constexpr int size = 90, row = 31, column = 17;
  const EnvironmentMap map =
      made(Projection::latlong, size, [](int, int i, int j, int) { return i == column && j == row ? 1e6F : 0.F; });
  const long double circle = 2 * std::numbers::pi_v<long double>;
  const long double at = std::sqrt(0.6L);
  const std::pair<long double, long double> gauss[] = {{-at, 5.0L / 9}, {0, 8.0L / 9}, {at, 5.0L / 9}};
  for (const double roughness : {0.1, 0.25}) {
    const long double power = 0.5L / (roughness * roughness), scale = (power + 1) * (power + 2) / circle;
    const Prefiltered done = Prefilterer(map).make(
        {.lobe = Lobe::charlie(roughness), .to = Projection::latlong, .size = 8, .max_error = 1e-4});
    EXPECT_EQ(done.method, Method::multilevel);
    EXPECT_LE(done.error, 1e-4);
    for (int j = 0; j < 8; ++j)
      for (int i = 0; i < 16; ++i) {
        const long double n_polar = circle / 2 * (j + 0.5L) / 8, n_turn = circle * (i + 0.5L) / 16;
        long double sum = 0;
        constexpr int rows = 4000, panels = 3;
        for (int y = 0; y < rows; ++y) {
          const long double polar = circle / 2 * (row + (y + 0.5L) / rows) / size;
          const long double up = std::cos(polar) * std::cos(n_polar), level = std::sin(polar) * std::sin(n_polar);
          // Longitudes from the output's where t > 0; this light is never half a turn away and seen.
          const long double most = std::acos(std::clamp(-up / level, -1.0L, 1.0L));
          long double away = circle * column / (2 * size) - n_turn;
          if (away < -circle / 2) away += circle;
          const long double low = std::max(-most, away), high = std::min(most, away + circle / (2 * size));
          for (int x = 0; x < panels && high > low; ++x)
            for (const auto& [node, weight] : gauss) {
              const long double t = up + level * std::cos(low + (x + 0.5L + 0.5L * node) / panels * (high - low));
              sum += weight / 2 * std::sin(polar) * t * std::pow(1 - t, power) * (high - low) / panels;
            }
        }
        const long double truth = 1e6L * scale * sum * (circle / 2 / size / rows);
        EXPECT_NEAR(done.map.base().texel(0, i, j)->x, double(truth), 1.1e-4 * std::max(double(truth), done.floor))
            << i << " " << j << " of roughness " << roughness;
      }
  }
}

TEST(Sheen, MapsStateTheirBound) {
  const EnvironmentMap map = made(Projection::latlong, 48, [](int, int i, int j, int c) {
    return i == 7 && j == 3 ? 1e6F : float((i * 7 + j * 3 + c) % 11);
  });
  for (const Projection to : {Projection::cube, Projection::latlong, Projection::octahedral}) {
    PrefilterOptions wanted{.lobe = Lobe::charlie(0.16), .to = to, .size = 6, .method = Method::multilevel};
    const Prefiltered done = Prefilterer(map).make(wanted);
    EXPECT_EQ(done.method, Method::multilevel);
    EXPECT_GT(done.error, 0);
    EXPECT_LE(done.error, 1e-3);
    wanted.method = Method::exact;
    EXPECT_LE(compare(done.map.base(), Prefilterer(map).make(wanted).map.base(), nullptr).maximum, done.error);
  }
}

TEST(Sheen, BlackStaysBlackAndWhiteStaysWhite) {
  for (const float light : {0.F, 1.F}) {
    const EnvironmentMap map = made(Projection::latlong, 20, [&](int, int, int, int) { return light; });
    const Prefiltered done = Prefilterer(map).make({.lobe = Lobe::charlie(0.16), .size = 3});
    for (int f = 0; f < 6; ++f)
      for (const Colour& c : done.map.base().row(f, 1)) EXPECT_NEAR(c.x, light, 1e-3 * light);
  }
}

TEST(Sheen, WideLobesAndSmallErrorsAreLeftToOthers) {
  const EnvironmentMap map = made(Projection::latlong, 16, [](int, int i, int j, int) { return float((i + j) % 3); });
  const auto method = [&](double roughness, double error) {
    return Prefilterer(map).make({.lobe = Lobe::charlie(roughness), .size = 2, .max_error = error}).method;
  };
  EXPECT_EQ(method(0.1, 1e-3), Method::multilevel);
  EXPECT_EQ(method(0.35, 1e-4), Method::multilevel);
  EXPECT_NE(method(0.35, 9e-5), Method::multilevel);
  EXPECT_FALSE(sheen_plan(Ggx(0.1), 1e-3));
}

}  // namespace

// Radiance by direction: levels against flat ones, many directions against one.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "envmap/envmap.h"

namespace lookup_test {
namespace {

using namespace envmap;

// Level k of a map is 10^k everywhere.
EnvironmentMap powers(Projection p, int levels) {
  EnvironmentMap map = generate(Constant{}, p, 16);
  for (int k = 1; k < levels; ++k)
    map.levels.push_back(std::move(generate(Constant{Rgb<double>(std::pow(10, k))}, p, 16 >> k).base()));
  return map;
}

TEST(Lookup, MixesNeighbouringLevels) {
  for (const Projection p : all_projections) {
    const EnvironmentLookup look(powers(p, 3));
    const Direction d(0.3, -0.2, 0.8);
    for (const auto& [level, value] : {std::pair{0.0, 1.0}, {0.25, 3.25}, {1.0, 10.0}, {1.5, 55.0}, {2.0, 100.0}})
      EXPECT_NEAR(look(d, level).x, value, 1e-5 * value) << name(p) << " " << level;
    for (const double above : {2.5, 1e9, std::numeric_limits<double>::infinity()})
      EXPECT_NEAR(look(d, above).x, 100, 1e-3);
    for (const double below : {-1.0, std::nan(""), -std::numeric_limits<double>::infinity()})
      EXPECT_NEAR(look(d, below).x, 1, 1e-5);
  }
}

TEST(Lookup, ADimLevelIsNotLostBesideABrightOne) {
  EnvironmentMap map = generate(Constant{Rgb<double>(1e9)}, Projection::cube, 16);
  map.levels.push_back(std::move(generate(Constant{}, Projection::cube, 8).base()));
  EXPECT_NEAR(EnvironmentLookup(map)({0, 0, 1}, 1 - 0x1p-20).x, 1e9 * 0x1p-20 + 1, 1e-3);
}

TEST(Lookup, OfManyDirectionsIsThatOfEach) {
  EnvironmentMap map = generate(Directions{}, {Projection::latlong, Forward::plus_x}, 32);
  add_levels(map);
  const EnvironmentLookup look(map), copy = look;
  const std::vector<Direction> directions{{1, 0, 0}, {0, 3, 4}, {-1, -1, 0.5}, {0, 0, 0}};
  for (const double level : {0.0, 1.7}) {
    std::vector<Colour> found(directions.size());
    copy(directions, found, level);
    for (std::size_t k = 0; k < directions.size(); ++k) EXPECT_EQ(found[k], look(directions[k], level)) << k;
  }
  EXPECT_NEAR(look({0, 3, 4}).y, 0.8, 0.01);  // (0.6 + 1) / 2.
}

TEST(Lookup, OfFloatsAndOnAnyThreadsIsTheSame) {
  EnvironmentMap map = generate(Directions{}, {Projection::latlong, Forward::plus_x}, 64);
  add_levels(map);
  const EnvironmentLookup look(map);
  std::vector<Vec3<float>> floats;
  std::vector<Direction> doubles;
  for (int k = 0; k < 5000; ++k) {
    floats.emplace_back(std::sin(0.01F * float(k)), std::cos(0.7F * float(k)), std::sin(float(k) + 0.5F));
    doubles.emplace_back(floats.back());
  }
  std::vector<Colour> one(floats.size()), many(floats.size()), of_doubles(floats.size());
  look(floats, one, 1.3, {.threads = 1});
  look(floats, many, 1.3, {.threads = 4});
  look(doubles, of_doubles, 1.3);
  EXPECT_EQ(one, many);
  EXPECT_EQ(one, of_doubles);
  EXPECT_THROW(look(floats, std::span(one).first(3)), UsageError);
}

TEST(Lookup, FindsTheLevelOfARoughness) {
  const std::vector<double> roughnesses{0.1, 0.2, 0.6};
  const EnvironmentLookup look(powers(Projection::cube, 3), roughnesses);
  for (const auto& [roughness, level] :
       {std::pair{0.0, 0.0}, {0.1, 0.0}, {0.15, 0.5}, {0.2, 1.0}, {0.3, 1.25}, {0.6, 2.0}, {1.0, 2.0}})
    EXPECT_NEAR(look.level_at(roughness), level, 1e-12) << roughness;
  EXPECT_EQ(look.level_at(std::nan("")), 0);
  EXPECT_THROW((void)EnvironmentLookup(powers(Projection::cube, 3)).level_at(0.2), UsageError);
  EXPECT_THROW(EnvironmentLookup(powers(Projection::cube, 3), {0.1, 0.2}), UsageError);
  EXPECT_THROW(EnvironmentLookup(powers(Projection::cube, 3), {0.1, 0.1, 0.2}), UsageError);
}

TEST(Lookup, RefusesWhatIsNoMap) {
  EXPECT_THROW(EnvironmentLookup{EnvironmentMap()}, UsageError);
  EnvironmentMap mixed = generate(Constant{}, Projection::cube, 8);
  mixed.levels.push_back(std::move(generate(Constant{}, Projection::sphere, 4).base()));
  EXPECT_THROW(EnvironmentLookup{mixed}, UsageError);
  const EnvironmentLookup look(generate(Constant{}, Projection::cube, 8));
  std::vector<Colour> few(1);
  EXPECT_THROW(look(std::vector<Direction>(2), few), UsageError);
}

}  // namespace
}  // namespace lookup_test

// One rule for mip chains, and comparisons that see all of their levels.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "envmap/envmap.h"

namespace chains_test {
namespace {

using namespace envmap;

EnvironmentMap sky(Projection p, int size) { return generate(Sky{}, p, size); }

EnvironmentMap chain_of_sizes(const std::vector<int>& sizes) {
  EnvironmentMap map;
  for (const int size : sizes) map.levels.push_back(std::move(sky(Projection::cube, size).base()));
  return map;
}

void refuses(const std::string& words, const std::function<void()>& call) {
  try {
    call();
    ADD_FAILURE() << "no error: " << words;
  } catch (const UsageError& e) {
    EXPECT_NE(std::string(e.what()).find(words), std::string::npos) << e.what();
  }
}

// What write() refuses, nothing else takes, and what it takes, they take.
TEST(Chains, HaveOneRule) {
  const std::vector<std::pair<std::vector<int>, std::string>> wrong{
      {{16, 15}, "level 1 is 15x15, not 8x8"},
      {{16, 16}, "level 1 is 16x16, not 8x8"},
      {{4, 2, 1, 1}, "4x4 has at most 3 levels, not 4"},
      {std::vector<int>(40, 1), "1x1 has at most 1 levels, not 40"},
  };
  for (const auto& [sizes, words] : wrong) {
    const EnvironmentMap map = chain_of_sizes(sizes);
    refuses(words, [&] { (void)encode(map, {.format = "ktx2"}); });
    refuses(words, [&] { (void)pack(map); });
    refuses(words, [&] { check_levels(map); });
  }
  for (const std::vector<int>& sizes : {std::vector{16}, {16, 8}, {5, 2, 1}}) {
    const EnvironmentMap map = chain_of_sizes(sizes);
    EXPECT_NO_THROW((void)encode(map, {.format = "ktx2"}));
    EXPECT_NO_THROW((void)pack(map));
    EXPECT_NO_THROW(check_levels(map));
  }
  EnvironmentMap mixed = sky(Projection::octahedral, 4);
  mixed.levels.push_back(std::move(sky(Projection::angular, 2).base()));
  refuses("levels of one map must have one projection", [&] { (void)pack(mixed); });
}

TEST(Chains, OfLobesEndAtOneTexel) {
  const EnvironmentMap source = sky(Projection::cube, 8);
  const Prefilterer from(source);
  const std::vector<Lobe> rough(5, Lobe::ggx(0.5));
  refuses("8x8 has at most 4 levels, not 5", [&] { (void)from.make_chain(rough, {.size = 8}); });
  const PrefilteredChain made = from.make_chain(std::span(rough).first(4), {.size = 8});
  EXPECT_NO_THROW((void)pack(made.map));
  // 45x22 is what halves 90x45, and no latlong map.
  const PrefilterOptions odd{.to = Projection::latlong, .size = 45};
  refuses("level 1 is 44x22, not 45x22", [&] { (void)from.make_chain(std::span(rough).first(2), odd); });
}

TEST(Chains, HaveLevelsOfTheirProjection) {
  for (const Projection p : all_projections)
    if (p == Projection::latlong)
      EXPECT_NO_THROW((void)Level(p, 22, 45));
    else
      refuses("faces 64 texels high of a " + std::string(name(p)) + " map are 64 wide, not 100",
              [&] { (void)Level(p, 64, 100); });
  refuses("faces 4 texels high of a cube map are 4 wide, not 9", [] {
    (void)level_of({Projection::cube, 4, Forward::plus_z, [](int, int, std::span<Colour>) {}, 9});
  });
}

// Level 1 differs by a tenth in one texel, level 0 not at all.
TEST(Comparison, SeesEveryLevel) {
  EnvironmentMap a = sky(Projection::cube, 8);
  add_levels(a);
  EnvironmentMap b = a.clone();
  Colour& texel = *b.levels[1].texel(4, 2, 3);
  texel *= 0.5F;
  const MapDifference d = compare(a, b);
  ASSERT_EQ(d.levels.size(), 4U);
  EXPECT_NEAR(d.maximum, 1, 1e-6);
  EXPECT_EQ(d.worst_level, 1);
  EXPECT_EQ(d.worst.face, 4);
  EXPECT_EQ(d.worst.i, 2);
  EXPECT_EQ(d.worst.j, 3);
  EXPECT_EQ(d.levels[0].maximum, 0);
  EXPECT_EQ(d.levels[1].maximum, d.maximum);
  EXPECT_EQ(d.rms, d.levels[1].rms);
  EXPECT_GT(d.rms, 0);
  EXPECT_EQ(d.largest_flux(), d.levels[1].largest_flux());
  EXPECT_EQ(compare(a, a).maximum, 0);
}

TEST(Comparison, OfOneLevelIsThatOfTheLevels) {
  const EnvironmentMap a = sky(Projection::latlong, 8), b = generate(Gradient{}, Projection::latlong, 8);
  const MapDifference all = compare(a, b);
  const Difference level = compare(a.base(), b.base());
  EXPECT_EQ(all.flux, level.flux);
  EXPECT_EQ(all.rms, level.rms);
  EXPECT_EQ(all.maximum, level.maximum);
  EXPECT_EQ(all.worst_level, 0);
}

TEST(Comparison, RefusesOtherNumbersOfLevels) {
  const EnvironmentMap a = sky(Projection::cube, 8);
  EnvironmentMap chain = a.clone();
  add_levels(chain);
  refuses("the same number of levels, not 1 and 4", [&] { (void)compare(a, chain); });
  refuses("the same number of levels, not 4 and 1", [&] { (void)compare(chain, a); });
}

}  // namespace
}  // namespace chains_test

// Bilinear samples by the vector code of every target: the scalar formula to the last bit, and nothing beyond a span.
#include "envmap/sample/point.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

#include "envmap/sample/padded_level.h"
#include "every_target.h"

namespace envmap::sample_test {
namespace {

class EachSampled : public testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(, EachSampled, testing::ValuesIn(all_projections),
                         [](const auto& p) { return identifier(p.param); });

// Suns beside subnormal numbers.
PaddedLevel rough(Projection p, int size) {
  Level level(p, size);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> exponent(-140, 30), any(1, 2);
  for (int face = 0; face < level.faces(); ++face)
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < level.width(); ++i)
        for (int c = 0; c < 3; ++c)
          (*level.texel(face, i, j))[c] = std::ldexp(any(random), int(exponent(random)));
  return PaddedLevel(std::move(level));
}

std::vector<Location<double>> places(const PaddedLevel& level, std::size_t count) {
  const double over = 0.9 / level.width();  // Settled locations lie up to a texel outside.
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> any(-over, 1 + over);
  std::vector<Location<double>> found;
  for (int face = 0; face < level.faces(); ++face)
    for (const double u : {0.0, 0.5, 1.0})
      for (const double v : {0.0, 0.5 / level.height(), 1.0}) found.push_back({face, u, v});
  while (found.size() < count)
    found.push_back({int(found.size()) % level.faces(), any(random), any(random)});
  return found;
}

bool same(const Colour& a, const Colour& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

TEST_P(EachSampled, BilinearSpanIsTheScalarFormulaBitForBit) {
  for (const int size : {1, 2, 17, 64}) {
    const PaddedLevel level = rough(GetParam(), size);
    const auto at = places(level, 3000);
    on_every_target([&](const char* target) {
      std::vector<Colour> out(at.size());
      sample_bilinear(level, at, out);
      for (std::size_t k = 0; k < at.size(); ++k)
        ASSERT_TRUE(same(out[k], bilinear(level, at[k])))
            << target << " size " << size << " " << at[k].u << " " << at[k].v;
    });
  }
}

TEST_P(EachSampled, BilinearSpanStaysInBounds) {
  const PaddedLevel level = rough(GetParam(), 8);
  on_every_target([&](const char* target) {
    for (const std::size_t n : {0, 1, 2, 3, 4, 5, 7, 8, 9, 15, 16, 17, 63, 64, 65, 127, 128, 129}) {
      auto at = places(level, 200);
      at.erase(at.begin() + std::ptrdiff_t(n), at.end());
      at.shrink_to_fit();
      const Colour mark(-7);
      std::vector<Colour> out(n + 1, mark);
      sample_bilinear(level, at, std::span(out).first(n));
      for (std::size_t k = 0; k < n; ++k) ASSERT_TRUE(same(out[k], bilinear(level, at[k]))) << target << n;
      ASSERT_EQ(out[n], mark);
    }
  });
}

// The last four taps of a level end with its last texel.
TEST(Sample, LastTexelOfALevel) {
  const PaddedLevel level = rough(Projection::paraboloid, 4);
  const double corner = (4 + Level::padding - 1.5) / 4;
  const std::vector<Location<double>> at{{1, corner, corner}};
  on_every_target([&](const char*) {
    std::vector<Colour> out(1);
    sample_bilinear(level, at, out);
    EXPECT_TRUE(same(out[0], bilinear(level, at[0])));
  });
}

}  // namespace
}  // namespace envmap::sample_test

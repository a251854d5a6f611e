// Tone curves against their definitions.
#include <gtest/gtest.h>

#include <array>

#include "envmap/io/images/picture.h"

namespace display_test {
namespace {

using namespace envmap;

Colour shown(Colour c, Display display, double exposure = 1) {
  std::array<Colour, 1> one{c};
  show(one, display, exposure);
  return one[0];
}

TEST(Display, ClipsAtOne) {
  EXPECT_EQ(shown(Colour(0.25F, 1, 7), Display::clip), Colour(0.25F, 1, 1));
  EXPECT_EQ(shown(Colour(0.25F), Display::clip, 2), Colour(0.5F));
}

TEST(Display, ReinhardHalvesOne) {
  const Colour c = shown(Colour(0.25F, 1, 3), Display::reinhard);
  EXPECT_FLOAT_EQ(c.x, 0.2F);
  EXPECT_FLOAT_EQ(c.y, 0.5F);
  EXPECT_FLOAT_EQ(c.z, 0.75F);
  EXPECT_FLOAT_EQ(shown(Colour(0.5F), Display::reinhard, 2).x, 0.5F);
}

// What a base colour reflects in white, with 0.04 more where all channels have it, comes out as the base colour.
TEST(Display, NeutralKeepsBaseColours) {
  for (const Colour base : {Colour(0.6F, 0.3F, 0.1F), Colour(0.5F), Colour(0.05F, 0.1F, 0.7F)}) {
    const Colour c = shown(base + 0.04F, Display::neutral);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(c[k], base[k], 1e-6);
  }
  EXPECT_EQ(shown(Colour(0), Display::neutral), Colour(0));
}

// At its two joints the curve is whole; it rises, stays below 1 and brings bright colours to white.
TEST(Display, NeutralRisesWithoutAStep) {
  float before = 0;
  for (int k = 1; k <= 4000; ++k) {
    const Colour c = shown(Colour(0.01F * float(k) / 10), Display::neutral);
    EXPECT_GE(c.x, before) << k;
    EXPECT_LT(c.x - before, 1.1e-3F) << k;
    EXPECT_LT(c.x, 1);
    before = c.x;
  }
  const Colour bright = shown(Colour(1e6F, 1e5F, 0), Display::neutral);
  EXPECT_GT(std::min(bright.x, std::min(bright.y, bright.z)), 0.99F);
}

}  // namespace
}  // namespace display_test

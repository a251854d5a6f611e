// --max-error: what is promised of the sampled texels has to hold in all of them.
#include "envmap/operate/choose.h"

#include <gtest/gtest.h>

#include <random>

#include "envmap/operate/measure.h"

namespace envmap {
namespace {

// Soft noise, and a sun in a few texels.
EnvironmentMap landscape(int height) {
  EnvironmentMap map;
  map.levels.emplace_back(Projection::latlong, height);
  std::mt19937 random(17);
  for (int j = 0; j < height; ++j)
    for (Colour& c : map.base().row(0, j)) c = Colour(0.5F + 0.2F * static_cast<float>(random() % 1000) / 1000);
  for (int k = 0; k < 4; ++k) *map.base().texel(0, 70 + k % 2, 30 + k / 2) = Colour(5000, 4000, 3000);
  return map;
}

TEST(Choose, TheErrorAskedForHoldsInEveryTexel) {
  for (const Projection to : {Projection::cube, Projection::paraboloid})
    for (const double error : {0.3, 1e-2, 1e-3}) {
      EnvironmentMap source = landscape(96), copy = source;
      const Conversion wanted{.to = to, .size = 20};
      const Choice choice = cheapest_filter(source, wanted, error);
      ASSERT_TRUE(choice.reached) << error;
      Conversion reference = wanted;
      reference.filter = Filter::area;
      reference.area_tolerance = 1e-5;
      const Difference d = compare(convert(source, choice.conversion).base(), convert(copy, reference).base());
      // The texels measured are a sample of all, but for small maps nearly all of them.
      EXPECT_LT(d.maximum, 1.5 * error) << name(to) << " at " << d.worst.i << "," << d.worst.j;
      EXPECT_LT(d.rms, error);
    }
}

TEST(Choose, CheaperFiltersServeLargerErrors) {
  EnvironmentMap smooth;
  smooth.levels.emplace_back(Projection::latlong, 64);
  for (int j = 0; j < 64; ++j) std::ranges::fill(smooth.base().row(0, j), Colour(2));
  EXPECT_EQ(cheapest_filter(smooth, {.to = Projection::cube, .size = 8}, 1e-3).best.filter, Filter::nearest);
  EnvironmentMap rough = landscape(64);
  EXPECT_EQ(cheapest_filter(rough, {.to = Projection::cube, .size = 8}, 1e-3).best.filter, Filter::area);
}

}  // namespace
}  // namespace envmap

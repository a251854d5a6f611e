// --max-error: what is promised of the sampled texels has to hold in all of them.
#include <gtest/gtest.h>

#include <array>
#include <random>

#include "envmap/operate/convert.h"
#include "envmap/operate/measure.h"

namespace envmap::choose_filter_test {
namespace {

// Soft noise, and a sun in a few texels.
EnvironmentMap landscape(int height) {
  EnvironmentMap map;
  map.levels.emplace_back(Projection::latlong, height);
  std::mt19937 random(17);
  for (int j = 0; j < height; ++j)
    for (Colour& c : map.base().row(0, j)) c = Colour(0.5F + 0.2F * float(random() % 1000) / 1000);
  for (int k = 0; k < 4; ++k) *map.base().texel(0, 70 + k % 2, 30 + k / 2) = Colour(5000, 4000, 3000);
  return map;
}

TEST(ChooseFilter, TheErrorAskedForHoldsInEveryTexel) {
  for (const Projection to : {Projection::cube, Projection::paraboloid})
    for (const double error : {0.3, 1e-2, 1e-3}) {
      const EnvironmentMap source = landscape(96);
      const Resampler resampler(source, {.to = to, .size = 20, .max_error = error});
      ASSERT_TRUE(resampler.choice()->reached) << error;
      const EnvironmentMap reference =
          convert(source, {.to = to, .size = 20, .filter = Filter::area, .area_error = 1e-5});
      const Difference d = compare(level_of(resampler.rows()), reference.base());
      // The texels measured are a sample of all, but for small maps nearly all of them.
      EXPECT_LT(d.maximum, 1.5 * error) << name(to) << " at " << d.worst.i << "," << d.worst.j;
      EXPECT_LT(d.rms, error);
    }
}

// The light of a texel reaches a little way into texels that no sample of a filter sees it in.
TEST(ChooseFilter, TheErrorHoldsBesideSunsInADarkSky) {
  std::mt19937 random(5);
  for (int k = 0; k < 24; ++k) {
    EnvironmentMap source;
    source.levels.emplace_back(Projection::latlong, 64);
    for (int j = 0; j < 64; ++j) std::ranges::fill(source.base().row(0, j), Colour(0.1F));
    *source.base().texel(0, int(random() % 128), k == 0 ? 0 : int(random() % 64)) = Colour(1e4F);
    const int size = std::array{16, 32, 45, 64}[std::size_t(k % 4)];
    const double error = k % 2 == 0 ? 0.01 : 0.1;
    const Resampler resampler(source, {.to = Projection::cube, .size = size, .max_error = error});
    const EnvironmentMap reference =
        convert(source, {.to = Projection::cube, .size = size, .filter = Filter::area, .area_error = 1e-5});
    const Difference d = compare(level_of(resampler.rows()), reference.base());
    EXPECT_LT(d.maximum, error) << k << ": face " << d.worst.face << ", " << d.worst.i << "," << d.worst.j;
  }
}

TEST(ChooseFilter, CheaperFiltersServeLargerErrors) {
  EnvironmentMap smooth;
  smooth.levels.emplace_back(Projection::latlong, 64);
  for (int j = 0; j < 64; ++j) std::ranges::fill(smooth.base().row(0, j), Colour(2));
  const ConvertOptions wanted{.to = Projection::cube, .size = 8, .max_error = 1e-3};
  EXPECT_EQ(Resampler(smooth, wanted).filter().filter, Filter::nearest);
  EXPECT_EQ(Resampler(landscape(64), wanted).filter().filter, Filter::area);
}

}  // namespace
}  // namespace envmap::choose_filter_test

// Mip levels: flux of every level, constants, and the one texel that tells whether weights are right.
#include "envmap/operate/levels.h"

#include <gtest/gtest.h>

#include "envmap/map/gutter.h"
#include "envmap/operate/measure.h"

namespace envmap {
namespace {

class EachLevels : public testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(, EachLevels, testing::ValuesIn(all_projections),
                         [](const auto& p) { return std::string(name(p.param)); });

TEST_P(EachLevels, KeepTheFluxOfASunAnywhere) {
  for (const int size : {1, 2, 3, 7, 30, 64}) {
    const int w = size * aspect(GetParam());
    for (const auto& [i, j] : {std::pair{0, 0}, {w / 2, 0}, {w / 2, size - 1}, {w - 1, size / 2}, {w / 3, size / 3}}) {
      std::vector<Level> levels{Level(GetParam(), size)};
      Level& base = levels.front();
      for (int f = 0; f < base.faces(); ++f)
        for (int row = 0; row < size; ++row) std::ranges::fill(base.row(f, row), Colour(1));
      *base.texel(base.faces() - 1, i, j) = Colour(1e6F);
      const double mean = mean_radiance(base);
      add_levels(levels);
      for (const Level& level : levels)
        EXPECT_NEAR(mean_radiance(level) / mean, 1, 1e-6)
            << size << " at " << i << "," << j << ", level of " << level.height();
    }
  }
}

TEST_P(EachLevels, KeepWhiteWhiteDownToOneTexel) {
  std::vector<Level> levels{Level(GetParam(), 45)};
  Level& base = levels.front();
  for (int f = 0; f < base.faces(); ++f)
    for (int row = 0; row < 45; ++row) std::ranges::fill(base.row(f, row), Colour(1));
  add_levels(levels);
  for (Level& level : levels) fill_gutter(level);
  // 45 22 11 5 2 1, and a latlong map ends at 1x1: 90x45 45x22 22x11 11x5 5x2 2x1 1x1.
  EXPECT_EQ(levels.size(), GetParam() == Projection::latlong ? 7U : 6U);
  for (const Level& level : levels)
    for (int f = 0; f < level.faces(); ++f)
      for (int j = -Level::gutter; j < level.height() + Level::gutter; ++j)
        for (int i = -Level::gutter; i < level.width() + Level::gutter; ++i) {
          const float x = level.texel(f, i, j)->x;
          if (x != 0 || !on_disc(GetParam())) {
            EXPECT_NEAR(x, 1, 1e-6) << level.height() << ": " << i << "," << j;
          }
        }
}

}  // namespace
}  // namespace envmap

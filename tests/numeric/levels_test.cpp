// Mip levels: flux of every level, constants, and the one texel that tells whether weights are right.
#include "envmap/operate/levels.h"

#include <gtest/gtest.h>

#include <cmath>

#include "envmap/operate/generate.h"
#include "envmap/operate/measure.h"
#include "envmap/projection/visit.h"
#include "envmap/sample/padded_level.h"

namespace envmap::levels_test {
namespace {

class EachLevels : public testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(, EachLevels, testing::ValuesIn(all_projections),
                         [](const auto& p) { return identifier(p.param); });

TEST_P(EachLevels, KeepTheFluxOfASunAnywhere) {
  for (const int size : {1, 2, 3, 7, 30, 64}) {
    const int w = size * aspect(GetParam());
    for (const auto& [i, j] : {std::pair{0, 0}, {w / 2, 0}, {w / 2, size - 1}, {w - 1, size / 2}, {w / 3, size / 3}}) {
      std::vector<Level> levels;
      levels.emplace_back(GetParam(), size);
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
  std::vector<Level> levels;
  levels.emplace_back(GetParam(), 45);
  Level& base = levels.front();
  for (int f = 0; f < base.faces(); ++f)
    for (int row = 0; row < 45; ++row) std::ranges::fill(base.row(f, row), Colour(1));
  add_levels(levels);
  // 45 22 11 5 2 1, and a latlong map ends at 1x1: 90x45 45x22 22x11 11x5 5x2 2x1 1x1.
  EXPECT_EQ(levels.size(), GetParam() == Projection::latlong ? 7U : 6U);
  for (const Level& plain : levels) {
    const PaddedLevel level(plain);
    for (int f = 0; f < level.faces(); ++f)
      for (int j = -Level::padding; j < level.height() + Level::padding; ++j)
        for (int i = -Level::padding; i < level.width() + Level::padding; ++i) {
          const float x = level.texel(f, i, j)->x;
          if (x != 0 || !on_disc(GetParam())) {
            EXPECT_NEAR(x, 1, 1e-6) << level.height() << ": " << i << "," << j;
          }
        }
  }
}

// What a texel of the rectangle [u0,u1] x [v0,v1] should hold: the mean over its part of the sphere, by the midpoints
// of a fine grid and the projection's density.
template <class F>
Colour mean_over(Projection p, int face, const Rect& r, F&& f) {
  constexpr int n = 24;
  Flux sum(0);
  double whole = 0;
  for (int b = 0; b < n; ++b)
    for (int a = 0; a < n; ++a) {
      const Point2 at[1] = {{std::lerp(r.u0, r.u1, (a + 0.5) / n), std::lerp(r.v0, r.v1, (b + 0.5) / n)}};
      double w[1];
      densities(p, at, w);
      if (w[0] == 0) continue;
      Direction d[1];
      directions(p, face, at, d);
      sum += w[0] * f(d[0]);
      whole += w[0];
    }
  return whole > 0 ? Colour(sum / whole) : Colour(0);
}

// Each texel of each level shows the part of the sphere that it covers and nothing else: no seam, no shift,
// no dark rim.
TEST_P(EachLevels, ShowTheMeanOfTheEnvironmentInEveryTexel) {
  const auto environment = [](const Direction& d) { return Flux(1 + d.x, std::exp(d.y), 1 + d.z * d.x); };
  for (const int size : {32, 45}) {
    std::vector<Level> levels;
      levels.emplace_back(GetParam(), size);
    const auto rect = [](const Level& level, int i, int j) {
      const double w = level.width(), h = level.height();
      return Rect{i / w, j / h, (i + 1) / w, (j + 1) / h};
    };
    const auto expected = [&](const Level& level, int face, int i, int j) {
      return mean_over(GetParam(), face, rect(level, i, j), environment);
    };
    Level& base = levels.front();
    for (int f = 0; f < base.faces(); ++f)
      for (int j = 0; j < base.height(); ++j)
        for (int i = 0; i < base.width(); ++i) *base.texel(f, i, j) = expected(base, f, i, j);
    add_levels(levels);
    for (const Level& level : levels)
      for (int f = 0; f < level.faces(); ++f)
        for (int j = 0; j < level.height(); ++j)
          for (int i = 0; i < level.width(); ++i) {
            const Rect r = rect(level, i, j);
            std::vector<double> w(std::size_t(level.width()));
            solid_angles(GetParam(), level.height(), j, w);
            if (w[i] <= 0.3 * w[level.width() / 2]) continue;
            // Of odd sizes, texels that straddle two are taken as constant over each part: an error of their own size.
            const double allowed = size == 45 ? 0.12 : on_disc(GetParam()) ? 0.02 : 1e-3;
            const Colour off = glm::abs(*level.texel(f, i, j) - expected(level, f, i, j));
            EXPECT_LT(std::max({off.x, off.y, off.z}), allowed)
                << level.width() << "x" << level.height() << " face " << f << ": " << i << "," << j << " at " << r.u0;
          }
  }
}

TEST(Levels, OfUniformWeightsArePlainMeansOfFour) {
  const EnvironmentMap map = generate(Directions{}, Projection::cube, 16);
  const Level& base = map.base();
  const Level half = half_level(base, Weights::uniform);
  for (int f = 0; f < 6; ++f)
    for (int j = 0; j < 8; ++j)
      for (int i = 0; i < 8; ++i) {
        const Colour *a = base.texel(f, 2 * i, 2 * j), *b = a + base.stride();
        const Colour mean = 0.25F * (a[0] + a[1] + b[0] + b[1]);
        EXPECT_LT(glm::length(*half.texel(f, i, j) - mean), 1e-6);
      }
}

TEST(Levels, OfAParaboloidGoOnBeyondItsDisc) {
  std::vector<Level> levels = generate(Directions{}, Projection::paraboloid, 64).levels;
  Level& base = levels.front();
  for (int f = 0; f < 2; ++f)  // Nothing of what other programs leave there is used.
    for (int j = 0; j < 64; ++j)
      for (int i = 0; i < 64; ++i)
        if (std::hypot(2 * i + 1 - 64, 2 * j + 1 - 64) > 66) *base.texel(f, i, j) = Colour(100);
  add_levels(levels);
  for (std::size_t k = 1; k < 4; ++k) {
    const int n = levels[k].height();
    for (int f = 0; f < 2; ++f)
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          const Direction d = Paraboloid::direction(f, (i + 0.5) / n, (j + 0.5) / n);
          EXPECT_LT(glm::length(Direction(*levels[k].texel(f, i, j)) - (0.5 + 0.5 * d)), 1.0 / n)
              << n << ": " << i << "," << j;
        }
  }
}

}  // namespace
}  // namespace envmap::levels_test

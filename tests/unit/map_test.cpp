// Levels, aprons and layouts.
#include <gtest/gtest.h>

#include <random>

#include "envmap/base/error.h"
#include "envmap/io/images/detect_layout.h"
#include "envmap/map/atlas.h"
#include "envmap/operate/generate.h"
#include "envmap/projection/visit.h"
#include "envmap/sample/padded_level.h"

namespace envmap::map_test {
namespace {

class EachApron : public testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(, EachApron, testing::ValuesIn(all_projections),
                         [](const auto& p) { return identifier(p.param); });

TEST_P(EachApron, TexelsDoNotOverlap) {
  Level level(GetParam(), 3);
  float next = 0;
  for (int f = 0; f < level.faces(); ++f)
    for (int j = 0; j < level.height(); ++j)
      for (int i = 0; i < level.width(); ++i) *level.texel(f, i, j) = Colour(++next);
  next = 0;
  for (int f = 0; f < level.faces(); ++f)
    for (int j = 0; j < level.height(); ++j)
      for (int i = 0; i < level.width(); ++i) EXPECT_EQ(level.texel(f, i, j)->x, ++next);
}

TEST_P(EachApron, PaddingLeavesTheSourceAsItWas) {
  const EnvironmentMap map = generate(Directions{}, GetParam(), 9);
  const EnvironmentMap before = map.clone();
  const PaddedLevel padded(map.base());
  for (int f = 0; f < map.base().faces(); ++f)
    for (int j = 0; j < 9; ++j) EXPECT_TRUE(std::ranges::equal(map.base().row(f, j), before.base().row(f, j)));
}

// An octahedral map goes on with the texel that lies mirrored along the side about its middle, and beyond a corner with
// the corner opposite; however small it is.
TEST(OctahedralApron, IsTheMapItself) {
  constexpr int g = Level::padding;
  for (const Projection p : {Projection::octahedral, Projection::equal_area})
    for (const int n : {1, 2, 3, 8}) {
      Level level(p, n);
      float next = 0;
      for (int j = 0; j < n; ++j)
        for (Colour& c : level.row(0, j)) c = Colour(++next);
      const PaddedLevel padded(level);
      for (int k = 0; k < n; ++k) {
        EXPECT_EQ(padded.texel(0, -1, k)->x, level.texel(0, 0, n - 1 - k)->x);
        EXPECT_EQ(padded.texel(0, n, k)->x, level.texel(0, n - 1, n - 1 - k)->x);
        EXPECT_EQ(padded.texel(0, k, -1)->x, level.texel(0, n - 1 - k, 0)->x);
        EXPECT_EQ(padded.texel(0, k, n)->x, level.texel(0, n - 1 - k, n - 1)->x);
      }
      EXPECT_EQ(padded.texel(0, -1, -1)->x, level.texel(0, n - 1, n - 1)->x);
      EXPECT_EQ(padded.texel(0, n, -1)->x, level.texel(0, 0, n - 1)->x);
      // All of it through the projection: what lies beyond is the texel that shows that direction.
      visit(p, [&](auto q) {
        using P = decltype(q);
        for (int j = -g; j < n + g; ++j)
          for (int i = -g; i < n + g; ++i) {
            const auto at = P::locate(P::direction(0, (i + 0.5) / n, (j + 0.5) / n));
            const int near_i = int(at.u * n), near_j = int(at.v * n);
            const Direction there = P::direction(0, (near_i + 0.5) / n, (near_j + 0.5) / n);
            if (glm::length(there - P::direction(0, (i + 0.5) / n, (j + 0.5) / n)) < 1e-6) {
              EXPECT_EQ(padded.texel(0, i, j)->x, level.texel(0, near_i, near_j)->x) << n << ": " << i << "," << j;
            } else {
              EXPECT_EQ(n % 2, 1) << "a middle of -Y or of a side lies in a texel's middle, found on either side of it";
            }
          }
      });
    }
}

// The apron of a map of directions must hold the directions that the projection continues to.
TEST_P(EachApron, ApronContinuesTheMap) {
  const int size = 64;
  EnvironmentMap map = generate(Directions{}, GetParam(), size);
  const PaddedLevel level(std::move(map.base()));
  visit(GetParam(), [&](auto q) {
    using P = decltype(q);
    for (int f = 0; f < P::faces; ++f)
      for (int j = -1; j <= level.height(); ++j)
        for (int i = -1; i <= level.width(); ++i) {
          const double u = (i + 0.5) / level.width(), v = (j + 0.5) / level.height();
          if (P::on_disc && std::hypot(2 * u - 1, 2 * v - 1) > 1 + 2.8 / size) continue;
          const Direction there = glm::normalize(2.0 * Direction(*level.texel(f, i, j)) - 1.0);
          // Texels of a sphere map reach over 20 degrees at the rim, where the fit is least sure.
          EXPECT_LT(angle_between(there, P::direction(f, u, v)), GetParam() == Projection::sphere ? 0.02 : 0.003)
              << f << ": " << i << "," << j;
        }
  });
}

TEST_P(EachApron, ApronOfAConstantIsThatConstant) {
  for (const int size : {1, 2, 3, 5, 16}) {
    Level constant(GetParam(), size);
    for (int f = 0; f < constant.faces(); ++f)
      for (int j = 0; j < size; ++j) {
        const Columns in = columns(GetParam(), size, j);
        for (int i = in.first; i < in.end; ++i) *constant.texel(f, i, j) = Colour(0.7F, 1, 3e-39F);
      }
    const PaddedLevel level(std::move(constant));
    for (int f = 0; f < level.faces(); ++f)
      for (int j = -1; j <= size; ++j)
        for (int i = -1; i <= level.width(); ++i) {
          if (on_disc(GetParam()) && std::hypot((2 * i + 1.0) / size - 1, (2 * j + 1.0) / size - 1) > 1 + 2.8 / size)
            continue;
          const Colour c = *level.texel(f, i, j);
          EXPECT_NEAR(c.x, 0.7F, 1e-6F) << size << ": " << i << "," << j;
          EXPECT_NEAR(c.y, 1, 1e-6F);
          EXPECT_NEAR(c.z, 3e-39F, 1e-44F);
        }
  }
}

// What lies outside the disc never gets in: poison there changes no apron texel that counts.
TEST(PaddedLevel, IgnoresWhatLiesOutsideTheDisc) {
  for (const Projection p : {Projection::sphere, Projection::angular, Projection::paraboloid}) {
    const int size = 32;
    EnvironmentMap clean = generate(Gradient{}, p, size), poisoned = clean.clone();
    for (int f = 0; f < faces(p); ++f)
      for (int j = 0; j < size; ++j)
        for (int i = 0; i < size; ++i)
          if (std::hypot((2 * i + 1.0) / size - 1, (2 * j + 1.0) / size - 1) > 1)
            *poisoned.base().texel(f, i, j) = Colour(1e30F);
    const PaddedLevel a(std::move(clean.base())), b(std::move(poisoned.base()));
    for (int f = 0; f < faces(p); ++f)
      for (int j = -1; j <= size; ++j)
        for (int i = -1; i <= size; ++i)
          if (std::hypot((2 * i + 1.0) / size - 1, (2 * j + 1.0) / size - 1) <= 1 + 2.8 / size) {
            ASSERT_EQ(*a.texel(f, i, j), *b.texel(f, i, j)) << name(p) << " " << i << "," << j;
          }
  }
}

TEST(PaddedLevel, LatlongWrapsExactlyAndCrossesThePole) {
  EnvironmentMap map;
  map.levels.emplace_back(Projection::latlong, 8);
  std::mt19937 random(3);
  for (int j = 0; j < 8; ++j)
    for (Colour& c : map.base().row(0, j)) c = Colour(float(random() % 1000));
  const PaddedLevel level(std::move(map.base()));
  for (int j = 0; j < 8; ++j) {
    EXPECT_NEAR(level.texel(0, -1, j)->x, level.texel(0, 15, j)->x, 1e-3);
    EXPECT_NEAR(level.texel(0, 17, j)->x, level.texel(0, 1, j)->x, 1e-3);
  }
  for (int i = 0; i < 16; ++i) EXPECT_NEAR(level.texel(0, i, -1)->x, level.texel(0, (i + 8) % 16, 0)->x, 1e-3);
}

TEST(Atlas, ScatterUndoesGather) {
  EnvironmentMap map = generate(Directions{}, Projection::cube, 4);
  const Rows rows = rows_of(map);
  for (const Layout layout : {Layout::column, Layout::row, Layout::cross, Layout::vcross, Layout::grid3x2}) {
    const Atlas atlas{rows, grid(layout)};
    std::vector<Colour> image(std::size_t(atlas.width() * atlas.height()));
    atlas.gather(0, atlas.height(), image);
    Level back(Projection::cube, 4);
    // In two bands, cut through a face.
    const auto cut = std::size_t(3 * atlas.width());
    scatter(std::span(image).first(cut), atlas.width(), 0, 3, atlas.grid, back);
    scatter(std::span(image).subspan(cut), atlas.width(), 3, atlas.height(), atlas.grid, back);
    for (int f = 0; f < 6; ++f)
      for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i) EXPECT_EQ(*back.texel(f, i, j), *map.base().texel(f, i, j)) << name(layout);
  }
}

// In a cross, texels that meet across a face's edge look almost the same way.
TEST(Atlas, CrossesAreTheUnfoldedCube) {
  const int n = 16;
  EnvironmentMap map = generate(Directions{}, Projection::cube, n);
  const Rows rows = rows_of(map);
  for (const Layout layout : {Layout::cross, Layout::vcross}) {
    const Atlas atlas{rows, grid(layout)};
    std::vector<Colour> image(std::size_t(atlas.width() * atlas.height()));
    atlas.gather(0, atlas.height(), image);
    int edges = 0;
    const auto check = [&](int x, int y, int x2, int y2) {
      if (x2 >= atlas.width() || y2 >= atlas.height()) return;
      const Colour a = image[y * atlas.width() + x], b = image[y2 * atlas.width() + x2];
      if (a == Colour(0) || b == Colour(0)) return;
      ++edges;
      const Direction da = glm::normalize(2.0 * Direction(a) - 1.0), db = glm::normalize(2.0 * Direction(b) - 1.0);
      EXPECT_LT(angle_between(da, db), 2.1 / n) << name(layout) << " " << x << "," << y;
    };
    for (int y = 0; y < atlas.height(); ++y)
      for (int x = n - 1; x < atlas.width(); x += n) check(x, y, x + 1, y);
    for (int y = n - 1; y < atlas.height(); y += n)
      for (int x = 0; x < atlas.width(); ++x) check(x, y, x, y + 1);
    EXPECT_EQ(edges, 5 * n) << name(layout);
  }
}

TEST(Recognise, ByShape) {
  const auto found = [](int w, int h) { return detect_layout(w, h, {}, {}); };
  EXPECT_EQ(found(64, 32).projection, Projection::latlong);
  EXPECT_EQ(found(8, 48).layout, Layout::column);
  EXPECT_EQ(found(48, 8).layout, Layout::row);
  EXPECT_EQ(found(32, 24).layout, Layout::cross);
  EXPECT_EQ(found(24, 32).layout, Layout::vcross);
  EXPECT_EQ(found(24, 16).layout, Layout::grid3x2);
  EXPECT_EQ(found(24, 16).size, 8);
  EXPECT_THROW(found(32, 32), InputError);
  EXPECT_THROW(found(1000, 600), InputError);
}

TEST(Recognise, WhatIsSaidComesFirstThenWhatIsRecorded) {
  const Metadata paraboloid{Projection::paraboloid, {}, {}}, angular{Projection::angular, {}, {}};
  EXPECT_EQ(detect_layout(64, 32, {}, paraboloid).projection, Projection::paraboloid);
  EXPECT_EQ(detect_layout(32, 32, {}, angular).projection, Projection::angular);
  EXPECT_EQ(detect_layout(32, 32, {Projection::sphere, {}, {}}, angular).projection, Projection::sphere);
  EXPECT_THROW(detect_layout(32, 32, {Projection::latlong, {}, {}}, {}), InputError);
  // Metadata that does not fit the image is not believed over the image.
  EXPECT_THROW(detect_layout(1000, 600, {}, paraboloid), InputError);
}

// ---- storage --------------------------------------------------------------------------------------------------------

TEST(Storage, AScratchFileHoldsWhatMemoryHolds) {
  for (const std::size_t limit : {std::size_t{0}, std::size_t{1}}) {  // With one byte, trim() always lets go.
    Storage s(5000, limit);
    EXPECT_EQ(s.data()[4999], Colour(0));
    for (int k = 0; k < 5000; ++k) s.data()[k] = Colour(float(k));
    s.trim();
    Storage copy = s;
    s.data()[7] = Colour(1);
    s.trim();
    EXPECT_EQ(s.data()[7].x, 1);
    EXPECT_EQ(copy.data()[7].x, 7);
    const Storage moved = std::move(copy);
    EXPECT_EQ(moved.data()[4999].x, 4999);
    EXPECT_EQ(moved.limit(), limit);
  }
}

}  // namespace
}  // namespace envmap::map_test

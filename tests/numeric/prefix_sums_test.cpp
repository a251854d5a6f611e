// Sums at the horizon against the exact sum, which integrates round the borders of texels: each within its own bound.
#include "envmap/prefilter/prefix_sums/prefix_sums.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "envmap/operate/measure.h"
#include "envmap/prefilter/exact/exact.h"
#include "envmap/prefilter/prefilter.h"
#include "envmap/prefilter/source_cube.h"
#include "envmap/prefilter/treecode/tree.h"

namespace prefix_sums_test {
namespace {

using namespace envmap;
using namespace envmap::prefiltering;

// Directions along the axes and diagonals, just beside them, and anywhere.
std::vector<Direction> directions(int count) {
  std::vector<Direction> all;
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z)
        if (x != 0 || y != 0 || z != 0)
          for (const double tilt : {0.0, 1e-9, 1e-4})
            all.push_back(unit(Direction(x, y, z) + tilt * Direction(0.3, -0.5, 0.8)));
  std::mt19937_64 random(7);
  const auto even = [&] { return double(random() >> 11) * 0x1p-52 - 1; };
  for (int k = 0; k < count; ++k) all.push_back(unit(Direction(even(), even(), even())));
  return all;
}

struct Source {
  Projection projection;
  int size;
};
std::string words(const Source& s) { return fmt::format("{} {}", name(s.projection), s.size); }

Level made(const Source& s, const std::function<float(int face, int i, int j, int channel)>& radiance) {
  Level level(s.projection, s.size);
  for (int face = 0; face < level.faces(); ++face)
    for (int j = 0; j < level.height(); ++j)
      for (int i = 0; i < level.width(); ++i)
        for (int c = 0; c < 3; ++c) (*level.texel(face, i, j))[c] = radiance(face, i, j, c);
  return level;
}

constexpr double exact_error = 5e-7;  // Of the exact sum, found in texels at poles.

// All sums within their own bounds, and bounds within the error wanted.
void expect_bounds(const Level& level, const std::vector<double>& errors, std::span<const Direction> some,
                   const std::string& what) {
  const double mean = mean_radiance(level), floor = 1e-3 * mean;
  const std::optional<Level> fine = refined(level);
  std::vector<PrefixSum> found(some.size());
  for (const LobeFormula& lobe : {LobeFormula(Cosine{}), LobeFormula(Phong{2}), LobeFormula(Phong{3})}) {
    const std::string name = what + ", power " + std::to_string(clamped_cosine_polynomial(lobe)->order());
    const std::vector<Flux> truth = exact_prefilter(level, lobe, some);
    for (const double error : errors) {
      const PrefixSums prefix_sums(fine ? *fine : level, mean, min_radiance_of(level), 3, error);
      prefix_sums.sums(*clamped_cosine_polynomial(lobe), some, error, {}, found);
      for (std::size_t n = 0; n < some.size(); ++n)
        for (int c = 0; c < 3; ++c) {
          const double most = std::max(truth[n][c], floor), bound = found[n].bound[c];
          ASSERT_NEAR(found[n].value[c], truth[n][c], bound + exact_error * most)
              << name << ", direction " << n << ", channel " << c;
          ASSERT_LE(bound, error * most * 1.0001) << name << ", direction " << n;
        }
    }
  }
}

#ifdef __SANITIZE_ADDRESS__  // Sums are those of the optimised build. Here memory is looked at.
const Source sources[] = {{Projection::latlong, 64}, {Projection::cube, 33}};
#else
const Source sources[] = {{Projection::latlong, 64},
                          {Projection::latlong, 129},
                          {Projection::cube, 64},
                          {Projection::cube, 67}};
#endif

TEST(PrefixSums, LoneLightsStayWithinTheirBounds) {
  for (const Source& s : sources) {
    const Level shape(s.projection, s.size);
    const int w = shape.width(), h = shape.height();
    // Poles or centres of faces, corners, seams, and the middle.
    const int places[][2] = {{0, 0},         {w - 1, h - 1}, {w / 2, 0}, {0, h / 2}, {w - 1, h / 2 - 1},
                             {w / 3, h / 3}, {w / 2, h / 2}};
    int count = 0;
    for (const auto& [x, y] : places) {
      const int at = count++ % shape.faces(), i = x, j = y;
      const Level level =
          made(s, [&](int f, int a, int b, int c) { return f == at && (a + c) % w == i && b == j ? 1e9F : 0.F; });
      expect_bounds(level, {1e-3, 1e-4}, directions(10), fmt::format("{} light {} {}", words(s), i, j));
    }
  }
}

TEST(PrefixSums, EveryKindOfLightStaysWithinItsBounds) {
  std::mt19937_64 random(11);
  const auto even = [&] { return float(double(random() >> 11) * 0x1p-53); };
  const std::pair<const char*, std::function<float(int, int, int, int)>> kinds[] = {
      {"even", [](int, int, int, int) { return 0.7F; }},
      {"noise", [&](int, int, int, int) { return even(); }},
      {"lamps", [&](int, int, int, int) { return even() < 0.01F ? 1e4F * even() : 0.F; }},
      {"checkers", [](int, int i, int j, int c) { return ((i >> c) + (j >> c)) % 2 == 0 ? 1.F : 0.F; }},
      {"halves", [](int face, int, int j, int c) { return face < 3 && j < 20 + 7 * c ? 2.F : 0.F; }},
      {"faint", [](int face, int i, int j, int) { return face == 0 && i == 9 && j == 21 ? 1e-6F : 1e-30F; }},
      {"subnormal", [](int, int i, int j, int) { return i == j ? 1e-44F : 0.F; }},
      {"bright", [](int, int i, int, int) { return i % 3 == 0 ? 3e38F : 1e30F; }}};
  for (const Source& s : sources)
    for (const auto& [kind, radiance] : kinds)
      expect_bounds(made(s, radiance), {s.size % 2 == 0 ? 1e-3 : 1e-4}, directions(0), words(s) + " " + kind);
}

TEST(PrefixSums, SmallestSourcesStayWithinTheirBounds) {
  for (const Source& s :
       {Source{Projection::latlong, 1}, Source{Projection::latlong, 2}, Source{Projection::latlong, 7},
        Source{Projection::cube, 1}, Source{Projection::cube, 2}, Source{Projection::cube, 5}}) {
    const Level level = made(s, [](int face, int i, int j, int c) { return float((face + 3 * i + 7 * j + c) % 5); });
    expect_bounds(level, {1e-3, 1e-5}, directions(10), words(s));
  }
}

TEST(PrefixSums, LobesThatAreClampedCosinePolynomials) {
  EXPECT_TRUE(clamped_cosine_polynomial(Cosine{}));
  EXPECT_TRUE(clamped_cosine_polynomial(Ggx(1)));
  EXPECT_TRUE(clamped_cosine_polynomial(Phong{2}));
  EXPECT_TRUE(clamped_cosine_polynomial(Phong{3}));
  EXPECT_FALSE(clamped_cosine_polynomial(Ggx(0.99)));
  EXPECT_FALSE(clamped_cosine_polynomial(Phong{1.5}));
  EXPECT_FALSE(clamped_cosine_polynomial(Charlie(1)));
  EXPECT_FALSE(clamped_cosine_polynomial(BlinnPhong(2)));
}

TEST(PrefixSums, MapsAreMadeByPrefixSumsWithTheirBounds) {
  EnvironmentMap map;
  map.levels.push_back(made({Projection::latlong, 64}, [](int, int i, int j, int c) {
    return i == 70 && j == 9 ? 1e5F : float((i + 2 * j + c) % 7);
  }));
  const Prefilterer prepared(map);
  for (const PrefilterOptions& p : {PrefilterOptions{.lobe = Lobe::diffuse()}, PrefilterOptions{.lobe = Lobe::ggx(1)},
                                    PrefilterOptions{.lobe = Lobe::phong(1)}, PrefilterOptions{.lobe = Lobe::phong(2)},
                                    PrefilterOptions{.lobe = Lobe::phong(3)}})
    for (const double error : {1e-2, 1e-4}) {
      PrefilterOptions wanted = p;
      wanted.size = 9, wanted.max_error = error;
      const Prefiltered done = prepared.make(wanted);
      EXPECT_EQ(done.method, Method::prefix_sums);
      EXPECT_LE(done.error, error);
      EXPECT_EQ(done.exact, 0);
      wanted.method = Method::exact;
      const Prefiltered truth = prepared.make(wanted);
      EXPECT_LE(compare(done.map.base(), truth.map.base()).maximum, done.error + 2e-7);
    }
}

TEST(PrefixSums, BlackStaysBlack) {
  EnvironmentMap map;
  map.levels.emplace_back(Projection::cube, 4);
  const Prefiltered done = Prefilterer(map).make({.size = 3});
  EXPECT_EQ(done.method, Method::prefix_sums);
  EXPECT_EQ(done.error, 0);
  for (const Colour& c : done.map.base().row(2, 1)) EXPECT_EQ(c, Colour(0));
}

TEST(PrefixSums, RowsComeOutAsInTheWholeMap) {
  EnvironmentMap map;
  map.levels.push_back(made({Projection::cube, 40},
                            [](int face, int i, int j, int c) { return float((face + 3 * i + 7 * j + c) % 5); }));
  PrefilterOptions wanted{.size = 6};
  const Prefiltered whole = Prefilterer(map).make(wanted);
  wanted.rows.assign(36, 0);
  wanted.rows[13] = 1;
  const Prefiltered part = Prefilterer(map).make(wanted);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(*part.map.base().texel(2, i, 1), *whole.map.base().texel(2, i, 1));
}

TEST(PrefixSums, OtherLobesAreRefused) {
  EnvironmentMap map;
  map.levels.emplace_back(Projection::cube, 4);
  EXPECT_ANY_THROW(Prefilterer(map).make({.lobe = Lobe::ggx(0.5), .size = 2, .method = Method::prefix_sums}));
}

}  // namespace
}  // namespace prefix_sums_test

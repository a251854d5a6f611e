// Multilevel sums against the exact sum: every texel within its own bound.
#include "envmap/prefilter/multilevel/multilevel.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "envmap/operate/measure.h"
#include "envmap/prefilter/exact/exact.h"
#include "envmap/prefilter/prefilter.h"
#include "envmap/prefilter/source_cube.h"
#include "narrowest_phong.h"

namespace multilevel_test {
namespace {

using namespace envmap;
using namespace envmap::prefiltering;

struct Case {
  LobeShape shape;
  double parameter;
};
std::string words(const Case& c) { return fmt::format("{} {}", lobe_shape_names[std::size_t(c.shape)], c.parameter); }

// @param radiance of face, column, row and channel.
EnvironmentMap made(Projection projection, int size,
                    const std::function<float(int face, int i, int j, int channel)>& radiance) {
  EnvironmentMap map;
  map.levels.emplace_back(projection, size);
  Level& level = map.base();
  for (int f = 0; f < level.faces(); ++f)
    for (int j = 0; j < level.height(); ++j)
      for (int i = 0; i < level.width(); ++i)
        for (int c = 0; c < 3; ++c) (*level.texel(f, i, j))[c] = radiance(f, i, j, c);
  return map;
}
EnvironmentMap made(int size, const std::function<float(int i, int j, int channel)>& radiance) {
  return made(Projection::latlong, size, [&](int, int i, int j, int c) { return radiance(i, j, c); });
}

// The exact sum itself, at poles.
constexpr double exact_error = 5e-7;

// Of a direction: where it is bright, in its lobe, and where it is at the horizon.
std::vector<Direction> around(const Direction& light, int count) {
  std::mt19937_64 random(3);
  const auto part = [&] { return double(random() >> 11) * 0x1p-53; };
  const Direction side = unit(glm::cross(light, std::abs(light.y) < 0.9 ? Direction(0, 1, 0) : Direction(1, 0, 0)));
  const Direction other = glm::cross(light, side);
  std::vector<Direction> all;
  for (int k = 0; k < count; ++k) {
    const double angle =
        k % 3 == 0 ? pi * (0.5 + 0.04 * (part() - 0.5)) : std::min(pi, std::pow(10, -3 + 3.3 * part()));
    const double turn = 2 * pi * part();
    all.push_back(unit(std::cos(angle) * light + std::sin(angle) * (std::cos(turn) * side + std::sin(turn) * other)));
  }
  return all;
}

#ifdef __SANITIZE_ADDRESS__
constexpr int field_rows = 64;
#else
constexpr int field_rows = 128;
#endif

// Each sum against the exact one. @param rows of the finest grid: the fewer, the more texels are in the core. @param
// at_nodes rows of the finest grid that is summed at its nodes.
void expect_bounds(const EnvironmentMap& map, const LobeFormula& lobe, double error, std::span<const Direction> some,
                   const std::string& what, int rows = 0, int at_nodes = field_rows) {
  // A power is cut off many widths away, and so sees more texels: it has twice the rows.
  const bool power = std::holds_alternative<Phong>(lobe) || std::holds_alternative<BlinnPhong>(lobe);
  const int most_rows = (rows > 0 ? rows : finest_rows(map.base())) * (power ? 2 : 1);
  const auto plan = multilevel_plan(lobe, error, std::min(most_rows, 2048), map.projection());
  ASSERT_TRUE(plan) << what;
  const double mean = mean_radiance(map.base());
  const SourceGrids grids(map.base(), mean, Colour(0), plan->finest());
  const std::optional<Level> fine = refined(map.base());
  const PrefixSums prefix_sums(fine ? *fine : map.base(), mean, Colour(0), 3, error);
  const MultilevelSource source{fine ? *fine : map.base(), grids, &prefix_sums, mean, Colour(0)};
  const std::vector<Flux> truth = exact_prefilter(map.base(), lobe, some);
  // Every step at the directions themselves, and coarse ones at nodes.
  for (const std::optional<NodeGrid>& field : {std::optional<NodeGrid>(), smooth_field(*plan, source, at_nodes)}) {
    std::vector<MultilevelSum> sums(some.size());
    multilevel_sums(*plan, source, field, some, sums);
    for (std::size_t k = 0; k < some.size(); ++k)
      for (int c = 0; c < 3; ++c) {
        const double most = std::max(truth[k][c], 1e-3 * mean);
        ASSERT_NEAR(sums[k].value[c], truth[k][c], (sums[k].bound + exact_error) * most)
            << what << ", direction " << k << ", channel " << c << (field ? ", at nodes" : "");
        ASSERT_LE(sums[k].bound, error) << what;
      }
  }
}

const Case cases[] = {{LobeShape::ggx, 0.001},      {LobeShape::ggx, 0.02},         {LobeShape::ggx, 0.12},
                      {LobeShape::ggx, 0.15},       {LobeShape::ggx, 0.3},          {LobeShape::ggx, 0.6},
                      {LobeShape::ggx, 0.9},        {LobeShape::phong, 4},          {LobeShape::phong, 5.5},
                      {LobeShape::phong, 20},       {LobeShape::phong, 2000},       {LobeShape::phong, 1e5},
                      {LobeShape::phong, 1e8},      {LobeShape::blinn_phong, 2},    {LobeShape::blinn_phong, 5},
                      {LobeShape::blinn_phong, 60}, {LobeShape::blinn_phong, 5000}, {LobeShape::blinn_phong, 1e6}};

#ifdef __SANITIZE_ADDRESS__  // Sums are those of the optimised build. Here memory is looked at.
const std::pair<double, int> errors_and_sizes[] = {{1e-3, 16}};
constexpr int directions = 20;
#else
const std::pair<double, int> errors_and_sizes[] = {{1e-3, 64}, {4e-4, 64}, {1e-4, 75}};
constexpr int directions = 150;
#endif

TEST(Multilevel, LoneLightsStayWithinTheirBounds) {
  for (const Case& c : cases)
    for (const auto& [error, size] : errors_and_sizes) {
      const int places[][2] = {{0, 0}, {2 * size - 1, size / 2}, {size / 3, size / 3}};
      for (const auto& [i, j] : places) {
        const EnvironmentMap map =
            made(size, [&, x = i, y = j](int a, int b, int ch) { return a == x && b == y && ch != 1 ? 1e9F : 0.F; });
        std::vector<Direction> light(1);
        texel_directions(Projection::latlong, size, 0, j, i, light);
        expect_bounds(map, formula_of(Lobe(c.shape, c.parameter)), error, around(light[0], directions),
                      fmt::format("{}, {:g}, light {} {} of {}", words(c), error, i, j, size));
      }
    }
}

// Texels far from the middle of a core are summed over fewer points.
TEST(Multilevel, CoresOfManyTexelsStayWithinTheirBounds) {
  const std::pair<Projection, int> sources[] = {{Projection::latlong, 360}, {Projection::cube, 180}};
  for (const Case& c : {Case{LobeShape::ggx, 0.001}, Case{LobeShape::ggx, 0.02}, Case{LobeShape::ggx, 0.05},
                        Case{LobeShape::phong, 900}, Case{LobeShape::phong, 3000}, Case{LobeShape::phong, 2e4},
                        Case{LobeShape::phong, 4e4}, Case{LobeShape::phong, 1e5}, Case{LobeShape::blinn_phong, 5000},
                        Case{LobeShape::blinn_phong, 6e4}})
    for (const auto& [to, size] : sources)
      for (const auto& [i, j] : {std::pair{0, 0}, {size - 1, size / 2}, {size / 3, size / 4}})
        for (const double error : {1e-3, 4e-4, 1e-4}) {
          const EnvironmentMap map = made(to, size, [&, x = i, y = j](int f, int a, int b, int ch) {
            return f == 0 && a == x && b == y && ch != 1 ? 1e9F : 0.F;
          });
          std::vector<Direction> light(1);
          texel_directions(to, size, 0, j, i, light);
          expect_bounds(map, formula_of(Lobe(c.shape, c.parameter)), error, around(light[0], directions),
                        fmt::format("{}, {:g}, light {} {} of {} {}", words(c), error, i, j, name(to), size), 128);
        }
}

// The sine of the polar angle changes most over a row just far enough from a pole for polynomials.
TEST(Multilevel, PowersBesideTheRowsOfAPoleStayWithinTheirBounds) {
  std::mt19937_64 random(13);
  const auto part = [&] { return double(random() >> 11) * 0x1p-53; };
  constexpr int size = 2048, row = 65;
  const EnvironmentMap map = made(size, [](int i, int j, int) { return i == 1000 && j == row ? 1e9F : 0.F; });
  for (const double exponent : {2e5, 797020.0}) {
    std::vector<Direction> some;
    for (int k = 0; k < directions; ++k) {
      const double polar = (row + 0.5 - 2 * part()) * pi / size, away = (5.8 + 0.6 * part()) / std::sqrt(exponent),
                   longitude = (1000.5 / size + (k % 2 == 0 ? 1 : -1) * away / std::sin(polar) / pi) * pi;
      some.emplace_back(std::sin(polar) * std::sin(longitude), std::cos(polar), -std::sin(polar) * std::cos(longitude));
    }
    expect_bounds(map, Phong{exponent}, 1e-4, some, fmt::format("phong {}", exponent), 256);
  }
}

// The narrowest lobes that grids serve are hardest, in their tails.
TEST(Multilevel, TailsOfPowersStayWithinTheirBounds) {
  std::mt19937_64 random(7);
  const auto part = [&] { return double(random() >> 11) * 0x1p-53; };
  for (const int rows : {512, 1024, 1280, 1792, 2048})
    for (const double error : {1e-3, 1e-4})
      for (const auto& [to, size] : {std::pair{Projection::latlong, 512}, {Projection::cube, 512}}) {
        const double exponent = narrowest_phong(rows, error, 2048, to);
        const int i = size / 3, j = size / 4;
        const EnvironmentMap map = made(to, size, [&](int f, int a, int b, int ch) {
          return f == 0 && a == i && b == j && ch != 1 ? 1e9F : 0.F;
        });
        std::vector<Direction> light(1), tail;
        texel_directions(to, size, 0, j, i, light);
        const Direction side = unit(glm::cross(light[0], Direction(0.6, 0, 0.8))), other = glm::cross(light[0], side);
        for (int k = 0; k < 200; ++k) {
          const double angle = (5 + 1.4 * part()) / std::sqrt(exponent), turn = 2 * pi * part();
          tail.push_back(
              unit(std::cos(angle) * light[0] + std::sin(angle) * (std::cos(turn) * side + std::sin(turn) * other)));
        }
        expect_bounds(map, formula_of(Lobe::phong(exponent)), error, tail,
                      fmt::format("phong {:g}, {:g}, {} of {}", exponent, error, name(to), size), 2048,
                      rows == 512 ? 512 : field_rows);
      }
}

TEST(Multilevel, LoneLightsOfCubesStayWithinTheirBounds) {
  for (const Case& c : cases)
    for (const int size : {16, errors_and_sizes[0].second / 2})
      for (const auto& [face, i, j] : {std::array{2, 0, 0}, std::array{1, size / 3, size - 1}}) {
        const EnvironmentMap map =
            made(Projection::cube, size, [&, x = i, y = j, at = face](int f, int a, int b, int ch) {
              return f == at && a == x && b == y && ch != 1 ? 1e9F : 0.F;
            });
        std::vector<Direction> light(1);
        texel_directions(Projection::cube, size, face, j, i, light);
        const double error = size == 16 ? 1e-3 : 1e-4;
        expect_bounds(map, formula_of(Lobe(c.shape, c.parameter)), error, around(light[0], directions),
                      fmt::format("{}, {:g}, light {} {} {} of a cube of {}", words(c), error, face, i, j, size));
      }
}

TEST(Multilevel, EveryKindOfLightStaysWithinItsBounds) {
  std::mt19937_64 random(11);
  const auto even = [&] { return float(double(random() >> 11) * 0x1p-53); };
  const std::pair<const char*, std::function<float(int, int, int)>> kinds[] = {
      {"even", [](int, int, int) { return 0.7F; }},
      {"noise", [&](int, int, int) { return even(); }},
      {"lamps", [&](int, int, int) { return even() < 0.01F ? 1e4F * even() : 0.F; }},
      {"checkers", [](int i, int j, int c) { return ((i >> c) + (j >> c)) % 2 == 0 ? 1.F : 0.F; }},
      {"half", [](int, int j, int c) { return j < 20 + 7 * c ? 2.F : 0.F; }},
      {"subnormal", [](int i, int j, int) { return i == j ? 1e-44F : 0.F; }},
      {"bright", [](int i, int, int) { return i % 3 == 0 ? 3e38F : 1e30F; }}};
  const std::vector<Direction> some = around(unit(Direction(0.3, 0.8, -0.2)), directions / 4);
  constexpr int size = 40;
  for (const Case& c : cases)
    for (const auto& [kind, radiance] : kinds)
      expect_bounds(made(size, radiance), formula_of(Lobe(c.shape, c.parameter)), 1e-3, some, words(c) + " " + kind);
}

// Nodes of a row share their kernels.
TEST(Multilevel, SumsOfARowAreThoseOfItsNodes) {
  const EnvironmentMap map = made(48, [](int i, int j, int c) { return float((i * 7 + j * 3 + c) % 11); });
  const SourceGrids grids(map.base(), mean_radiance(map.base()), Colour(0), 128);
  for (const auto& [shape, parameter] :
       {Case{LobeShape::ggx, 0.2}, Case{LobeShape::ggx, 0.5}, Case{LobeShape::phong, 300}}) {
    const auto plan = multilevel_plan(formula_of(Lobe(shape, parameter)), 1e-3, 256);
    ASSERT_TRUE(plan);
    GatherBuffers buffers;
    for (const int rows : {64, 128})
      for (const MultilevelPlan::Step& step : plan->steps)
        for (int row = 0; row < rows; row += row < 20 ? 1 : 7) {
          const NodeGrid& grid = grids.grid(rows);
          std::vector<Flux> sums(std::size_t(grid.columns[std::size_t(row)]), Flux(1));
          gather_at_row(grid, step.kernel, row, buffers, sums);
          for (std::size_t k = 0; k < sums.size(); ++k) {
            const Flux one = gather(grid, step.kernel, grid.node(row, int(k)), buffers);
            for (int c = 0; c < 3; ++c)
              ASSERT_NEAR(sums[k][c], 1 + one[c], 2e-6 * (1 + one[c])) << rows << ", row " << row << ", node " << k;
          }
        }
  }
}

// A field of low harmonics comes back, at poles too.
TEST(Multilevel, InterpolationFollowsSmoothFields) {
  NodeGrid grid(64);
  const auto value = [](const Direction& d) { return Flux(1 + d.x, d.y * d.z, std::exp(2 * d.x - d.z)); };
  const auto direction = [](const GridView& v) {
    return Direction(v.sine * std::sin(v.longitude), std::cos(v.angle), -v.sine * std::cos(v.longitude));
  };
  for (int row = 0; row < 64; ++row) {
    for (int k = 0; k < grid.columns[std::size_t(row)]; ++k)
      for (int c = 0; c < 3; ++c) grid.channel(row, c)[k] = float(value(direction(grid.node(row, k)))[c]);
    grid.repeat_columns(row);
  }
  for (const Direction& d : around(Direction(0, 1, 0), 200))
    for (const Direction& n : {d, -d})
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(interpolate(grid, GridView(n))[c], value(n)[c], 3e-6);
}

TEST(Multilevel, MapsStateTheirBound) {
  const EnvironmentMap map =
      made(48, [](int i, int j, int c) { return i == 7 && j == 3 ? 1e6F : float((i * 7 + j * 3 + c) % 11); });
  for (const Projection to : {Projection::cube, Projection::latlong}) {
    PrefilterOptions wanted{.lobe = Lobe::ggx(0.16), .to = to, .size = 6, .method = Method::multilevel};
    const Prefiltered done = Prefilterer(map).make(wanted);
    EXPECT_EQ(done.method, Method::multilevel);
    EXPECT_GT(done.error, 0);
    EXPECT_LE(done.error, 1e-3);
    wanted.method = Method::exact;
    EXPECT_LE(compare(done.map.base(), Prefilterer(map).make(wanted).map.base(), nullptr).maximum, done.error);
  }
}

TEST(Multilevel, BlackStaysBlackAndWhiteStaysWhite) {
  for (const float light : {0.F, 1.F}) {
    const EnvironmentMap map = made(20, [&](int, int, int) { return light; });
    const Prefiltered done = Prefilterer(map).make({.lobe = Lobe::ggx(0.16), .size = 3, .method = Method::multilevel});
    for (int f = 0; f < 6; ++f)
      for (const Colour& c : done.map.base().row(f, 1)) EXPECT_NEAR(c.x, light, 1e-6);
  }
}

TEST(Multilevel, AutoTakesItForNarrowLobes) {
  const EnvironmentMap map = made(16, [](int i, int j, int) { return float((i + j) % 3); });
  const auto method = [&](LobeShape shape, double parameter, double error) {
    // One row of 64: the method is that of the whole map.
    std::vector<char> rows(6 * 64);
    rows[0] = 1;
    return Prefilterer(map).make({.lobe = Lobe(shape, parameter), .size = 64, .rows = rows, .max_error = error}).method;
  };
  EXPECT_EQ(method(LobeShape::ggx, 0.01, 1e-3), Method::multilevel);
  EXPECT_EQ(method(LobeShape::ggx, 0.2, 1e-3), Method::multilevel);
  EXPECT_EQ(method(LobeShape::ggx, 0.8, 1e-4), Method::multilevel);
  EXPECT_EQ(method(LobeShape::phong, 200, 1e-3), Method::multilevel);
  EXPECT_EQ(method(LobeShape::phong, 2, 1e-3), Method::prefix_sums);
  EXPECT_EQ(method(LobeShape::ggx, 0.6, 1e-3), Method::multilevel);
  EXPECT_EQ(method(LobeShape::phong, 3.5, 1e-3), Method::treecode);
  EXPECT_EQ(method(LobeShape::ggx, 0.8, 9e-5), Method::treecode);
  EXPECT_EQ(method(LobeShape::charlie, 0.5, 1e-3), Method::treecode);
}

// Nothing of them is left to a treecode.
TEST(Multilevel, AutoTakesPrefixSumsForDiffuseMaps) {
  const EnvironmentMap map =
      made(Projection::cube, 16, [](int f, int i, int j, int) { return float((f + i + j) % 3); });
  const auto method = [&](int size, double error) {
    std::vector<char> rows(std::size_t(6 * size));
    rows[0] = 1;
    return Prefilterer(map).make({.lobe = Lobe::diffuse(), .size = size, .rows = rows, .max_error = error}).method;
  };
  EXPECT_EQ(method(16, 1e-3), Method::prefix_sums);
  EXPECT_EQ(method(128, 1e-5), Method::prefix_sums);
  EXPECT_EQ(method(128, 1e-3), Method::prefix_sums);
}

TEST(Multilevel, LobesThatHaveNoBound) {
  for (const Case& c : {Case{LobeShape::charlie, 0.5}, Case{LobeShape::phong, 3}, Case{LobeShape::blinn_phong, 1},
                        Case{LobeShape::diffuse, unset_parameter}})
    EXPECT_FALSE(multilevel_plan(formula_of(Lobe(c.shape, c.parameter)), 1e-3)) << words(c);
  EXPECT_FALSE(multilevel_plan(Ggx(0.3), 9e-5));
}

}  // namespace
}  // namespace multilevel_test

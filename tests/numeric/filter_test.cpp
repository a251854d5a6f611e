// The filters: constants, directions, flux and agreement with the reference, and what each of them promises.
#include "envmap/sample/filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "envmap/operate/convert.h"
#include "envmap/operate/generate.h"
#include "envmap/operate/levels.h"
#include "envmap/operate/measure.h"
#include "envmap/projection/matching_size.h"
#include "envmap/projection/visit.h"
#include "envmap/sample/point.h"
#include "envmap/sample/pyramid.h"
#include "envmap/sample/summed_area.h"
#include "formulae.h"

namespace envmap::filter_test {
namespace {

// But for area, which convert_test.cpp and area_test.cpp are about.
std::vector<Filter> every_filter() {
  std::vector<Filter> all;
  for (const FilterInfo& f : filters())
    if (f.filter != Filter::area) all.push_back(f.filter);
  return all;
}

EnvironmentMap noise(Projection p, int height) {
  EnvironmentMap map;
  map.levels.emplace_back(p, height);
  std::mt19937 random(3);
  for (int f = 0; f < map.base().faces(); ++f)
    for (int j = 0; j < height; ++j)
      for (Colour& c : map.base().row(f, j)) c = Colour(0.1F + float(random() % 1000) / 1000);
  return map;
}

class EachFilter : public testing::TestWithParam<std::tuple<Filter, Projection>> {
 protected:
  Filter filter_ = std::get<0>(GetParam());
  Projection from_ = std::get<1>(GetParam());
};
INSTANTIATE_TEST_SUITE_P(, EachFilter,
                         testing::Combine(testing::ValuesIn(every_filter()), testing::ValuesIn(all_projections)),
                         [](const auto& p) {
                           std::string filter(name(std::get<0>(p.param)));
                           std::ranges::replace(filter, '-', '_');
                           return filter + "_from_" + identifier(std::get<1>(p.param));
                         });

TEST_P(EachFilter, ConstantStaysConstantAtAnySize) {
  for (const Projection to : all_projections)
    for (const auto& [size, result_size] : {std::pair{1, 3}, {2, 1}, {5, 8}, {37, 4}, {48, 48}}) {
      EnvironmentMap source = generate(Constant{}, from_, size);
      const EnvironmentMap result = convert(source, {.to = to, .size = result_size, .filter = filter_});
      for (int f = 0; f < result.base().faces(); ++f)
        for (int j = 0; j < result_size; ++j) {
          const Columns in = columns(to, result_size, j);
          for (int i = in.first; i < in.end; ++i)
            for (int c = 0; c < 3; ++c)
              ASSERT_NEAR((*result.base().texel(f, i, j))[c], 1, 1e-6)
                  << size << " to " << name(to) << " " << result_size;
        }
    }
}

// The code of the direction is linear in it: its mean over a small texel is the code of the middle, and a seam, a flip
// or a texel from the wrong face would show at once.
TEST_P(EachFilter, DirectionsStayWhereTheyAreOnTheWayDown) {
  const bool of_levels = filter_ == Filter::trilinear || filter_ == Filter::nearest_level;
  const bool round = of_levels || filter_ == Filter::sat;  // Blurs along a pole's rows.
  if (from_ == Projection::sphere) GTEST_SKIP() << "texels at its rim span tens of degrees";
  if (from_ == Projection::angular && of_levels) GTEST_SKIP() << "so do those of its rim along it";
  EnvironmentMap source = generate(Directions{}, from_, matching_size(Projection::latlong, 128, from_));
  for (const Projection to : all_projections) {
    const int size = matching_size(Projection::latlong, 48, to);
    const EnvironmentMap result = convert(source, {.to = to, .size = size, .filter = filter_});
    double worst = 0;
    for (int f = 0; f < result.base().faces(); ++f)
      for (int j = 0; j < size; ++j)
        for (int i = 0; i < result.base().width(); ++i) {
          if (!formulae::in_image(to, size, i, j)) continue;
          // Where texels are long, the mean of the directions and the direction of the middle part.
          if (to == Projection::sphere && std::hypot(2 * i + 1 - size, 2 * j + 1 - size) > 0.8 * size) continue;
          const auto d =
              formulae::rounded(formulae::direction(to, f, (i + 0.5L) / result.base().width(), (j + 0.5L) / size));
          worst =
              std::max(worst, angle_between(glm::normalize(2.0 * Direction(*result.base().texel(f, i, j)) - 1.0), d));
        }
    EXPECT_LT(worst / (pi / 48), filter_ == Filter::nearest ? 0.6
                                 : round                    ? 1.1
                                                            : 0.35)
        << "in texels of the result, to " << name(to);
  }
}

TEST_P(EachFilter, KeepsTheFluxOfASmoothEnvironment) {
  EnvironmentMap source =
      generate(Harmonic{.degree = 3, .order = 1}, from_, matching_size(Projection::latlong, 64, from_));
  const double flux = mean_radiance(source.base());
  for (const int size : {16, 64}) {
    const EnvironmentMap result = convert(source, {.to = Projection::cube, .size = size, .filter = filter_});
    EXPECT_NEAR(mean_radiance(result.base()) / flux, 1,
                filter_ == Filter::trilinear || filter_ == Filter::nearest_level ? 1e-2 : 3e-3);
  }
}

// Against the reference where a texel covers 4 x 4 of noise: what a filter is chosen for.
TEST(Filters, EachHasItsErrorInMinification) {
  const auto error = [](Filter filter, int samples) {
    const EnvironmentMap source = noise(Projection::latlong, 128);
    const EnvironmentMap truth = convert(source, {.to = Projection::cube, .size = 16, .filter = Filter::area});
    return compare(convert(source, {.to = Projection::cube, .size = 16, .filter = filter, .samples = samples}).base(),
                   truth.base())
        .rms;
  };
  EXPECT_GT(error(Filter::nearest, 1), 0.4);
  EXPECT_GT(error(Filter::bilinear, 1), 0.2);
  EXPECT_LT(error(Filter::trilinear, 1), 0.1);
  EXPECT_LT(error(Filter::sat, 1), 0.07);
  EXPECT_LT(error(Filter::ewa, 1), 0.04);
  EXPECT_LT(error(Filter::bilinear, 4), 0.04);
  EXPECT_LT(error(Filter::bilinear, 16), 0.003);
}

TEST(Bicubic, PassesThroughTexelsAndIsBetterThanBilinearBetween) {
  double cubic = 0, linear = 0;
  EnvironmentMap map = generate(Harmonic{.degree = 4, .order = 2}, Projection::latlong, 64);
  const PaddedLevel level(map.base());
  for (int k = 0; k < 200; ++k) {
    const double u = 0.1 + 0.004 * k, v = 0.2 + 0.003 * k;
    const double truth =
        1 + 0.5 * real_harmonic(4, 2, formulae::rounded(formulae::direction(Projection::latlong, 0, u, v)));
    cubic += std::abs(bicubic(level, {0, u, v}).x - truth);
    linear += std::abs(bilinear(level, {0, u, v}).x - truth);
    const Location<double> centre{0, (k % 128 + 0.5) / 128, (k % 64 + 0.5) / 64};
    EXPECT_NEAR(bicubic(level, centre).x, map.base().texel(0, k % 128, k % 64)->x, 1e-6);
  }
  EXPECT_LT(cubic, 0.15 * linear);
}

TEST(Bicubic, DoesNotRingRoundASun) {
  Level sun(Projection::latlong, 16);
  for (int j = 0; j < 16; ++j) std::ranges::fill(sun.row(0, j), Colour(1));
  *sun.texel(0, 16, 8) = Colour(1e9F);
  const PaddedLevel level(std::move(sun));
  for (int k = 0; k < 1000; ++k) {
    const Colour c = bicubic(level, {0, 0.4 + 0.0002 * k, 0.4 + 0.0002 * k});
    EXPECT_GE(c.x, 1);
    EXPECT_LE(c.x, 1e9F);
  }
}

TEST(Trilinear, IsBilinearOnALevelAndBetweenLevels) {
  EnvironmentMap map = noise(Projection::cube, 16);
  add_levels(map.levels);
  std::vector<PaddedLevel> levels;
  for (const Level& level : map.levels) levels.emplace_back(level);
  ASSERT_EQ(levels.size(), 5U);
  const Location<double> at{3, 0.3, 0.71};
  const auto trilinear = [&](double lod) {
    Colour out;
    sample_trilinear(levels, {&at, 1}, lod, {&out, 1});
    return out;
  };
  for (std::size_t l = 0; l < levels.size(); ++l)
    EXPECT_EQ(trilinear(double(l)).x, bilinear(levels[l], at).x);
  EXPECT_NEAR(trilinear(1.25).x, 0.75 * bilinear(levels[1], at).x + 0.25 * bilinear(levels[2], at).x, 1e-6);
  EXPECT_EQ(trilinear(99).x, bilinear(levels[4], at).x);
}

// Right of and below a sun, sums in float would hold nothing but the sun.
TEST(SummedArea, KeepsTheSkyBesideASun) {
  Level sun(Projection::latlong, 64);
  for (int j = 0; j < 64; ++j) std::ranges::fill(sun.row(0, j), Colour(1));
  *sun.texel(0, 20, 20) = Colour(1e8F);
  const SummedArea table(PaddedLevel(std::move(sun)), 4);
  for (int k = 0; k < 500; ++k) EXPECT_NEAR(table.mean({0, 0.3 + 0.0013 * k, 0.4 + 0.001 * k}, {2, 2}).x, 1, 1e-6);
}

TEST(SummedArea, BoxesOfWholeTexelsAreTheirMeans) {
  EnvironmentMap map = noise(Projection::cube, 8);
  const SummedArea table(PaddedLevel(map.base()), 4);
  double sum = 0, weight = 0;
  for (int j = 2; j < 6; ++j)
    for (int i = 2; i < 4; ++i) {
      const double w = Cube::solid_angle({i / 8.0, j / 8.0, (i + 1) / 8.0, (j + 1) / 8.0});
      sum += w * map.base().texel(5, i, j)->x;
      weight += w;
    }
  EXPECT_NEAR(table.mean({5, 3 / 8.0, 4 / 8.0}, {1, 2}).x, sum / weight, 2e-3);
}

}  // namespace
}  // namespace envmap::filter_test

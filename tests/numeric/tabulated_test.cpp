// Tabulated lobes against closed forms, against the lobes that they are samples of, and against sums over points that
// share no code with them.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "envmap/base/error.h"
#include "envmap/operate/generate.h"
#include "envmap/operate/measure.h"
#include "envmap/prefilter/exact/exact.h"
#include "envmap/prefilter/harmonics.h"
#include "envmap/prefilter/prefilter.h"
#include "formulae.h"
#include "numeric/landscape.h"

namespace envmap::tabulated_test {
namespace {

using numeric_tests::landscape;
using Samples = std::vector<LobeSample>;

template <class Value>
Samples sampled(int count, const Value& value) {
  Samples samples;
  for (int k = 0; k <= count; ++k) samples.push_back({double(k) / count, value(double(k) / count)});
  return samples;
}

const Samples zigzag{{1, 1}, {0.97, 0}, {0.9, 3}, {0.6, 0.5}, {0.55, 2}, {0.2, 0.1}};
const Samples cone{{1, 1}, {0.7, 1}};

// Calls f with the direction and the value of each texel.
template <class F>
void each_texel(const Level& level, const F& f) {
  for (const Texel& t : texels_of(level)) {
    Direction d[1];
    texel_directions(level.projection(), level.height(), t.face, t.j, t.i, d);
    f(d[0], *level.texel(t.face, t.i, t.j));
  }
}

// 1 above the horizon, 0 below it.
EnvironmentMap upper_half(Projection projection, int size) {
  EnvironmentMap map = generate(Constant{Direction(1)}, projection, size);
  Level& level = map.base();
  for (const Texel& t : texels_of(level)) {
    Direction d[1];
    texel_directions(projection, size, t.face, t.j, t.i, d);
    if (d[0].y < 0) *level.texel(t.face, t.i, t.j) = Colour(0);
  }
  return map;
}

// The part of a cone of half angle a that lies above a plane through its tip. @param tilt of the cone's axis from the
// plane's normal. By the area of two caps' intersection (Mazonka 2012, "Solid angle of conical surfaces, polyhedral
// cones, and intersecting spherical caps").
double cone_above(double a, double tilt) {
  if (tilt <= pi / 2 - a) return 1;
  if (tilt >= pi / 2 + a) return 0;
  const double area = 2 * (pi - std::acos(std::cos(tilt) / std::sin(a)) -
                           std::cos(a) * std::acos(-std::cos(tilt) * std::cos(a) / (std::sin(tilt) * std::sin(a))));
  return area / (2 * pi * (1 - std::cos(a)));
}

class EachSource : public testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(Tabulated, EachSource, testing::Values(Projection::latlong, Projection::cube),
                         [](const auto& p) { return identifier(p.param); });

TEST_P(EachSource, WhiteStaysWhiteUnderEveryTable) {
  const EnvironmentMap white = generate(Constant{Direction(0.25, 1, 3)}, GetParam(), 10);
  for (const Samples& table : {zigzag, cone, Samples{{0, 0}, {1, 1e-300}}, Samples{{1, 1e300}, {1 - 1e-8, 0}}})
    each_texel(Prefilterer(white).make({.lobe = Lobe::table(table), .size = 3}).map.base(),
               [](const Direction&, const Colour& c) {
                 EXPECT_NEAR(c.x, 0.25, 1e-7);
                 EXPECT_NEAR(c.y, 1, 3e-7);
                 EXPECT_NEAR(c.z, 3, 1e-6);
               });
}

TEST_P(EachSource, AConeSeesThePartOfASkyThatItsClosedFormSays) {
  const EnvironmentMap sky = upper_half(GetParam(), 16);
  for (const auto& [error, size] : {std::pair(1e-2, 3), std::pair(1e-3, 1)}) {
    const Prefiltered done = Prefilterer(sky).make({.lobe = Lobe::table(cone), .size = size, .max_error = error});
    EXPECT_EQ(done.method, Method::treecode);
    EXPECT_LE(done.error, error);
    EXPECT_GT(done.error, 0);
    each_texel(done.map.base(), [&](const Direction& r, const Colour& c) {
      const double truth = cone_above(std::acos(0.7), std::acos(r.y));
      EXPECT_NEAR(double(c.x), truth, done.error * std::max(truth, 5e-4)) << r.y;
    });
  }
}

// Chords over a convex lobe of step h are above it by up to h^2/8 of its second derivative.
TEST_P(EachSource, ATableOfPhongIsPhongToItsChords) {
  constexpr double m = 20, error = 5e-4, integral = 2 * pi / (m + 1);
  const EnvironmentMap sky = landscape(GetParam(), 24);
  const double mean = measure(sky).mean.y, floor = 1e-3 * mean_radiance(sky.base());
  for (const int count : {50, 1000}) {
    const Lobe table = Lobe::table(sampled(count, [](double u) { return std::pow(u, m); }));
    const Prefiltered done = Prefilterer(sky).make({.lobe = table, .size = 2, .max_error = error});
    const double chord = m * (m - 1) / (8.0 * count * count);
    each_texel(done.map.base(), [&](const Direction& r, const Colour& c) {
      const double phong = prefiltering::exact_prefilter(sky.base(), formula_of(Lobe::phong(m)), std::span(&r, 1))[0].y;
      const double of_chords = chord * (4 * pi * mean + 2 * pi * phong) / integral;
      EXPECT_NEAR(double(c.y), phong, of_chords + error * std::max(double(c.y), floor)) << count;
    });
  }
}

// The lobe once more, over points of all texels.
double value_at(const Samples& falling, double cosine) {
  for (std::size_t k = 1; k < falling.size(); ++k)
    if (cosine >= falling[k].cosine)
      return std::lerp(falling[k].value, falling[k - 1].value,
                       (cosine - falling[k].cosine) / (falling[k - 1].cosine - falling[k].cosine));
  return 0;
}

TEST_P(EachSource, AgreesWithSumsOverPoints) {
  const EnvironmentMap sky = landscape(GetParam(), 12);
  const Level& level = sky.base();
  const Prefiltered done = Prefilterer(sky).make({.lobe = Lobe::table(zigzag), .size = 1});
  EXPECT_LE(done.error, 1e-3);
  constexpr int points = 32;
  each_texel(done.map.base(), [&](const Direction& r, const Colour& found) {
    double sum = 0, weights = 0;
    for (const Texel& t : texels_of(level))
      for (int k = 0; k < points * points; ++k) {
        const double u = (t.i + (k % points + 0.5) / points) / level.width(),
                     v = (t.j + (k / points + 0.5) / points) / level.height();
        const Point2 at[1] = {{u, v}};
        double density[1];
        densities(GetParam(), at, density);
        const double weight =
            density[0] *
            value_at(zigzag, glm::dot(formulae::rounded(formulae::direction(GetParam(), t.face, u, v)), r));
        sum += weight * double(level.texel(t.face, t.i, t.j)->x), weights += weight;
      }
    EXPECT_NEAR(double(found.x) / (sum / weights), 1, 4e-3);
  });
}

TEST(Tabulated, SmallErrorsAreMetOrRefused) {
  const EnvironmentMap sky = landscape(Projection::latlong, 16);
  const Prefilterer prepared(sky);
  const Prefiltered fine = prepared.make({.lobe = Lobe::table(zigzag), .size = 1, .max_error = 1e-5});
  EXPECT_LE(fine.error, 1e-5);
  EXPECT_THROW((void)prepared.make({.lobe = Lobe::table(zigzag), .size = 1, .max_error = 1e-7}), UsageError);
  for (const Method m : {Method::exact, Method::prefix_sums, Method::multilevel})
    EXPECT_THROW((void)prepared.make({.lobe = Lobe::table(zigzag), .size = 1, .method = m}), UsageError);
}

TEST(Tabulated, ABlackMapStaysBlack) {
  const EnvironmentMap black = generate(Constant{Direction(0)}, Projection::cube, 8);
  const Prefiltered done = Prefilterer(black).make({.lobe = Lobe::table(cone), .size = 2});
  each_texel(done.map.base(), [](const Direction&, const Colour& c) { EXPECT_EQ(c, Colour(0)); });
  EXPECT_EQ(done.error, 0);
}

TEST(Tabulated, AScaleMultipliesTheNormalisedLobe) {
  const EnvironmentMap white = generate(Constant{Direction(1)}, Projection::cube, 8);
  const Prefiltered done = Prefilterer(white).make({.lobe = Lobe::table(zigzag), .scale = 2.5, .size = 1});
  EXPECT_NEAR(double(done.map.base().texel(0, 0, 0)->x), 2.5, 1e-6);
}

TEST(Tabulated, RowsOfATurnedMapAreThoseOfTheWhole) {
  const EnvironmentMap sky = landscape(Projection::cube, 10);
  PrefilterOptions wanted{.lobe = Lobe::table(zigzag),
                          .to = Projection::latlong,
                          .size = 4,
                          .forward = Forward::minus_x};
  const Prefiltered whole = Prefilterer(sky).make(wanted);
  wanted.rows = {0, 1, 0, 0};
  const Prefiltered part = Prefilterer(sky).make(wanted);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(*part.map.base().texel(0, i, 1), *whole.map.base().texel(0, i, 1));
}

// Chords change degree l by as much as they change the lobe, and its integral.
TEST(Tabulated, DegreesAreThoseOfTheLobe) {
  const std::vector<double> table = zonal(Lobe::table(sampled(2000, [](double u) { return std::pow(u, 20); })), 40),
                            phong = zonal(Lobe::phong(20), 40);
  for (std::size_t l = 0; l < table.size(); ++l) EXPECT_NEAR(table[l], phong[l], 5e-4) << l;
  // Of a cone: (P_(l-1) - P_(l+1))(c) / ((2l + 1) (1 - c)), here of degrees 1 and 2.
  const std::vector<double> of_cone = zonal(Lobe::table(cone), 2);
  EXPECT_NEAR(of_cone[0], 1, 1e-12);
  EXPECT_NEAR(of_cone[1], (1 + 0.7) / 2, 1e-12);
  EXPECT_NEAR(of_cone[2], 0.5 * 0.7 * (1 + 0.7), 1e-12);
}

TEST(Tabulated, SamplesThatAreNoLobeAreRefused) {
  const auto refuses = [](const std::string& words, Samples samples) {
    try {
      (void)Lobe::table(std::move(samples));
      ADD_FAILURE() << words;
    } catch (const UsageError& e) {
      EXPECT_EQ(e.what(), words);
    }
  };
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  refuses("a table needs two samples or more, not 1", {{1, 1}});
  refuses("sample 2: cosine must be 0 to 1, not -0.5", {{1, 1}, {-0.5, 1}});
  refuses("sample 2: cosine must be 0 to 1, not nan", {{1, 1}, {nan, 1}});
  refuses("sample 1: value must be finite and not negative, not -1", {{1, -1}, {0.5, 1}});
  refuses("sample 1: value must be finite and not negative, not inf", {{1, infinity}, {0.5, 1}});
  refuses("sample 3: cosines must fall by 1e-9 or more: 0.5 follows 0.5", {{1, 1}, {0.5, 1}, {0.5, 2}});
  refuses("sample 3: cosines must rise by 1e-9 or more: 0.25 follows 0.5", {{0, 1}, {0.5, 1}, {0.25, 2}, {1, 1}});
  refuses("a table needs a sample at cosine 1 (angle 0): the largest cosine is 0.75", {{0.75, 1}, {0.5, 1}});
  refuses("a table needs a value above 0", {{1, 0}, {0.5, 0}});
  EXPECT_THROW((void)Lobe(LobeShape::table), UsageError);
  const Lobe lobe = Lobe::table(zigzag);
  EXPECT_EQ(lobe.samples().front().cosine, 0.2) << "by rising cosine";
  EXPECT_TRUE(std::isnan(lobe.parameter()));
}

}  // namespace
}  // namespace envmap::tabulated_test

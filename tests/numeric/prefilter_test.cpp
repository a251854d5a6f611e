// Prefiltered maps against sums written here from the definitions, closed forms, furnaces, symmetry and flux.
#include "envmap/prefilter/prefilter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "envmap/operate/convert.h"
#include "envmap/operate/generate.h"
#include "envmap/operate/measure.h"
#include "envmap/prefilter/exact/exact.h"
#include "envmap/prefilter/source_cube.h"
#include "formulae.h"
#include "numeric/landscape.h"

namespace envmap {

using prefiltering::exact_prefilter;

namespace prefilter_test {
namespace {

using numeric_tests::landscape;

// ---- the definitions once more --------------------------------------------------------------------------------------

// The lobe times its factor, of the cosine between the direction asked for and that of the light; not normalised.
double kernel(const PrefilterOptions& p, double cosine) {
  if (cosine <= 0) return 0;
  switch (p.lobe.shape()) {
    case LobeShape::diffuse: return cosine;
    case LobeShape::phong: return std::pow(cosine, p.lobe.parameter());
    // n.h of half the angle.
    case LobeShape::blinn_phong: return std::pow(std::sqrt(0.5 * (1 + cosine)), p.lobe.parameter()) * cosine;
    case LobeShape::charlie:
      return std::pow(std::sqrt(0.5 * (1 - cosine)), 1 / (p.lobe.parameter() * p.lobe.parameter())) * cosine;
    case LobeShape::ggx:
    case LobeShape::table: break;
  }
  const double alpha = p.lobe.parameter() * p.lobe.parameter(),
               nh2 = 0.5 * (1 + cosine);  // The half vector leans half as far.
  const double d = nh2 * (alpha * alpha - 1) + 1;
  return alpha * alpha / (pi * d * d) * cosine;
}

// Points of all texels, n x n each.
struct Points {
  std::vector<Direction> directions;
  std::vector<double> weights;
  std::vector<Colour> light;

  Points(const Level& source, int n) {
    const double w = source.width() * n, h = source.height() * n;
    for (int face = 0; face < source.faces(); ++face)
      for (int j = 0; j < source.height() * n; ++j)
        for (int i = 0; i < source.width() * n; ++i) {
          const double u = (i + 0.5) / w, v = (j + 0.5) / h;
          const Point2 at[1] = {{u, v}};
          double density[1];
          densities(source.projection(), at, density);
          if (density[0] == 0) continue;
          directions.push_back(formulae::rounded(formulae::direction(source.projection(), face, u, v)));
          weights.push_back(density[0] / (w * h));
          light.push_back(*source.texel(face, i / n, j / n));
        }
  }
};

// Integral of L x kernel / that of the kernel.
Flux brute_force(const Points& points, const PrefilterOptions& p, const Direction& r) {
  long double whole = 0, sums[3] = {};
  for (std::size_t k = 0; k < points.weights.size(); ++k) {
    const double weight = points.weights[k] * kernel(p, glm::dot(points.directions[k], r));
    whole += weight;
    for (int c = 0; c < 3; ++c) sums[c] += weight * points.light[k][c];
  }
  return {double(sums[0] / whole), double(sums[1] / whole), double(sums[2] / whole)};
}

// What is prefiltered: the map, or the cube that stands for it.
EnvironmentMap source_of(EnvironmentMap map) {
  std::optional<EnvironmentMap> cube = prefiltering::source_cube(map);
  return cube ? std::move(*cube) : std::move(map);
}

Direction direction_of(const PrefilterOptions& p, int face, int i, int j) {
  Direction d[1];
  texel_directions(p.to, p.size, face, j, i, d);
  return d[0];
}

double relative(const Flux& a, const Flux& b, double floor) {
  double worst = 0;
  for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(a[c] - b[c]) / std::max(b[c], floor));
  return worst;
}

const PrefilterOptions lobes[] = {{.lobe = Lobe::diffuse()},        {.lobe = Lobe::phong(0.01), .max_error = 1e-2},
                                  {.lobe = Lobe::phong(3.7)},       {.lobe = Lobe::phong(60)},
                                  {.lobe = Lobe::ggx(0.35)},        {.lobe = Lobe::ggx(1)},
                                  {.lobe = Lobe::blinn_phong(0.8)}, {.lobe = Lobe::blinn_phong(90)},
                                  {.lobe = Lobe::charlie(1)},       {.lobe = Lobe::charlie(0.3)}};

std::string words(const PrefilterOptions& p) {
  return std::string(lobe_shape_names[std::size_t(p.lobe.shape())]) + " " + std::to_string(p.lobe.parameter());
}

class EachPrefilter : public testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(, EachPrefilter, testing::ValuesIn(all_projections),
                         [](const auto& p) { return identifier(p.param); });

// ---- right ----------------------------------------------------------------------------------------------------------

TEST_P(EachPrefilter, AgreesWithTheDefinition) {
  const EnvironmentMap source = source_of(landscape(GetParam(), 12));
  const double floor = 1e-3 * mean_radiance(source.base());
  const Prefilterer prepared(source);
  const Points points(source.base(), 48);
  for (PrefilterOptions p : lobes) {
    p.to = GetParam() == Projection::cube ? Projection::latlong : Projection::cube;
    p.size = 4;
    const Prefiltered done = prepared.make(p);
    EXPECT_LE(done.error, p.max_error) << words(p);
    for (const auto& [i, j] : {std::pair{0, 0}, {1, 2}, {3, 3}}) {
      const Direction r = direction_of(p, 0, i, j);
      const Flux truth = brute_force(points, p, r);
      const Flux exact = exact_prefilter(source.base(), formula_of(p.lobe), std::span(&r, 1))[0];
      // Points on the horizon of the brute force count whole or not at all: of a sun up to 1 / (48 points).
      const double tolerance = p.lobe.parameter() == 0.01 ? 5e-2 : 3e-3;
      EXPECT_LT(relative(exact, truth, floor), tolerance) << words(p) << " exact at " << i << "," << j;
      EXPECT_LT(relative(Flux(*done.map.base().texel(0, i, j)), exact, floor), 1.5 * p.max_error)
          << words(p) << " at " << i << "," << j;
    }
  }
}

TEST_P(EachPrefilter, WhiteStaysWhite) {
  const EnvironmentMap white = generate(Constant{Direction(1)}, GetParam(), 9);
  const Prefilterer prepared(white);
  std::vector<Direction> some;
  for (int face = 0; face < 6; ++face) some.push_back(direction_of({.size = 5}, face, face % 3, 4 - face % 2));
  for (const LobeShape shape :
       {LobeShape::diffuse, LobeShape::phong, LobeShape::ggx, LobeShape::blinn_phong, LobeShape::charlie})
    for (const double parameter : {0.0, 0.5, 1.0, 1e3, 1e6, 1e8}) {
      const bool rough = shape == LobeShape::ggx || shape == LobeShape::charlie;
      if ((shape == LobeShape::diffuse && parameter > 0) || (rough && parameter > 1)) continue;
      const PrefilterOptions p{.lobe = Lobe(shape, shape == LobeShape::diffuse ? unset_parameter : parameter),
                               .size = 2,
                               .max_error = 1e-2};
      const Prefiltered done = prepared.make(p);
      for (int face = 0; face < 6; ++face)
        for (int j = 0; j < p.size; ++j)
          for (const Colour& c : done.map.base().row(face, j))
            for (int k = 0; k < 3; ++k) ASSERT_NEAR(c[k], 1, 1e-6) << words(p);
      if (p.lobe.is_mirror()) continue;
      for (const Flux& c : exact_prefilter(prepared.source().base(), formula_of(p.lobe), some))
        ASSERT_NEAR(c.x, 1, 1e-6) << words(p);
    }
}

TEST(Prefilter, HalfAWhiteSphereGivesOnePlusCosineOverTwo) {
  EnvironmentMap half;
  half.levels.emplace_back(Projection::latlong, 64);
  for (int j = 0; j < 32; ++j) std::ranges::fill(half.base().row(0, j), Colour(1));
  const Prefilterer prepared(half);
  const PrefilterOptions p{.size = 16, .max_error = 1e-4};
  const Prefiltered done = prepared.make(p);
  for (int face = 0; face < 6; ++face)
    for (int j = 0; j < 16; ++j)
      for (int i = 0; i < 16; ++i) {
        const double truth = 0.5 * (1 + direction_of(p, face, i, j).y);
        EXPECT_NEAR(done.map.base().texel(face, i, j)->x, truth, 1e-4 * std::max(truth, 5e-4));
      }
}

TEST(Prefilter, OneTexelGivesTheLobe) {
  // A small texel is a point: the result is its flux times the lobe, whose factor --scale replaces.
  EnvironmentMap map;
  map.levels.emplace_back(Projection::cube, 256);
  *map.base().texel(4, 128, 128) = Colour(1e6F);
  double omega[256];
  solid_angles(Projection::cube, 256, 128, omega);
  Direction sun[1];
  texel_directions(Projection::cube, 256, 4, 128, 128, sun);
  const Prefilterer prepared(map);
  for (PrefilterOptions p :
       {PrefilterOptions{.lobe = Lobe::phong(8)}, {.lobe = Lobe::phong(8), .scale = 2}, {.scale = 3}}) {
    p.size = 8;
    const Prefiltered done = prepared.make(p);
    const double factor = p.lobe.shape() == LobeShape::diffuse ? 3 / pi : p.scale.value_or(9 / (2 * pi));
    for (int i = 0; i < 8; ++i) {
      const double truth = 1e6 * omega[128] * factor * kernel(p, glm::dot(sun[0], direction_of(p, 4, i, 3)));
      EXPECT_NEAR(done.map.base().texel(4, i, 3)->x, truth, 1.5e-3 * truth) << words(p);
    }
  }
}

// M = 2: cos (1 + cos) / 2 over its integral, 5 pi / 6.
TEST(Prefilter, BlinnPhongIsItsClosedForm) {
  const BlinnPhong two(2);
  for (const double x : {0.0, 1e-6, 0.3, 0.9, 0.9999999, 1.0, 1.5}) {
    const double c = std::max(0.0, 1 - x);
    EXPECT_NEAR(two.value(x), 3 * c * (1 + c) / (5 * pi), 1e-15) << x;
    EXPECT_NEAR(two.missing(x), (3 * c * c + 2 * c * c * c) / 5, 1e-13 * c * c) << x;
    EXPECT_NEAR(two.share(x), 1 - (3 * c * c + 2 * c * c * c) / 5, 1e-15) << x;
  }
  for (const double m : {1e-3, 0.5, 7.0, 300.0, 1e5, 1e9}) {
    const BlinnPhong lobe(m);
    EXPECT_NEAR(lobe.missing(0), 1, 1e-12) << m;
    for (const double x : {1e-10, 1e-4, 0.2, 0.99})
      EXPECT_NEAR(lobe.share(x) + lobe.missing(x), 1, 1e-12) << m << " " << x;
  }
}

// a = 1/2: x (1 - x) over its integral, pi / 3; of any a all of the lobe is 1, and its peak at p / (p + 1).
TEST(Prefilter, CharlieIsItsClosedForm) {
  const Charlie half(std::sqrt(0.5));
  for (const double x : {0.0, 1e-9, 0.3, 0.9, 0.9999999, 1.0, 1.5}) {
    const double y = std::max(0.0, 1 - x);
    EXPECT_NEAR(half.value(x), 3 / pi * x * y, 1e-15) << x;
    EXPECT_NEAR(half.missing(x), y * y * (3 - 2 * y), 1e-13 * y * y) << x;
    EXPECT_NEAR(half.share(x), x < 1 ? x * x * (3 - 2 * x) : 1, 1e-15 * std::max(1e-10, x)) << x;
  }
  for (const double roughness : {0.0, 0.1, 0.4, 1.0}) {
    const Charlie lobe(roughness);
    EXPECT_NEAR(lobe.missing(0), 1, 1e-15);
    for (const double x : {1e-3, 0.5, 0.9, 0.99, 0.9999})
      EXPECT_NEAR(lobe.share(x) + lobe.missing(x), 1, 1e-12) << roughness << " " << x;
    EXPECT_GT(lobe.value(lobe.peak()), lobe.value(lobe.peak() - 1e-4));
    EXPECT_GT(lobe.value(lobe.peak()), lobe.value(lobe.peak() + 1e-4));
  }
}

// As glTF's sampler draws half vectors, sin(n,h) = u^(a / (2 a + 1)), and weighs light by cos(n,l):
// the mean of a gradient.
TEST(Prefilter, CharlieIsWhatHalfVectorsSample) {
  const EnvironmentMap map = generate(Gradient{Direction(0), Direction(1)}, Projection::cube, 64);  // (1 + y) / 2.
  const Prefilterer prepared(map);
  for (const double roughness : {0.3, 0.7, 1.0}) {
    const double a = roughness * roughness;
    constexpr int count = 100000;
    double sum = 0, weight = 0;
    for (int k = 0; k < count; ++k) {
      const double sine = std::pow((k + 0.5) / count, a / (2 * a + 1)), cosine = 1 - 2 * sine * sine;  // Of n and l.
      if (cosine > 0) sum += cosine * cosine, weight += cosine;
    }
    const Prefiltered done = prepared.make({.lobe = Lobe::charlie(roughness), .size = 3, .max_error = 1e-4});
    EXPECT_NEAR(done.map.base().texel(2, 1, 1)->x, 0.5 + 0.5 * sum / weight, 3e-4) << roughness;
  }
}

// Nothing is reflected from straight ahead: of a sun there, no more than its size lets through.
TEST(Prefilter, CharlieRisesWithTheAngle) {
  EnvironmentMap map;
  map.levels.emplace_back(Projection::cube, 64);
  *map.base().texel(4, 32, 32) = Colour(1e6F);
  const Prefiltered done = Prefilterer(map).make({.lobe = Lobe::charlie(0.5), .size = 32});
  Direction sun[1];
  texel_directions(Projection::cube, 64, 4, 32, 32, sun);
  double omega[64];
  solid_angles(Projection::cube, 64, 32, omega);
  for (const Texel& t : texels_of(done.map.base())) {
    const double x = 1 - glm::dot(sun[0], direction_of({.size = 32}, t.face, t.i, t.j));
    if (std::abs(1 - x) < 0.05) continue;  // The horizon cuts the sun.
    const double truth = 1e6 * omega[32] * 12 / (2 * pi) * std::max(0.0, 1 - x) * x * x;
    EXPECT_NEAR(done.map.base().texel(t.face, t.i, t.j)->x, truth, 0.03 * truth + 1e-3 * 80);
  }
}

TEST(Prefilter, AGradientKeepsItsMeanAndLosesSlope) {
  // L = a + b y: convolution keeps a and multiplies b with the lobe's first moment, (m+1)/(m+2) for Phong, 2/3 diffuse.
  const EnvironmentMap map = generate(Gradient{Direction(0.5), Direction(1.5)}, Projection::latlong, 128);
  const Prefilterer prepared(map);
  for (const auto& [p, slope] : {std::pair{PrefilterOptions{.size = 8}, 2.0 / 3},
                                 {PrefilterOptions{.lobe = Lobe::phong(9), .size = 8}, 10.0 / 11}}) {
    const Prefiltered done = prepared.make(p);
    for (int face = 0; face < 6; ++face)
      for (int j = 0; j < 8; ++j)
        EXPECT_NEAR(done.map.base().texel(face, 3, j)->x, 1 + 0.5 * slope * direction_of(p, face, 3, j).y, 1e-3);
  }
}

TEST(Prefilter, ManyErrorsAskedForHoldAgainstTheExactSum) {
  const EnvironmentMap source = landscape(Projection::cube, 32, 5e4F);
  const double floor = 1e-3 * mean_radiance(source.base());
  const Prefilterer prepared(source);
  for (PrefilterOptions p : lobes)
    for (const double error : {1e-2, 1e-4}) {
      if (p.lobe.parameter() == 0.01 && error < 1e-2) continue;  // Seconds.
      p.size = 8;
      p.max_error = error;
      const Prefiltered done = prepared.make(p);
      ASSERT_LE(done.error, p.max_error);
      std::vector<Direction> d;
      std::vector<Flux> found;
      for (int k = 0; k < 24; ++k) {
        d.push_back(direction_of(p, k % 6, (k * 5) % 8, (k * 3) % 8));
        found.emplace_back(*done.map.base().texel(k % 6, (k * 5) % 8, (k * 3) % 8));
      }
      const std::vector<Flux> truth = exact_prefilter(source.base(), formula_of(p.lobe), d);
      for (std::size_t k = 0; k < d.size(); ++k)
        EXPECT_LT(relative(found[k], truth[k], floor), 1.2 * error) << words(p);
    }
}

TEST(Prefilter, TurningTheSourceTurnsTheResult) {
  EnvironmentMap source = landscape(Projection::cube, 24);
  // A quarter turn about +Y takes faces to faces, texel for texel.
  EnvironmentMap turned =
      convert(source, {.to = Projection::cube, .size = 24, .filter = Filter::nearest, .rotation = rotation(90, 0, 0)});
  for (PrefilterOptions p : {lobes[0], lobes[3], lobes[4]}) {
    p.size = 8;
    Prefiltered a = Prefilterer(source).make(p), b = Prefilterer(turned).make(p);
    const EnvironmentMap c =
        convert(a.map, {.to = Projection::cube, .size = 8, .filter = Filter::nearest, .rotation = rotation(90, 0, 0)});
    EXPECT_LT(compare(b.map.base(), c.base()).maximum, 2e-3) << words(p);
  }
}

TEST(Prefilter, PhongKeepsTheFlux) {
  const EnvironmentMap source = landscape(Projection::latlong, 32);
  const Flux before = measure(source).flux;
  const Prefilterer prepared(source);
  for (const auto& [exponent, size] : {std::pair{1.0, 64}, {50.0, 96}}) {
    const Prefiltered done =
        prepared.make({.lobe = Lobe::phong(exponent), .size = size, .method = Method::treecode, .max_error = 1e-3});
    const Flux after = measure(done.map).flux;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(after[c] / before[c], 1, 1e-4) << exponent;
  }
}

TEST(Prefilter, ResolutionOfTheSourceChangesNothing) {
  EnvironmentMap coarse = landscape(Projection::latlong, 32), fine;
  fine.levels.emplace_back(Projection::latlong, 128);
  for (int j = 0; j < 128; ++j)
    for (int i = 0; i < 256; ++i) *fine.base().texel(0, i, j) = *coarse.base().texel(0, i / 4, j / 4);
  for (PrefilterOptions p : lobes) {
    p.size = 8;
    const Prefiltered a = Prefilterer(coarse).make(p), b = Prefilterer(fine).make(p);
    EXPECT_LT(compare(a.map.base(), b.map.base()).maximum, 2 * p.max_error) << words(p);
  }
}

// ---- extremes -------------------------------------------------------------------------------------------------------

TEST(Prefilter, NarrowLobesTendToTheMirror) {
  const EnvironmentMap source = landscape(Projection::cube, 4);
  const Prefilterer prepared(source);
  for (PrefilterOptions p :
       {PrefilterOptions{.lobe = Lobe::phong(1e8)}, {.lobe = Lobe::ggx(0.001)}, {.lobe = Lobe::ggx(0)}}) {
    p.size = 4;
    const Prefiltered done = prepared.make(p);
    const Direction d = direction_of(p, 2, 1, 2);
    EXPECT_LT(compare(done.map.base(), source.base()).maximum, 2e-3) << words(p);
    if (p.lobe.is_mirror()) continue;
    EXPECT_LT(relative(exact_prefilter(source.base(), formula_of(p.lobe), std::span(&d, 1))[0],
                       Flux(*source.base().texel(2, 1, 2)), 1e-3),
              1e-4);
  }
}

// A sun in few texels must not fall between the samples of a mirror's level. The source counts by its own sums.
TEST(Prefilter, AMirrorKeepsFluxWithinItsError) {
  for (const Projection from : {Projection::latlong, Projection::cube})
    for (const Projection to : {Projection::cube, Projection::octahedral})
      for (const int size : {6, 12, 40}) {
        EnvironmentMap source = generate(Constant{Direction(0.1)}, from, 24);
        *source.base().texel(0, 17, 9) = Colour(5000, 4000, 3000);
        const Prefiltered done = Prefilterer(source).make({.lobe = Lobe::ggx(0), .to = to, .size = size});
        SCOPED_TRACE(testing::Message() << name(from) << " to " << name(to) << " of " << size);
        EXPECT_EQ(method_name(done), "area");
        const Flux there = flux(source.base()), here = flux(done.map.base());
        // The bilinear reconstruction is off by 2e-3.
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(here[c] / there[c], 1, 4e-3);
        const EnvironmentMap truth =
            convert(source, {.to = {to}, .size = size, .filter = Filter::area, .area_error = 1e-7});
        EXPECT_GT(done.error, 0);
        EXPECT_LE(compare(done.map.base(), truth.base()).maximum, done.error);
      }
}

TEST(Prefilter, AMirrorOfTheSourcesOwnTexelsCopiesThem) {
  const EnvironmentMap source = landscape(Projection::cube, 8);
  const Prefiltered done = Prefilterer(source).make({.lobe = Lobe::ggx(0), .size = 8});
  EXPECT_EQ(compare(done.map.base(), source.base()).maximum, 0);
  EXPECT_EQ(done.error, 0);
  EXPECT_EQ(method_name(done), "nearest");
}

TEST(Prefilter, ANarrowLobeOnAnEdgeSeesHalfOfEitherSide) {
  EnvironmentMap map;
  map.levels.emplace_back(Projection::cube, 1);
  for (int face = 0; face < 6; ++face) *map.base().texel(face, 0, 0) = Colour(float(face));
  const Direction d = glm::normalize(Direction(1, 0.1, 1));  // Between +X, 0, and +Z, 4.
  for (const LobeFormula& lobe : {LobeFormula(Phong{1e4}), LobeFormula(Phong{1e8}), LobeFormula(Ggx(0.01))})
    EXPECT_NEAR(exact_prefilter(map.base(), lobe, std::span(&d, 1))[0].x, 2, 1e-3);
}

// A lobe of exponent 1e8 is a Gaussian 1e-4 wide. Beside the corner of a lone texel, between two sides at right angles,
// it comes to two error integrals, however far out the direction is and however large the texel.
TEST(Prefilter, BesideACornerAVeryNarrowLobeHasItsGaussianTail) {
  constexpr double exponent = 1e8, width = 1e-4;
  const auto beyond = [](double deviations) { return 0.5 * std::erfc(deviations / std::numbers::sqrt2); };
  for (const int size : {4, 64, 256})
    for (const double out : {-2.0, 0.3, 3.0, 6.0})
      for (const double in : {-4.0, 0.0, 2.5}) {
        EnvironmentMap map;
        map.levels.emplace_back(Projection::cube, size);
        *map.base().texel(0, size / 2, size / 2) = Colour(1e9F);  // On +X: z from 0 to 2 / size, y below 0.
        const double z = 2.0 / size, length = std::sqrt(1 + z * z);
        const Direction side(-z / length, 0, 1 / length), corner(1 / length, 0, z / length);
        const Direction r = glm::normalize(corner + width * out * side - Direction(0, width * in, 0));
        const double truth = 1e9 * beyond(out) * beyond(-in);
        EXPECT_NEAR(exact_prefilter(map.base(), Phong{exponent}, std::span(&r, 1))[0].x, truth, 3e-5 * truth)
            << size << " " << out << " " << in;
      }
}

// Where one half of the sphere is white and the other 0.1: the lobe's sum over rings,
// of each the part that lies in the white half.
double at_an_edge(const PrefilterOptions& p, double height) {  // Sine of the angle that the direction is from the edge.
  double white = 0, whole = 0;
  constexpr int rings = 200000;
  for (int k = 0; k < rings; ++k) {  // Equal steps of the logarithm of the angle.
    const double angle = 1e-7 * std::pow(0.5 * pi / 1e-7, (k + 0.5) / rings);
    const double weight = angle * std::sin(angle) * kernel(p, std::cos(angle));
    const double edge = -height / std::sqrt(1 - height * height) / std::tan(angle);
    whole += weight, white += weight * std::acos(std::clamp(edge, -1.0, 1.0)) / pi;
  }
  return 0.1 + 0.9 * white / whole;
}

TEST(Prefilter, LobesNarrowerThanTheTexelsOfACoarseMapAreRight) {
  EnvironmentMap map;
  map.levels.emplace_back(Projection::latlong, 32);
  for (int j = 0; j < 32; ++j)
    for (int i = 0; i < 64; ++i) *map.base().texel(0, i, j) = Colour(i < 32 ? 1.F : 0.1F);  // x > 0 is white.
  const Prefilterer prepared(map);
  for (PrefilterOptions p : {PrefilterOptions{.lobe = Lobe::ggx(0.02)},
                             {.lobe = Lobe::ggx(0.08)},
                             {.lobe = Lobe::phong(1e5)},
                             {.lobe = Lobe::blinn_phong(1e4)}}) {
    p.method = Method::treecode, p.to = Projection::cube, p.size = 15, p.max_error = 1e-4;
    const Prefiltered done = prepared.make(p);
    for (int i = 0; i < p.size; ++i) {
      const Direction d = direction_of(p, 4, i, 5);
      const double truth = at_an_edge(p, d.x);
      EXPECT_NEAR(done.map.base().texel(4, i, 5)->x, truth, p.max_error * truth) << words(p) << " " << i;
    }
  }
}

// Such a cube is what stands in scenes for no environment at all.
TEST(Prefilter, ACubeOfSixTexelsIsRight) {
  const EnvironmentMap map = generate(Directions{}, {Projection::cube}, 1);
  const Prefilterer prepared(map);
  for (const double roughness : {0.1, 0.3, 0.7}) {
    PrefilterOptions p{.lobe = Lobe::ggx(roughness), .to = Projection::cube, .size = 3, .max_error = 1e-3};
    const Prefiltered done = prepared.make(p);
    p.method = Method::exact;
    EXPECT_LE(compare(done.map.base(), prepared.make(p).map.base()).maximum, 1e-3) << roughness;
  }
}

TEST(Prefilter, ExponentNoughtSeesThePartOfASunAboveTheHorizon) {
  // A sun of one texel on the equator, black round it: for exponent 0 a direction on the equator gets what of its
  // longitudes lies within a quarter turn, over 2 pi.
  EnvironmentMap map;
  map.levels.emplace_back(Projection::latlong, 16);
  for (const int j : {7, 8}) *map.base().texel(0, 5, j) = Colour(1e9F);
  const double height = 2 * std::sin(pi / 16), width = 2 * pi / 32, middle = 2 * pi * (0.5 - 5.5 / 32);
  const Prefilterer prepared(map);
  const Prefiltered done =
      prepared.make({.lobe = Lobe::phong(0), .to = Projection::latlong, .size = 17, .max_error = 1e-2});
  EXPECT_LE(done.error, 1e-2);
  const double floor = 1e-3 * mean_radiance(map.base());
  for (int i = 0; i < 34; ++i) {
    const double off = std::abs(std::remainder(2 * pi * (0.5 - (i + 0.5) / 34) - middle, 2 * pi));
    const double seen = std::clamp(0.5 + (pi / 2 - off) / width, 0.0, 1.0),
                 truth = 1e9 / (2 * pi) * height * width * seen;
    EXPECT_NEAR(done.map.base().texel(0, i, 8)->x, truth, 1.2e-2 * std::max(truth, floor)) << i;
  }
}

// The sides of a wedge at a pole all but cancel where a steep lobe has only its tail there,
// and a sun shows what is left.
TEST(Prefilter, TheTailOfASteepLobeOverAPoleIsNoDifferenceOfLargeNumbers) {
  EnvironmentMap map;
  map.levels.emplace_back(Projection::latlong, 18);
  *map.base().texel(0, 0, 17) = Colour(4e7F);
  const Direction r = direction_of({.to = Projection::latlong, .size = 24}, 0, 6, 22);
  constexpr int n = 600;
  constexpr double exponent = 2240;
  double truth = 0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double u = (i + 0.5) / (36 * n), v = (17 + (j + 0.5) / n) / 18;
      const Direction l = formulae::rounded(formulae::direction(Projection::latlong, 0, u, v));
      const double solid_angle = 2 * pi * pi * std::sin(pi * v) / (36 * 18 * double(n) * n);
      truth += 4e7 * solid_angle * (exponent + 1) / (2 * pi) * std::pow(std::max(0.0, glm::dot(r, l)), exponent);
    }
  EXPECT_NEAR(exact_prefilter(map.base(), Phong{exponent}, std::span(&r, 1))[0].x, truth, 1e-4 * truth);
}

// Many directions take points by SIMD; one takes each texel by itself; texels cut in four by four see a lobe that is
// four times as even. All but one texel are dark, so that what the tail of a lobe makes of a sun shows.
TEST(Prefilter, TheExactSumIsTheSameInAnyNumberOfDirectionsAndOfAnyCutTexels) {
  const EnvironmentMap map = landscape(Projection::cube, 20, 1e6F);
  const Level& source = map.base();
  Level cut(Projection::cube, 4 * source.height());
  for (int face = 0; face < 6; ++face)
    for (int j = 0; j < cut.height(); ++j)
      for (int i = 0; i < cut.width(); ++i) *cut.texel(face, i, j) = *source.texel(face, i / 4, j / 4);
  std::vector<Direction> all;
  for (int k = 0; k < 11; ++k)
    all.push_back(glm::normalize(Direction(std::sin(k), std::cos(3 * k), std::sin(2 * k + 1))));
  for (const LobeFormula& lobe :
       {LobeFormula(Cosine{}), LobeFormula(Phong{0}), LobeFormula(Phong{0.2}), LobeFormula(Phong{7.9}),
        LobeFormula(Phong{8}), LobeFormula(Phong{45}), LobeFormula(Phong{700}), LobeFormula(Phong{1e5}),
        LobeFormula(Ggx(0.1)), LobeFormula(Ggx(0.4)), LobeFormula(Ggx(1)), LobeFormula(BlinnPhong(30)),
        LobeFormula(Charlie(1)), LobeFormula(Charlie(0.2))}) {
    const std::vector<Flux> together = exact_prefilter(source, lobe, all), finer = exact_prefilter(cut, lobe, all);
    for (std::size_t k = 0; k < all.size(); ++k) {
      const Flux alone = exact_prefilter(source, lobe, std::span(all).subspan(k, 1))[0];
      const double floor = 1e-6 * mean_radiance(source);  // The tail of a steep lobe need not be closer than 1e-13.
      EXPECT_LT(relative(together[k], alone, floor), 2e-7) << k << ", lobe " << lobe.index();
      EXPECT_LT(relative(together[k], finer[k], floor), 2e-7) << k << ", lobe " << lobe.index();
    }
  }
}

TEST_P(EachPrefilter, MapsOnADiscArePrefilteredAsTheirCube) {
  const EnvironmentMap map = landscape(GetParam(), 40);
  const bool disc = GetParam() != Projection::cube && GetParam() != Projection::latlong;
  const EnvironmentMap cube = convert(map, {.to = {Projection::cube}, .filter = Filter::area});
  const PrefilterOptions p{.lobe = Lobe::ggx(0.4), .size = 6};
  const Prefiltered a = Prefilterer(map).make(p), b = Prefilterer(disc ? cube : map).make(p);
  for (int face = 0; face < 6; ++face)
    for (int j = 0; j < p.size; ++j)
      EXPECT_TRUE(std::ranges::equal(a.map.base().row(face, j), b.map.base().row(face, j)));
}

// What exact sums make of a map that is 0.5 but for a few texels: white stays white, and the rest is soon summed.
std::vector<Flux> exact_of_suns(const Level& map, const LobeFormula& lobe, std::span<const Direction> directions) {
  Level source = map.clone();
  for (int face = 0; face < source.faces(); ++face)
    for (int j = 0; j < source.height(); ++j)
      for (Colour& c : source.row(face, j)) {
        c -= Colour(0.5F);
        if (glm::length(c) < 1e-6F) c = Colour(0);
      }
  std::vector<Flux> found = exact_prefilter(source, lobe, directions);
  for (Flux& f : found) f += Flux(0.5);
  return found;
}

// Suns where they are hard: looked at through the tail of a lobe, from the pole or the corner itself, at the rim of a
// disc. In every texel.
TEST(Prefilter, SunsAtPolesCornersSeamsAndRimsAreRightInEveryTexel) {
  struct Sun {
    int i, j;
    float radiance;
  };
  struct Case {
    Projection projection;
    int size;
    std::vector<Sun> suns;
    PrefilterOptions wanted;
  };
  const PrefilterOptions tail{.lobe = Lobe::phong(30), .size = 24};
  const PrefilterOptions rim{.lobe = Lobe::ggx(0.3), .to = Projection::latlong, .size = 32, .max_error = 1e-2};
  for (const Case& c :
       {Case{Projection::latlong, 48, {{40, 0, 1e6F}}, {.lobe = Lobe::ggx(0.2), .size = 3}},
        Case{Projection::latlong, 128, {{17, 40, 1e9F}}, tail},
        Case{Projection::cube, 24, {{0, 0, 1e9F}}, {.lobe = Lobe::phong(10), .size = 6}},
        Case{Projection::cube, 24, {{23, 11, 1e9F}}, {.size = 6, .max_error = 1e-4}},
        Case{Projection::cube, 16, {{11, 9, 1e9F}}, {.lobe = Lobe::ggx(0.001), .size = 16}},
        // A black texel: what is even is known no more, and a lobe of 1e-6 radians looks along all nodes.
        Case{Projection::cube, 16, {{11, 9, 1e9F}, {2, 3, 0}}, {.lobe = Lobe::ggx(0.001), .size = 16}},
        Case{Projection::sphere, 64, {{3, 35, 159}, {63, 26, 2.26e6F}, {62, 24, 1.16e6F}}, rim}}) {
    EnvironmentMap map = generate(Constant{Direction(0.5)}, c.projection, c.size);
    for (const Sun& sun : c.suns) *map.base().texel(0, sun.i, sun.j) = Colour(sun.radiance);
    const Prefilterer prepared(map);
    const Level& source = prepared.source().base();
    const double floor = 1e-3 * mean_radiance(source);
    const Prefiltered done = prepared.make(c.wanted);
    EXPECT_LE(done.error, c.wanted.max_error);
    std::vector<Direction> d;
    std::vector<Flux> found;
    for (const Texel& t : texels_of(done.map.base())) {
      d.push_back(direction_of(c.wanted, t.face, t.i, t.j));
      found.emplace_back(*done.map.base().texel(t.face, t.i, t.j));
    }
    const std::vector<Flux> truth = exact_of_suns(source, formula_of(c.wanted.lobe), d);
    double worst = 0;
    for (std::size_t k = 0; k < d.size(); ++k) worst = std::max(worst, relative(found[k], truth[k], floor));
    EXPECT_LT(worst, c.wanted.max_error) << name(c.projection) << " " << words(c.wanted);
  }
}

// Of a treecode whose nodes are all off the same way: a horizon along the edge of a lit half, coloured patterns, whose
// channels spread unlike each other in every node, and a pattern round a pole, as seen from there.
TEST(Prefilter, LightThatRepeatsIsRightInEveryTexel) {
  const auto half = [](const Texel& /*t*/, const Direction& d) { return Colour(d.x < 0 ? 1e6F : 0.5F); };
  const auto checkers = [](const Texel& t, const Direction& /*d*/) {
    return t.i % 2 == t.j % 2 ? Colour(1, 0, 0.3F) : Colour(0, 1, 0.3F);
  };
  const auto stripes = [](const Texel& t, const Direction& /*d*/) {
    return t.i * 4 % 5 + t.j % 3 < 3 ? Colour(1, 0, 0.3F) : Colour(0, 1, 0.3F);
  };
  const auto rows = [](const Texel& t, const Direction& /*d*/) {
    return Colour(t.j % 8 < 3 ? 100.F : 1.F, t.j % 4 < 1 ? 10.F : 1.F, 1);
  };
  const auto beside_a_sun = [](const Texel& t, const Direction& d) {
    return Colour(t.face == 0 && d.z < -0.68 && std::abs(d.y) < 0.05 ? 1e6F : (t.i + t.j) % 2 ? 1.F : 0.F);
  };
  struct Case {
    Projection from;
    int size;
    std::function<Colour(const Texel&, const Direction&)> light;
    double exponent;
  };
  for (const Case& c : {Case{Projection::latlong, 128, half, 1},
                        {Projection::cube, 32, half, 1},
                        {Projection::cube, 48, checkers, 2},
                        {Projection::cube, 24, stripes, 2},
                        {Projection::latlong, 128, rows, 34},
                        {Projection::cube, 24, beside_a_sun, 7.35}}) {
    EnvironmentMap map;
    map.levels.emplace_back(c.from, c.size);
    Level& level = map.base();
    for (const Texel& t : texels_of(level)) {
      const double u = (t.i + 0.5) / level.width(), v = (t.j + 0.5) / level.height();
      *level.texel(t.face, t.i, t.j) = c.light(t, formulae::rounded(formulae::direction(c.from, t.face, u, v)));
    }
    PrefilterOptions p;
    p.lobe = Lobe::phong(c.exponent), p.method = Method::treecode;
    p.to = Projection::cube, p.size = 5;
    const Prefilterer source(map);
    std::vector<Direction> all;
    const std::vector<Texel> texels = texels_of(Level(p.to, p.size));
    for (const Texel& t : texels)
      all.push_back(formulae::rounded(formulae::direction(p.to, t.face, (t.i + 0.5) / p.size, (t.j + 0.5) / p.size)));
    const std::vector<Flux> truth = exact_prefilter(level, formula_of(p.lobe), all);
    for (const double error : {1e-3, 1e-4}) {
      p.max_error = error;
      const Prefiltered fast = source.make(p);
      double worst = 0;
      for (std::size_t n = 0; n < all.size(); ++n) {
        const Flux found(*fast.map.base().texel(texels[n].face, texels[n].i, texels[n].j)),
            off = glm::abs(found - truth[n]);
        for (int k = 0; k < 3; ++k) worst = std::max(worst, off[k] / std::max(truth[n][k], fast.floor));
      }
      EXPECT_LE(worst, 0.7 * error) << name(c.from) << " " << c.size << ", exponent " << c.exponent;
      // The exact sum is quicker where a dark texel sees the rim of bright light: seldom.
      EXPECT_LE(fast.exact, int(all.size()) / 10);
    }
  }
}

TEST(Prefilter, SunsOfAnyStrengthAndBlackAreFinite) {
  for (const float sun : {1e4F, 1e9F}) {
    const EnvironmentMap source = landscape(Projection::latlong, 32, sun);
    const Prefilterer prepared(source);
    for (PrefilterOptions p : lobes) {
      p.size = 8;
      const Prefiltered done = prepared.make(p);
      EXPECT_LE(done.error, p.max_error) << words(p);
      EXPECT_EQ(find_flaws(done.map.base()).count(), 0) << words(p);
    }
  }
  for (const double value : {0.0, 1e-42}) {
    const EnvironmentMap source = generate(Constant{Direction(value)}, Projection::cube, 1);
    for (PrefilterOptions p : lobes) {
      p.size = 2;
      const Prefiltered done = Prefilterer(source).make(p);
      EXPECT_EQ(find_flaws(done.map.base()).count(), 0);
      EXPECT_NEAR(done.map.base().texel(0, 0, 0)->x, value, 2e-45) << words(p);
    }
  }
}

}  // namespace
}  // namespace envmap

}  // namespace prefilter_test

// The area filter against brute force: the mean of dense samples of an independent bilinear lookup.
#include "envmap/sample/area.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>

#include "envmap/operate/convert.h"
#include "envmap/operate/measure.h"
#include "envmap/projection/matching_size.h"
#include "envmap/sample/adaptive.h"
#include "envmap/sample/padded_level.h"
#include "envmap/sample/quad.h"
#include "formulae.h"

namespace envmap::area_test {
namespace {

// Values at the texels of a latlong map, and bilinear interpolation written with wrapped indices: no apron.
struct Lookup {
  const Level& level;

  [[nodiscard]] double texel(int i, int j) const {
    const int w = level.width(), h = level.height();
    if (j < 0) j = -1 - j, i += w / 2;
    if (j >= h) j = 2 * h - 1 - j, i += w / 2;
    return level.texel(0, ((i % w) + w) % w, j)->x;
  }
  [[nodiscard]] double operator()(const Direction& d) const {
    const double x = (0.5 - std::atan2(d.x, d.z) / (2 * pi)) * level.width() - 0.5;
    const double y = std::acos(std::clamp(d.y, -1.0, 1.0)) / pi * level.height() - 0.5;
    const int i = int(std::floor(x)), j = int(std::floor(y));
    const double fx = x - i, fy = y - j;
    return (1 - fy) * ((1 - fx) * texel(i, j) + fx * texel(i + 1, j)) +
           fy * ((1 - fx) * texel(i, j + 1) + fx * texel(i + 1, j + 1));
  }
};

EnvironmentMap noise(int height) {
  EnvironmentMap map;
  map.levels.emplace_back(Projection::latlong, height);
  std::mt19937 random(11);
  for (int j = 0; j < height; ++j)
    for (Colour& c : map.base().row(0, j)) c = Colour(0.1F + float(random() % 1000) / 1000);
  return map;
}

// The part of a line from u0 to u1 that lies inside the disc. Other projections have the whole line.
std::pair<double, double> inside_disc(bool disc, double v, double u0, double u1) {
  if (!disc) return {u0, u1};
  const double half = std::sqrt(std::max(0.0, 0.25 - (v - 0.5) * (v - 0.5)));
  return {std::max(u0, 0.5 - half), std::min(u1, 0.5 + half)};
}

// n x n samples of a texel, weighted by the area their neighbours span. What the rim of a disc leaves of a texel has as
// many: in n lines, each from side to side. Towards the rim they lie closer, since sphere maps are steep there.
double brute_force(const Lookup& look, Projection p, int size, int face, int i, int j, int n) {
  double sum = 0, weight = 0;
  const double w = size * aspect(p), h = size, e = 1e-8, u0 = i / w, u1 = (i + 1) / w;
  const auto closer = [&](std::pair<double, double> range, int k) {  // A place, and what it stands for.
    const auto [from, to] = range;
    const double part = (k + 0.5) / n, square = part * part, width = (to - from) / n;
    if (!on_disc(p)) return std::pair(from + (to - from) * part, width);
    return std::pair(to > 0.5 ? to - (to - from) * square : from + (to - from) * square, 2 * part * width);
  };
  for (int b = 0; b < n; ++b) {
    const auto [v, line] = closer(inside_disc(on_disc(p), std::clamp(0.5, u0, u1), j / h, (j + 1) / h), b);
    const auto range = inside_disc(on_disc(p), v, u0, u1);
    for (int a = 0; a < n && range.first < range.second; ++a) {
      const auto [u, step] = closer(range, a);
      if (on_disc(p) && std::hypot(2 * u - 1, 2 * v - 1) >= 1 - 4 * e) continue;
      const auto d = [&](double x, double y) { return formulae::rounded(formulae::direction(p, face, x, y)); };
      const double area = line * step * glm::length(glm::cross(d(u + e, v) - d(u - e, v), d(u, v + e) - d(u, v - e)));
      sum += area * look(d(u, v));
      weight += area;
    }
  }
  return sum / weight;
}

class EachArea : public testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(, EachArea, testing::ValuesIn(all_projections),
                         [](const auto& p) { return identifier(p.param); });

TEST_P(EachArea, AgreesWithBruteForce) {
  const Projection p = GetParam();
  EnvironmentMap source = noise(32);
  for (const int size : {4, 24}) {
    const EnvironmentMap result = convert(source, {.to = p, .size = size, .filter = Filter::area});
    std::mt19937 random(5);
    for (int k = 0; k < 10; ++k) {
      const int face = int(random() % unsigned(faces(p))), j = int(random() % unsigned(size));
      const Columns in = columns(p, size, j);
      const int i = in.first + int(random() % unsigned(in.end - in.first));
      std::vector<double> weights(std::size_t(size * aspect(p)));
      solid_angles(p, size, j, weights);
      if (weights[i] == 0) continue;
      const double truth = brute_force({source.base()}, p, size, face, i, j, size == 4 ? 600 : 300);
      EXPECT_NEAR(result.base().texel(face, i, j)->x / truth, 1, 2e-4)
          << size << ": face " << face << " " << i << "," << j;
    }
  }
}

TEST(Area, TheErrorAskedForIsTheErrorFound) {
  EnvironmentMap source = noise(64);
  const auto map = [&](double tolerance) {
    return convert(source, {.to = Projection::cube, .size = 8, .filter = Filter::area, .area_error = tolerance});
  };
  const EnvironmentMap truth = map(1e-7);
  for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
    const Difference d = compare(map(tolerance).base(), truth.base());
    EXPECT_LT(d.maximum, 3 * tolerance);
    EXPECT_LT(d.rms, tolerance);
  }
}

// The rim may leave hardly a corner of a texel.
TEST_P(EachArea, IsRightAtTheRim) {
  const Projection p = GetParam();
  if (!on_disc(p)) GTEST_SKIP() << "has no rim";
  const EnvironmentMap source = noise(128);
  const int size = 50;
  const EnvironmentMap exact = convert(source, {.to = p, .size = size, .filter = Filter::area});
  const EnvironmentMap fast = convert(source, {.to = p, .size = size});
  int cut = 0;
  for (int j = 0; j < size / 2; ++j)
    for (int i = 0; i < size / 2; ++i) {
      if (std::hypot(i + 1 - 25, j + 1 - 25) >= 25 || std::hypot(i - 25, j - 25) <= 25) continue;
      const double truth = brute_force({source.base()}, p, size, 0, i, j, 300);
      EXPECT_NEAR(exact.base().texel(0, i, j)->x / truth, 1, 2e-4) << i << "," << j;
      EXPECT_NEAR(fast.base().texel(0, i, j)->x / truth, 1, 1e-3) << i << "," << j;
      ++cut;
    }
  EXPECT_GT(cut, 40);
}

// Both ways to the same means, by samples and by outlines: turned, so that seams, poles and edges lie anywhere.
TEST_P(EachArea, AgreesWithSamples) {
  for (const Projection from : all_projections) {
    EnvironmentMap map;
    map.levels.emplace_back(from, matching_size(Projection::latlong, 160, from));
    std::mt19937 random(7);
    for (int f = 0; f < map.base().faces(); ++f)
      for (int j = 0; j < map.base().height(); ++j)
        for (Colour& c : map.base().row(f, j)) c = Colour(0.5F + float(random() % 1000) / 1000);
    const PaddedLevel padded(std::move(map.base()));
    for (const int like : {160, 24}) {
      const Target target{GetParam(), matching_size(Projection::latlong, like, GetParam()), rotation(20, 30, 40)};
      const Sampler by_outlines = area_sampler(padded, target, 1e-4, 1e-3);
      const Sampler by_samples = adaptive_sampler(padded, target, 1e-4, 1e-3);
      for (int k = 0; k < 25; ++k) {
        const int face = int(random() % unsigned(faces(target.to)));
        const int j = int(random() % unsigned(target.size));
        const Columns in = columns(target.to, target.size, j);
        const int i = in.first + int(random() % unsigned(in.end - in.first));
        Colour a, b;
        by_outlines(face, j, i, {&a, 1});
        by_samples(face, j, i, {&b, 1});
        EXPECT_NEAR(a.x / b.x, 1, 5e-4) << name(from) << ": face " << face << " " << i << "," << j << " of "
                                        << target.size;
      }
    }
  }
}

// Texels at and round a pole of the source, against nine million samples.
TEST(Area, IsRightAtThePole) {
  EnvironmentMap source = noise(160);
  const PaddedLevel padded(source.base());
  for (const int size : {20, 21}) {
    Colour texel;
    area_sampler(padded, {Projection::cube, size, Rotation(1)}, 1e-4, 1e-3)(2, 10, 10, {&texel, 1});
    EXPECT_NEAR(texel.x / brute_force({source.base()}, Projection::cube, size, 2, 10, 10, 3000), 1, 2e-5);
  }
}

// Of sources so small that the solid angle bends over a texel, and in texels that hold a pole, at every tolerance.
TEST(Area, IsRightAtThePoleOfASmallSource) {
  const EnvironmentMap source = noise(50);
  std::vector<EnvironmentMap> results;
  for (const double tolerance : {1e-3, 1e-4, 1e-5, 1e-6})
    results.push_back(
        convert(source, {.to = Projection::angular, .size = 14, .filter = Filter::area, .area_error = tolerance}));
  for (const auto& [i, j] : {std::pair{6, 3}, {7, 3}, {6, 10}, {7, 10}}) {
    const double truth = brute_force({source.base()}, Projection::angular, 14, 0, i, j, 700);
    for (const EnvironmentMap& result : results)
      EXPECT_NEAR(result.base().texel(0, i, j)->x / truth, 1, 3e-5) << i << "," << j;
  }
}

// Creases of the source run through the middles of the sides of a cube of odd size: where they cut a side, they meet
// one of its points but for rounding.
TEST(Area, IsRightFromOctahedralMapsOfAnySize) {
  for (int size = 1; size <= 11; ++size) {
    EnvironmentMap map;
    map.levels.emplace_back(Projection::octahedral, size);
    std::mt19937 random{unsigned(size)};
    for (int j = 0; j < size; ++j)
      for (Colour& c : map.base().row(0, j)) c = Colour(0.5F + float(random() % 1000) / 1000, 1, 1);
    const PaddedLevel padded(map.base());
    const auto cube = [&map](int height) {
      return convert(map, {.to = Projection::cube, .size = height, .filter = Filter::area, .area_error = 1e-6});
    };
    const double mean = mean_radiance(cube(4).base());
    for (const int height : {3, 5}) {
      const EnvironmentMap result = cube(height);
      EXPECT_NEAR(mean_radiance(result.base()) / mean, 1, 1e-5) << size << " to " << height;
      const Sampler by_samples = adaptive_sampler(padded, {Projection::cube, height, Rotation(1)}, 1e-4, 1e-3);
      for (int face = 0; face < 6; ++face)
        for (int k = 0; k < height; ++k) {
          const Colour texel = *result.base().texel(face, k, height / 2);
          Colour truth;
          by_samples(face, height / 2, k, {&truth, 1});
          EXPECT_NEAR(texel.x / truth.x, 1, 5e-4) << size << " to " << height << ": face " << face << " " << k;
          EXPECT_NEAR(texel.y, 1, 1e-6);
        }
    }
  }
}

// One texel holds a sun; whatever projection it falls into, its light is all there.
TEST_P(EachArea, KeepsTheFluxOfASunInOneTexel) {
  for (const auto& [i, j] : {std::pair{31, 15}, {0, 20}, {40, 3}, {16, 31}}) {
    EnvironmentMap source;
    source.levels.emplace_back(Projection::latlong, 32);
    *source.base().texel(0, i, j) = Colour(1e6F);
    for (const int size : {5, 32}) {
      const EnvironmentMap result = convert(source, {.to = GetParam(), .size = size, .filter = Filter::area});
      // What bilinear reconstruction makes of one texel has its own flux: 8% more in the pole's row, 4e-4 less
      // elsewhere. The needles at the pole are the worst there is to integrate where the rim of a paraboloid cuts them,
      // too.
      const double polar = j == 31 ? 0.1 : 2e-3;
      EXPECT_NEAR(mean_radiance(result.base()) / mean_radiance(source.base()), 1, polar) << i << "," << j;
      const EnvironmentMap other = convert(source, {.to = Projection::cube, .size = 16, .filter = Filter::area});
      EXPECT_NEAR(mean_radiance(result.base()) / mean_radiance(other.base()), 1, j == 31 ? 2e-2 : 1e-3)
          << i << "," << j << " at " << size;
    }
  }
}

// What convert() takes by itself, against brute force. Half the resolution of the source: footprints of 2 x 2 texels.
TEST_P(EachArea, TheDefaultAgreesWithBruteForce) {
  const Projection p = GetParam();
  EnvironmentMap source = noise(256);
  const int size = matching_size(Projection::latlong, 128, p);
  const EnvironmentMap result = convert(source, {.to = p, .size = size});
  std::mt19937 random(9);
  for (int k = 0; k < 30; ++k) {
    const int face = int(random() % unsigned(faces(p))), j = int(random() % unsigned(size));
    const Columns in = columns(p, size, j);
    const int i = in.first + int(random() % unsigned(in.end - in.first));
    const double truth = brute_force({source.base()}, p, size, face, i, j, 200);
    if (std::isnan(truth)) continue;  // Outside the disc.
    EXPECT_NEAR(result.base().texel(face, i, j)->x / truth, 1, 1e-3) << "face " << face << " " << i << "," << j;
  }
}

Colour smooth(double u, double v, std::mt19937&) {
  return Colour(1 + 0.5 * std::sin(20 * u) * std::cos(15 * v), 1 + u * v, 1 + 0.3 * std::sin(9 * v));
}
Colour noisy(double, double, std::mt19937& random) { return Colour(1e-3F + float(random() % 1000) / 1000); }
Colour checker(double u, double v, std::mt19937&) { return Colour(float((int(512 * u) + int(256 * v)) % 2)); }
Colour suns(double, double, std::mt19937& random) { return Colour(random() % 200 == 0 ? 1e5F : 0.1F); }

// Texels that quadrilaterals are enough for are right to the tolerance in every map: it is a bound. Those are told by
// being other than what polygons give.
TEST_P(EachArea, QuadrilateralsKeepTheirBound) {
  for (const auto map : {smooth, noisy, checker, suns}) {
    std::mt19937 random(21);
    Level level(Projection::latlong, 256);
    for (int j = 0; j < 256; ++j)
      for (int i = 0; i < 512; ++i) *level.texel(0, i, j) = map((i + 0.5) / 512, (j + 0.5) / 256, random);
    const PaddedLevel padded(std::move(level));
    const Target target{GetParam(), matching_size(Projection::latlong, 110, GetParam()), rotation(20, 30, 40)};
    const double tolerance = map == smooth ? 1e-3 : 2e-2;
    const Sampler quads = quad_sampler(padded, target, tolerance, 1e-3);
    const Sampler bounded = quad_sampler(padded, target, tolerance, 1e-3, false);
    const Sampler polygons = area_sampler(padded, target, tolerance, 1e-3, true);
    const Sampler outlines = area_sampler(padded, target, tolerance, 1e-3);
    const Sampler truth = area_sampler(padded, target, 1e-6, 1e-3);
    int taken = 0, taken_by_bound = 0;
    for (int k = 0; k < 1500; ++k) {
      const int face = int(random() % unsigned(faces(target.to))), j = int(random() % unsigned(target.size));
      const Columns in = columns(target.to, target.size, j);
      const int i = in.first + int(random() % unsigned(in.end - in.first));
      std::optional<Colour> right;
      const auto compare = [&](const Sampler& by_quads, const Sampler& otherwise, int& count) {
        Colour a, b;
        by_quads(face, j, i, {&a, 1}), otherwise(face, j, i, {&b, 1});
        if (a == b) return;
        if (!right) truth(face, j, i, {&right.emplace(), 1});
        const Colour c = *right;
        for (int n = 0; n < 3; ++n)
          EXPECT_LE(std::abs(a[n] - c[n]), tolerance * std::max(c[n], 1e-3F))
              << "face " << face << " " << i << "," << j;
        ++count;
      };
      compare(quads, polygons, taken), compare(bounded, outlines, taken_by_bound);
    }
    EXPECT_GT(taken, map == smooth ? 900 : 20);
    EXPECT_GT(taken_by_bound, map == smooth ? 900 : 10);
  }
}

// Rows are filled in parts of any length.
TEST_P(EachArea, QuadrilateralsAreTheSameOneByOne) {
  EnvironmentMap source = noise(256);
  const PaddedLevel padded(source.base());
  const Target target{GetParam(), matching_size(Projection::latlong, 100, GetParam()), rotation(20, 30, 40)};
  const Sampler quads = quad_sampler(padded, target, 1e-2, 1e-3);
  for (const int row : {3, target.size / 2, target.size - 8}) {
    const Columns in = columns(target.to, target.size, row);
    std::vector<Colour> whole(in.count()), single(in.count());
    quads(0, row, in.first, whole);
    for (std::size_t k = 0; k < single.size(); ++k) quads(0, row, in.first + int(k), {&single[k], 1});
    EXPECT_EQ(whole, single) << row;
  }
}

}  // namespace
}  // namespace envmap::area_test

// Coverage against closed forms of integrals over polygons, which know nothing of cells.
#include "envmap/sample/coverage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace envmap::coverage_test {
namespace {

using Points = std::vector<Point2>;

// The integral of x^a y^b over a polygon, by triangles from the origin and a rule of the seventh degree would be one
// way; here as Steger 1996, "On the calculation of arbitrary moments of polygons", for a, b <= 2.
double moment(const Points& p, int a, int b) {
  const auto binomial = [](int n, int k) {
    return n == k || k == 0 ? 1.0 : n == 2 ? 2.0 : n == 3 ? 3.0 : k == 2 ? 6.0 : 4.0;
  };
  double sum = 0;
  for (std::size_t n = 0; n < p.size(); ++n) {
    const Point2 &s = p[n], &t = p[(n + 1) % p.size()];
    double inner = 0;
    for (int k = 0; k <= a; ++k)
      for (int l = 0; l <= b; ++l)
        inner += binomial(k + l, l) * binomial(a + b - k - l, b - l) * std::pow(t.x, k) * std::pow(s.x, a - k) *
                 std::pow(t.y, l) * std::pow(s.y, b - l);
    sum += (s.x * t.y - t.x * s.y) * inner;
  }
  return sum / ((a + b + 2) * (a + b + 1) * binomial(a + b, a));
}

std::size_t texels(const Coverage& c) {
  std::size_t count = 0;
  for (const Coverage::Run& run : c.runs()) count += std::size_t(run.count);
  return count;
}

// The sum of weights x f(texel centre).
template <class F>
double weighted(Coverage& c, const Points& points, F&& density, double (*f)(double, double)) {
  c.cover(points);
  std::vector<Point2> texels;
  for (const Coverage::Run& run : c.runs())
    for (int i = run.first; i < run.first + run.count; ++i) texels.emplace_back(i, run.row);
  std::vector<double> densities;
  for (const Point2& t : texels) densities.push_back(density(t.x, t.y));
  const std::span<const double> w = c.weights(densities);
  double sum = 0;
  for (std::size_t k = 0; k < texels.size(); ++k) sum += w[k] * f(texels[k].x, texels[k].y);
  return sum;
}

// Stars about a point: concave, many sides, some level, some upright.
Points star(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> any(0, 1);
  const Point2 middle(10 * any(random) - 5, 10 * any(random) - 5);
  Points p;
  const int n = 3 + int(random() % 9);
  for (int k = 0; k < n; ++k) {
    const double angle = 2 * pi * (k + 0.8 * any(random)) / n, r = size * (0.2 + any(random));
    p.push_back(middle + r * Point2(std::cos(angle), std::sin(angle)));
    if (size > 4 && n < 6) p.back() = glm::round(p.back());  // Where the borders of cells are.
  }
  if (random() % 2) std::ranges::reverse(p);
  return p;
}

double one(double, double) { return 1; }
double x(double a, double) { return a; }
double y(double, double b) { return b; }
double xy(double a, double b) { return a * b; }

TEST(Coverage, IntegratesTheReconstructionExactly) {
  std::mt19937 random(1);
  Coverage c;
  const auto even = [](double, double) { return 1.0; };
  for (int k = 0; k < 2000; ++k) {
    const Points p = star(random, k % 2 ? 0.3 : 6);
    const double sign = moment(p, 0, 0) < 0 ? -1 : 1;
    EXPECT_NEAR(weighted(c, p, even, one), sign * moment(p, 0, 0), 1e-10);
    EXPECT_NEAR(weighted(c, p, even, x), sign * moment(p, 1, 0), 1e-9);
    EXPECT_NEAR(weighted(c, p, even, y), sign * moment(p, 0, 1), 1e-9);
    EXPECT_NEAR(weighted(c, p, even, xy), sign * moment(p, 1, 1), 1e-8);
  }
}

TEST(Coverage, WeighsByALinearDensity) {
  std::mt19937 random(2);
  Coverage c;
  const auto density = [](double a, double b) { return 100 + 2 * a - 3 * b; };
  for (int k = 0; k < 500; ++k) {
    const Points p = star(random, 4);
    const double sign = moment(p, 0, 0) < 0 ? -1 : 1;
    EXPECT_NEAR(weighted(c, p, density, one),
                sign * (100 * moment(p, 0, 0) + 2 * moment(p, 1, 0) - 3 * moment(p, 0, 1)), 1e-8);
    EXPECT_NEAR(weighted(c, p, density, xy), sign * (100 * moment(p, 1, 1) + 2 * moment(p, 2, 1) - 3 * moment(p, 1, 2)),
                1e-6);
  }
}

TEST(Coverage, AWholeCellIsAQuarterToEachCorner) {
  Coverage c;
  c.cover(Points{{3, 4}, {4, 4}, {4, 5}, {3, 5}});
  // Places on a border count to both cells; only four texels have a weight.
  const std::vector<double> even(texels(c), 1);
  const auto w = c.weights(even);
  int quarters = 0;
  for (const double weight : w) {
    EXPECT_TRUE(weight == 0.25 || weight < 1e-15) << weight;
    quarters += weight == 0.25;
  }
  EXPECT_EQ(quarters, 4);
}

// A long polygon aslant lies over few of the texels round it.
TEST(Coverage, LooksAtTheTexelsBelowOnly) {
  Coverage c;
  c.cover(Points{{0.2, 0.2}, {99.2, 99.2}, {99.3, 99.2}, {0.3, 0.2}});
  EXPECT_LT(texels(c), 600U);  // Of 10,000.
  EXPECT_GE(texels(c), 300U);
}

TEST(Coverage, NoWeightIsNegative) {
  std::mt19937 random(3);
  Coverage c;
  for (int k = 0; k < 2000; ++k) {
    c.cover(star(random, k % 3 == 0 ? 1e-6 : 2));
    const std::vector<double> even(texels(c), 1);
    for (const double w : c.weights(even)) EXPECT_GE(w, 0);
  }
}

}  // namespace
}  // namespace envmap::coverage_test

// Curved outlines followed by few pieces, beside the same followed by many.
#include "envmap/sample/outline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "envmap/sample/coverage.h"

namespace envmap::outline_test {
namespace {

// A square turned by an angle, whose sides bulge as arcs of circles of a curvature each.
struct Bulging {
  Point2 middle;
  double size, turn;
  double curvatures[4];

  [[nodiscard]] Outline followed_by(int pieces) const {
    Outline out;
    for (int side = 0; side < 4; ++side)
      for (int k = 0; k < pieces; ++k) out.add(at(side, double(k) / pieces), k == 0);
    out.add(out.points.front(), true);
    return out;
  }

 private:
  // Along the arc at even steps of its angle.
  [[nodiscard]] Point2 at(int side, double t) const {
    const double c = curvatures[side], half = std::asin(0.5 * size * c), angle = (2 * t - 1) * half;
    const Point2 p(c == 0 ? (t - 0.5) * size : std::sin(angle) / c,
                   0.5 * size + (c == 0 ? 0 : (std::cos(angle) - std::cos(half)) / c));
    const double a = turn + 0.5 * pi * side;
    return middle + Point2(std::cos(a) * p.x + std::sin(a) * p.y, std::cos(a) * p.y - std::sin(a) * p.x);
  }
};

// Of texels (0,0) to (9,9), with a density that is even.
std::vector<double> weights(const std::vector<Point2>& polygon) {
  Coverage coverage;
  coverage.cover(polygon);
  const std::vector<double> densities(400, 1.0);
  const double* weight = coverage.weights(densities).data();
  std::vector<double> out(100, 0);
  for (const Coverage::Run& run : coverage.runs())
    for (int i = run.first; i < run.first + run.count; ++i) out[std::size_t(10 * run.row + i)] += *weight++;
  return out;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
  return most;
}

// A side that is off by b all along moves 2/3 b of weight for each texel of its length;
// here all four may be at one texel.
double allowed(const Outline::Shape& shape, double off, double size) {
  return 4 * (2.0 / 3) * off * std::min(1.0, size) + 1e-13 * shape.thickness;
}

TEST(Outline, PointsMovedOutGiveTexelsTheirWeights) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> unit(0, 1);
  double gained = 0;
  int n = 0;
  for (; n < 700; ++n) {
    Bulging b{{4 + unit(random), 4 + unit(random)}, 0.2 * std::pow(15, unit(random)), 2 * pi * unit(random), {}};
    for (double& c : b.curvatures) c = (2 * unit(random) - 1) * 0.8 / b.size;
    const auto truth = weights(b.followed_by(400).points);
    Outline few = b.followed_by(2 + n % 7);
    const Outline::Shape shape = few.shape();
    const double plain = largest_difference(weights(few.points), truth);
    few.move_out();
    const double moved = largest_difference(weights(few.points), truth);
    ASSERT_LE(plain, allowed(shape, 1.3 * shape.bend, b.size)) << n;
    ASSERT_LE(moved, allowed(shape, shape.error, b.size) + 1e-5 * plain) << n << ' ' << b.size << ' ' << 2 + n % 7;
    gained += std::log(plain / moved);
  }
  EXPECT_GT(std::exp(gained / n), 10);
}

TEST(Outline, StraightSidesStayAsTheyAre) {
  const Bulging square{{4, 4}, 1.5, 0.3, {0, 0, 0, 0}};
  Outline o = square.followed_by(4);
  const std::vector<Point2> before = o.points;
  EXPECT_LT(o.shape().error, 1e-15);
  o.move_out();
  for (std::size_t k = 0; k < before.size(); ++k) EXPECT_LT(glm::distance(o.points[k], before[k]), 1e-15);
}

}  // namespace
}  // namespace envmap::outline_test

// The theorem that the treecode's bound rests on, step by step and as a whole, against random nodes, lobes and
// directions: sums over the points of a node in double, rounding and all.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "envmap/prefilter/treecode/treecode_kernels.h"
#include "every_target.h"

namespace envmap::prefiltering::treecode_bound_test {
namespace {

class Draw {
 public:
  explicit Draw(unsigned seed) : random_(seed) {}
  double even() { return even_(random_); }
  // Evenly by its logarithm.
  double between(double least, double most) { return least * std::pow(most / least, even()); }
  bool one_of(int n) { return std::uniform_int_distribution<int>(1, n)(random_) == 1; }
  Direction offset() { return {normal_(random_), normal_(random_), normal_(random_)}; }
  Direction direction() { return glm::normalize(offset()); }
  // At an angle from another one.
  Direction beside(const Direction& d, double angle) {
    const Direction across = glm::normalize(glm::cross(d, direction()));
    return glm::normalize(std::cos(angle) * d + std::sin(angle) * across);
  }

 private:
  std::mt19937 random_;
  std::uniform_real_distribution<double> even_;
  std::normal_distribution<double> normal_;
};

struct Point {
  Direction d;
  std::array<double, channels> flux;
};

// Points in a disc, on a line, or in two heaps; of one colour or of several; at times one of them a sun.
std::vector<Point> some_points(Draw& draw, double radius) {
  const Direction middle = draw.direction(), along = draw.beside(middle, radius) - middle;
  const int count = 1 + int(20 * draw.even());
  const bool line = draw.one_of(3), heaps = draw.one_of(3), grey = draw.one_of(2), sun = draw.one_of(3);
  std::vector<Point> all;
  for (int k = 0; k < count; ++k) {
    Direction d = line ? middle + (2 * draw.even() - 1) * along : draw.beside(middle, radius * std::sqrt(draw.even()));
    if (heaps) d = middle + (draw.one_of(3) ? 1.0 : -0.4) * along + 0.05 * radius * draw.offset();
    Point p{glm::normalize(d), {}};
    for (std::size_t c = 0; c < channels; ++c) {
      p.flux[c] = c > 0 && grey ? p.flux[0] : draw.between(1e-3, 1);
      if (sun && k == 0 && !draw.one_of(3)) p.flux[c] *= 1e4;
    }
    all.push_back(p);
  }
  return all;
}

TreeNode node_of_points(const std::vector<Point>& points) {
  Light light;
  for (const Point& p : points) {
    const Direction& d = p.d;
    const Moments3 one{1,
                       d.x,
                       d.y,
                       d.z,
                       d.x * d.x,
                       d.x * d.y,
                       d.x * d.z,
                       d.y * d.y,
                       d.y * d.z,
                       d.z * d.z,
                       d.x * d.x * d.x,
                       d.x * d.x * d.y,
                       d.x * d.x * d.z,
                       d.x * d.y * d.y,
                       d.x * d.y * d.z,
                       d.x * d.z * d.z,
                       d.y * d.y * d.y,
                       d.y * d.y * d.z,
                       d.y * d.z * d.z,
                       d.z * d.z * d.z};
    for (std::size_t c = 0; c < channels; ++c)
      for (std::size_t k = 0; k < one.size(); ++k) light.moments[c][k] += p.flux[c] * one[k];
  }
  set_centre(light, {1, 1, 1});
  for (const Point& p : points)
    light.bounding_radius = std::max(light.bounding_radius, glm::length(p.d - light.centre));
  return finished(light);
}

double value_of(const LobeFormula& lobe, double x) {
  return std::visit([x](const auto& l) { return l.value(x); }, lobe);
}
// What is left to the nodes.
double rest_of(const TreecodeLobe& lobe, double x) {
  const double t = 1 - x, all = value_of(lobe.lobe, x);
  return t <= 0 ? 0 : all - t * lobe.horizon_terms.slope(t);
}
double versine(const Direction& a, const Direction& b) {
  const Direction d = a - b;
  return 0.5 * glm::dot(d, d);
}
double width_of(const LobeFormula& lobe) {
  return std::visit([](const auto& l) { return std::sqrt(2 * l.width()); }, lobe);
}

// Directions round one that sees a node in the lobe's middle or tail, over its horizon, or anywhere.
std::vector<Direction> some_directions(Draw& draw, const LobeFormula& lobe, const TreeNode& node) {
  const double reach = std::acos(std::clamp(double(node.cosine), -1.0, 1.0));
  const double angle = draw.one_of(3)   ? draw.between(1e-3, 10) * width_of(lobe)
                       : draw.one_of(2) ? 0.5 * pi + 1.5 * reach * (2 * draw.even() - 1)
                                        : pi * draw.even();
  const Direction middle = draw.beside(node.axis, std::min(angle, pi));
  const double radius = std::min(0.1, draw.between(0.03, 1) * width_of(lobe));
  std::vector<Direction> all{middle};
  if (draw.one_of(2))
    while (all.size() < 9) all.push_back(draw.beside(middle, radius * draw.even()));
  return all;
}

const LobeFormula lobes[] = {Phong{1.1},   Phong{1.6},      Phong{2.5},    Phong{3.3},     Phong{4},         Phong{4.5},
                             Phong{12},    Phong{300},      Phong{1e5},    Ggx(0.03),      Ggx(0.2),         Ggx(0.5),
                             Ggx(0.9),     BlinnPhong(0.7), BlinnPhong(3), BlinnPhong(40), BlinnPhong(3000), Charlie(1),
                             Charlie(0.8), Charlie(0.6),    Charlie(0.5),  Charlie(0.4),   Charlie(0.2)};

class EachTreecodeLobe : public testing::TestWithParam<LobeFormula> {};
INSTANTIATE_TEST_SUITE_P(, EachTreecodeLobe, testing::ValuesIn(lobes));

TEST_P(EachTreecodeLobe, NoNodeIsFartherOffThanItsBound) {
  on_every_target([&](const char* target) {
    SCOPED_TRACE(target);
    const TreecodeLobe lobe = treecode_lobe(GetParam()).value();
    Draw draw(17);
    double worst = 0;
    for (int n = 0; n < 6000; ++n) {
      const std::vector<Point> points = some_points(draw, std::min(1.0, draw.between(1e-3, 3) * width_of(GetParam())));
      const TreeNode node = node_of_points(points);
      const std::vector<Direction> directions = some_directions(draw, GetParam(), node);
      const Tile tile(directions);
      NodeGroup group{};
      group.set(0, node);
      NodeBounds bounds;
      bound_nodes(lobe, tile, group, bounds);
      TileSums sums{};
      NodeSums nodes;
      if (bounds.visible & 1) nodes.of(bounds.form[0]).push_back({&node, bounds.constant[0], bounds.line[0]});
      evaluate(lobe, nodes, tile, sums);
      const double bound = bounds.visible & 1 ? bounds.bound[0] : 0;
      for (std::size_t k = 0; k < directions.size(); ++k)
        for (std::size_t c = 0; c < channels; ++c) {
          double truth = 0, flux = 0;
          for (const Point& p : points) {
            truth += p.flux[c] * rest_of(lobe, versine(directions[k], p.d)), flux += p.flux[c];
          }
          const double off = std::abs(sums[c][k] - truth), allowed = flux * bound;
          ASSERT_LE(off, allowed + 1e-12 * flux)
              << "node " << n << " form " << int(bounds.form[0]) << " bound " << bound;
          if (allowed > 0) worst = std::max(worst, off / allowed);
        }
    }
    EXPECT_GT(worst, 0.3) << "an idle bound";
  });
}

// E|t|^2, E|t|^4, E|t|^3 and |E t^3| by the scalars of a node.
TEST(TreecodeBound, ScalarsOfNodesBoundTheirMoments) {
  Draw draw(23);
  std::array<double, 4> tightest{};
  for (int n = 0; n < 20000; ++n) {
    const std::vector<Point> points = some_points(draw, draw.between(1e-4, 1));
    const TreeNode node = node_of_points(points);
    const Direction c = (1 - double(node.sag)) * node.axis;
    const Direction r = draw.one_of(3) ? draw.beside(node.axis, draw.between(1e-3, 1)) : draw.direction();
    const double s = glm::length(glm::cross(r, node.axis));
    const double t2 = s * node.tangent2 + node.radial2, t4 = s * node.tangent4 + node.radial4;
    const double cube = s * s * (s * node.tangent3 + 3.0 * node.tangent4 * node.tangent4 * node.radial2) +
                        (3 * s * node.tangent2 + node.radial2) * node.radial4 * double(node.radial4);
    for (std::size_t ch = 0; ch < channels; ++ch) {
      double flux = 0, m2 = 0, m4 = 0, absolute = 0, m3 = 0;
      for (const Point& p : points) {
        const double t = glm::dot(r, p.d - c), f = p.flux[ch];
        flux += f, m2 += f * t * t, m3 += f * t * t * t, m4 += f * t * t * t * t, absolute += f * std::abs(t * t * t);
        ASSERT_GE(glm::dot(p.d, node.axis), node.cosine - 1e-6);
      }
      const double found[] = {m2 / flux, m4 / flux, absolute / flux, std::abs(m3) / flux};
      const double bounds[] = {t2 * t2, t4 * t4 * t4 * t4, t2 * t4 * t4, cube};
      for (std::size_t k = 0; k < 4; ++k) {
        ASSERT_LE(found[k], bounds[k] * (1 + 1e-6) + 1e-14) << "moment " << k << " of node " << n;
        if (bounds[k] > 1e-10) tightest[k] = std::max(tightest[k], found[k] / bounds[k]);
      }
    }
  }
  for (const double ratio : tightest) EXPECT_GT(ratio, 0.5) << "an idle bound";
}

// Light from all around, with a centre that is neither near the sphere nor on the axis that such a node is given.
TEST(TreecodeBound, NodesWithoutAnAxisHoldTheirBound) {
  for (const double exponent : {1.5, 4.0, 4.5, 6.0}) {
    const TreecodeLobe lobe = treecode_lobe(Phong{exponent}).value();
    for (const double tilt : {0.003, 0.02, 0.05, 0.4}) {
      std::vector<Point> ring;
      for (int k = 0; k < 360; ++k) {
        const double a = k * pi / 180, y = 0.26;
        const double light = 1 + 0.3 * std::cos(a);
        ring.push_back(
            {{std::sqrt(1 - y * y) * std::cos(a), y, std::sqrt(1 - y * y) * std::sin(a)}, {light, light, 1}});
      }
      const TreeNode node = node_of_points(ring);
      const std::vector<Direction> directions{{std::sin(tilt), std::cos(tilt), 0}};
      const Tile tile(directions);
      NodeGroup group{};
      group.set(0, node);
      NodeBounds bounds;
      bound_nodes(lobe, tile, group, bounds);
      ASSERT_TRUE(bounds.visible & 1);
      NodeSums nodes;
      nodes.of(bounds.form[0]).push_back({&node, bounds.constant[0], bounds.line[0]});
      TileSums sums{};
      evaluate(lobe, nodes, tile, sums);
      for (std::size_t c = 0; c < channels; ++c) {
        double truth = 0, flux = 0;
        for (const Point& p : ring) truth += p.flux[c] * rest_of(lobe, versine(directions[0], p.d)), flux += p.flux[c];
        EXPECT_LE(std::abs(sums[c][0] - truth), flux * bounds.bound[0]) << exponent << " " << tilt;
      }
    }
  }
}

// A tile of many directions has the cone that all of them lie in.
TEST(TreecodeBound, TilesHoldTheirDirections) {
  Draw draw(29);
  for (int n = 0; n < 200; ++n) {
    const Direction middle = draw.direction();
    std::vector<Direction> all;
    for (int k = 0; k < 64; ++k) all.push_back(draw.beside(middle, 0.4 * draw.even()));
    const Tile tile(all);
    for (const Direction& r : all) {
      EXPECT_GE(glm::dot(r, tile.middle), tile.cosine - 1e-12);
      EXPECT_LE(glm::length(glm::cross(r, tile.middle)), tile.sine + 1e-12);
    }
  }
}

TEST(TreecodeBound, TurnedMomentsAreThoseOfTurnedPatches) {
  const Rect rect{0.3, 0.2, 0.302, 0.203};
  for (const double shift : {0.25, 0.1}) {
    const Patch west = patch_of<Latlong>(0, rect);
    const Patch east = patch_of<Latlong>(0, {rect.u0 + shift, rect.v0, rect.u1 + shift, rect.v1});
    const double a = 2 * pi * shift;
    const Rotation turn{{std::cos(a), 0, std::sin(a)}, {0, 1, 0}, {-std::sin(a), 0, std::cos(a)}};
    const Moments3 moved = turned(west.moments, turn);
    for (std::size_t k = 0; k < moved.size(); ++k) EXPECT_NEAR(moved[k], east.moments[k], 1e-14 * west.moments[0]) << k;
  }
}

}  // namespace
}  // namespace envmap::prefiltering::treecode_bound_test

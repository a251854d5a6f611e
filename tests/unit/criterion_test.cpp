// The bound by which the treecode opens nodes, against what is off: random nodes, lobes and directions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "envmap/prefilter/evaluate.h"
#include "envmap/prefilter/prefilter.h"
#include "envmap/prefilter/traverse.h"
#include "envmap/prefilter/treecode.h"
#include "every_target.h"

namespace envmap::prefiltering::criterion_test {
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

Node point(const Direction& d, const NodeFlux& flux) {
  Moments patch;
  patch.solid_angle = 1, patch.centre = d;
  return node_of(patch, {flux[0], flux[1], flux[2]});
}

// Points in a disc, on a line, or in two heaps; of one colour or of several; at times one of them a sun.
std::vector<Node> some_points(Draw& draw, const Direction& middle, double radius) {
  const int count = 2 + int(20 * draw.even());
  const bool line = draw.one_of(3), heaps = draw.one_of(3), grey = draw.one_of(2), sun = draw.one_of(3);
  const Direction along = draw.beside(middle, radius) - middle;
  std::vector<Node> all;
  for (int k = 0; k < count; ++k) {
    Direction d = line ? middle + (2 * draw.even() - 1) * along : draw.beside(middle, radius * std::sqrt(draw.even()));
    if (heaps) d = middle + (draw.one_of(3) ? 1.0 : -0.4) * along + 0.05 * radius * draw.offset();
    NodeFlux flux{};
    for (std::size_t c = 0; c < 3; ++c) flux[c] = float(c > 0 && grey ? flux[0] : draw.between(1e-3, 1));
    if (sun && k == 0)
      for (std::size_t c = 0; c < 3; ++c) flux[c] *= draw.one_of(3) ? 1.F : 1e4F;
    all.push_back(point(glm::normalize(d), flux));
  }
  return all;
}

double versine(const Direction& a, const Direction& b) {
  const Direction d = a - b;
  return 0.5 * glm::dot(d, d);
}

// What float32 makes of a lobe: its own digits, those of x = 1 - cos, those of places within a node, and those of its
// covariance, of which a direction that looks along the node's centre sees the rounding;
// and a power is no less than 2^-100.
double rounding_of(const Lobe& lobe, double x, double reach) {
  return std::visit(
      [&](const auto& l) {
        const double f = l.value(x), off = 1.5e-6 * x + 1e-6 * reach * std::sqrt(2 * x);
        const double s = std::min(4e-4 * reach, reach * (std::sqrt(2 * x) + reach));
        const double bent = std::abs(f + l.value(x + 2 * s) - 2 * l.value(x + s)) / 2;
        return 1e-5 * f + std::abs(l.value(std::max(0.0, x - off)) - f) + bent + 1e-27 * l.value(l.peak());
      },
      lobe);
}

// A tile that sees a node in the lobe's middle or tail, over its horizon, or anywhere.
Tile some_tile(Draw& draw, const Lobe& lobe, const Node& node) {
  const double width = std::visit([](const auto& l) { return std::sqrt(2 * l.width()); }, lobe);
  const Direction centre = glm::normalize(node.centre);
  const double angle = draw.one_of(3)   ? draw.between(1e-2, 10) * width
                       : draw.one_of(2) ? 0.5 * pi + 1.5 * node.reach * (2 * draw.even() - 1)
                                        : pi * draw.even();
  Tile tile{.middle = draw.beside(centre, std::min(angle, pi)), .count = 8};
  const double radius = draw.one_of(2) ? 0 : std::min(0.1, draw.between(0.03, 1) * width);
  for (std::size_t k = 0; k < Tile::most; ++k) {
    const Direction o = draw.beside(tile.middle, radius * draw.even()) - tile.middle;
    tile.x[k] = float(o.x), tile.y[k] = float(o.y), tile.z[k] = float(o.z);
    tile.radius = std::max(tile.radius, glm::length(o) + 1e-7);
  }
  return tile;
}

// Sums over the points of a node, and what float32 may make of them, for each unit of flux.
struct Truth {
  std::array<double, node_channels> sums{};
  double rounding = 0;
};
Truth truth_of(const Lobe& lobe, const std::vector<Node>& points, const Direction& r, double reach) {
  Truth truth;
  for (const Node& p : points) {
    const double x = versine(r, p.centre), f = std::visit([x](const auto& l) { return l.value(x); }, lobe);
    truth.rounding = std::max(truth.rounding, rounding_of(lobe, x, reach));
    for (std::size_t c = 0; c < node_channels; ++c) truth.sums[c] += p.flux[c] * f;
  }
  return truth;
}

// What a node is off over its bound, at most, where that is more than rounding.
class Worst {
 public:
  void expect_within(double bound, const std::array<double, node_channels>& found, const Truth& truth,
                     const Node& node) {
    for (std::size_t c = 0; c < node_channels; ++c) {
      const double off = std::abs(found[c] - truth.sums[c]), allowed = node.flux[c] * (bound + truth.rounding);
      ASSERT_LE(off, allowed + 1e-37) << "flux " << node.flux[c] << ", reach " << node.reach;
      if (bound > 10 * truth.rounding) ratio_ = std::max(ratio_, off / allowed);
    }
  }
  [[nodiscard]] double ratio() const { return ratio_; }

 private:
  double ratio_ = 0;
};

// What either evaluate() makes of a node in every direction of a tile, over what judge() says of it.
void compare(const Lobe& lobe, const std::vector<Node>& points, const Node& node, Tile& tile, Worst& worst) {
  NodeGroup group = NodeGroup::none();
  group.set(0, node, tile.middle);
  const Criterion criterion{.middle = tile.middle, .radius = tile.radius, .most = {1, 1, 1}, .limit = 1e30F};
  const Judged judged = judge(lobe, criterion, group, 1);
  const bool visible = (judged.visible & 1) != 0;
  const double bound = visible ? judged.error[0] / *std::ranges::max_element(node.flux) : 0;
  if (visible) {
    std::vector<SeenNodes> seen;
    std::size_t count = 0;
    add_seen(node, tile.middle, count, seen);
    worst.expect_within(bound, evaluate(lobe, seen), truth_of(lobe, points, tile.middle, node.reach), node);
    evaluate(lobe, std::vector<TileNode>{seen_from_tile(node, tile.middle, tile.radius)}, tile);
  }
  for (std::size_t k = 0; k < tile.count; ++k) {
    const Direction r = glm::normalize(tile.middle + Direction(tile.x[k], tile.y[k], tile.z[k]));
    std::array<double, node_channels> found{};
    for (std::size_t c = 0; c < node_channels && visible; ++c) found[c] = tile.sums[c][k];
    worst.expect_within(bound, found, truth_of(lobe, points, r, node.reach), node);
  }
}

class EachLobe : public testing::TestWithParam<Lobe> {};
INSTANTIATE_TEST_SUITE_P(, EachLobe,
                         testing::Values(Lobe(Cosine{}), Lobe(Phong{0}), Lobe(Phong{0.03}), Lobe(Phong{0.5}),
                                         Lobe(Phong{1.5}), Lobe(Phong{2.5}), Lobe(Phong{12}), Lobe(Phong{300}),
                                         Lobe(Phong{1e5}), Lobe(Ggx(0.03)), Lobe(Ggx(0.2)), Lobe(Ggx(0.5)),
                                         Lobe(Ggx(1)), Lobe(BlinnPhong(0.7)), Lobe(BlinnPhong(40)),
                                         Lobe(BlinnPhong(3000)), Lobe(Charlie(1)), Lobe(Charlie(0.6)),
                                         Lobe(Charlie(0.25)), Lobe(Charlie(0.1))));

TEST_P(EachLobe, NoNodeIsFartherOffThanItsBound) {
  on_every_target([&](const char* target) {
    SCOPED_TRACE(target);
    Draw draw(17);
    Worst worst;
    for (int n = 0; n < 4000; ++n) {
      const double width = std::visit([](const auto& l) { return std::sqrt(2 * l.width()); }, GetParam());
      const double radius = std::min(0.5, draw.between(1e-3, 3) * width);
      const std::vector<Node> points = some_points(draw, draw.direction(), radius);
      const Node node = united(points);
      Tile tile = some_tile(draw, GetParam(), node);
      compare(GetParam(), points, node, tile, worst);
      ASSERT_FALSE(testing::Test::HasFatalFailure()) << "node " << n;
    }
    EXPECT_GT(worst.ratio(), 0.3) << "an idle bound";
  });
}

// Even square cells of a flat lattice round a horizon that runs `along` so many of them one way and `up` the other, and
// lies `above` the middle of one of them; a period of the lattice, `count` times.
std::vector<std::vector<Node>> cells_along_horizon(int along, int up, double above, double side, int count) {
  constexpr int points = 12;
  const double length = std::hypot(along, up), cosine = along / length, sine = up / length;
  std::vector<std::vector<Node>> cells;
  for (int j = -2 * count * (up + 1); j <= 2 * count * (up + 1); ++j)
    for (int i = -count * (along + up + 1); i <= count * (along + up + 1); ++i) {
      const double azimuth = cosine * i + sine * j, height = cosine * j - sine * i - above;
      if (azimuth < 0 || azimuth > (count - 1e-6) * length || std::abs(height) > 1) continue;
      std::vector<Node> cell;
      for (int k = 0; k < points * points; ++k) {
        const double u = (k % points + 0.5) / points - 0.5, v = (k / points + 0.5) / points - 0.5;
        const double a = side * (azimuth + cosine * u + sine * v), h = side * (height + cosine * v - sine * u);
        cell.push_back(point({std::cos(a) * std::cos(h), std::sin(a) * std::cos(h), std::sin(h)}, {1, 1, 1}));
      }
      cells.push_back(std::move(cell));
    }
  return cells;
}

// What cells are off together, over the sum of their bounds, and the most that one is off, over its own.
struct Together {
  double all, one;
};
// @param light of 4 x 4 parts of each cell.
Together off_together(const Lobe& lobe, const std::vector<std::vector<Node>>& cells,
                      const std::array<float, 16>& light) {
  const Direction r(0, 0, 1);
  Traversal found;
  found.clear(lobe, false, false);
  double off = 0, bounds = 0, one = 0;
  for (std::vector<Node> cell : cells) {
    const auto side = std::size_t(std::lround(std::sqrt(cell.size())));
    for (std::size_t k = 0; k < cell.size(); ++k) {
      const float x = light[4 * k / side / side * 4 + 4 * (k % side) / side];
      cell[k] = point(cell[k].centre, {x, x, x});
    }
    const Node node = united(cell);
    NodeGroup group = NodeGroup::none();
    group.set(0, node, r);
    const Judged judged = judge(lobe, {.middle = r, .most = {1, 1, 1}, .limit = 1e30F}, group, 1);
    std::vector<SeenNodes> seen;
    std::size_t count = 0;
    add_seen(node, r, count, seen);
    const double is = evaluate(lobe, seen)[0] - truth_of(lobe, cell, r, node.reach).sums[0];
    off += is;
    if (!(judged.crossed & 1)) continue;
    bounds += judged.error[0];
    one = std::max(one, std::abs(is) / judged.error[0]);
  }
  return {std::abs(off) / bounds, one};
}

// The horizon crosses all of them in the same place, and all are off the same way.
TEST(Together, EvenCellsAlongTheHorizonAreOffByLessThanCounts) {
  std::array<float, 16> even;
  even.fill(1);
  for (const auto& [lobe, most] : {std::pair{Lobe(Cosine{}), 0.007},
                                   {Lobe(Ggx(1)), 0.007},
                                   {Lobe(Ggx(0.5)), 0.007},
                                   {Lobe(BlinnPhong(2)), 0.007},
                                   {Lobe(Charlie(1)), 0.007},
                                   {Lobe(Phong{1.0001}), 0.07},
                                   {Lobe(Phong{1.01}), 0.07},
                                   {Lobe(Phong{1.1}), 0.07},
                                   {Lobe(Phong{1.3}), 0.03},
                                   {Lobe(Phong{1.5}), 0.013},
                                   {Lobe(Phong{2}), 0.007},
                                   {Lobe(Phong{3}), 0.007}}) {
    EXPECT_LE(most, std::visit([](const auto& l) { return together(l); }, lobe));
    for (const auto& [along, up] : {std::pair{1, 0}, {1, 1}, {2, 1}, {3, 1}, {3, 2}})
      for (double above = -0.5; above <= 0.5; above += 0.1)
        EXPECT_LE(off_together(lobe, cells_along_horizon(along, up, above, 0.02, 60 / (along + up)), even).all, most)
            << lobe.index() << " " << along << ":" << up << " " << above;
  }
}

TEST(Together, CellsOfOneLightAlongTheHorizonAreOffByLessThanCounts) {
  Draw draw(5);
  std::vector<double> found;
  for (int n = 0; n < 100; ++n) {
    std::array<float, 16> light;
    for (float& x : light) x = float(std::exp((1 + n % 3 * 3) * draw.even()));
    double worst = 0;
    for (double above = -0.5; above <= 0.5; above += 0.1) {
      const Together off = off_together(Cosine{}, cells_along_horizon(1, n % 2, above, 0.02, 10), light);
      worst = std::max(worst, off.all);
      EXPECT_LE(off.one, EitherWay::any);
    }
    found.push_back(worst);
  }
  std::ranges::sort(found);
  EXPECT_LE(found[89], together(Cosine{}));
  EXPECT_LE(found.back(), 2 * together(Cosine{}));
}

}  // namespace
}  // namespace envmap::prefiltering::criterion_test

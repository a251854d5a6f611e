// Moments of many small nodes put together, against sums in double over all of them.
#include "envmap/prefilter/node.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "every_target.h"

namespace envmap::prefiltering::node_test {
namespace {

// Point-like nodes of any colour round a direction, some black, one of them a sun.
std::vector<Node> some_nodes(std::size_t count) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> even;
  std::vector<Node> all;
  for (std::size_t k = 0; k < count; ++k) {
    Moments patch;
    patch.solid_angle = 1e-4 * (0.5 + even(random));
    patch.centre = 0.9999 * glm::normalize(Direction(0.1 * normal(random), 0.1 * normal(random), 1));
    patch.covariance.add_square(Direction(normal(random), normal(random), normal(random)), 1e-5);
    patch.spread = 1e-2, patch.reach = 2e-2;
    const Flux radiance = k % 7 == 0 ? Flux(0) : Flux(even(random), 2 * even(random), k % 5 == 0 ? 0 : even(random));
    all.push_back(node_of(patch, k == 3 ? 1e4 * radiance : radiance));
  }
  return all;
}

struct Truth {
  Direction centre{0};
  std::array<double, node_channels> flux{};
  Symmetric covariance;
  std::array<Direction, node_channels> dipole{};
  std::array<double, node_channels> cubes{};
  double uneven = 0, reach = 0;
};

Truth truth_of(const std::vector<Node>& nodes) {
  Truth t;
  double whole = 0;
  const auto weight = [](const Node& l) {
    return (double(l.flux[0]) + l.flux[1] + l.flux[2]) / 3;
  };
  const auto add = [](Symmetric& to, const Node& l, const Direction& off, double w) {
    for (std::size_t n = 0; n < 6; ++n) to.m[n] += w * covariance_of(l)[n];
    to.add_square(off, w);
  };
  for (const Node& l : nodes) whole += weight(l), t.centre += weight(l) * l.centre;
  t.centre /= whole;
  std::array<Symmetric, node_channels> second;
  for (const Node& l : nodes) {
    const Direction off = l.centre - t.centre;
    add(t.covariance, l, off, weight(l) / whole);
    if (is_lit(l)) t.reach = std::max(t.reach, glm::length(off) + l.reach);
    for (std::size_t c = 0; c < node_channels; ++c) {
      t.flux[c] += l.flux[c];
      t.dipole[c] += double(l.flux[c]) * off;
      t.cubes[c] += l.flux[c] * std::pow(glm::length(off), 3);
      add(second[c], l, off, l.flux[c]);
    }
  }
  for (std::size_t c = 0; c < node_channels; ++c) {
    for (std::size_t n = 0; n < 6; ++n) second[c].m[n] = second[c].m[n] / t.flux[c] - t.covariance.m[n];
    t.uneven = std::max(t.uneven, second[c].norm());
  }
  return t;
}

void expect_moments(const Node& found, const Truth& truth) {
  EXPECT_LT(glm::length(found.centre - truth.centre), 1e-7);
  const double reach = truth.reach;
  for (std::size_t n = 0; n < 6; ++n) EXPECT_NEAR(covariance_of(found)[n], truth.covariance.m[n], 1e-5 * reach * reach);
  for (std::size_t c = 0; c < node_channels; ++c) {
    EXPECT_NEAR(found.flux[c], truth.flux[c], 1e-6 * truth.flux[c]);
    EXPECT_LT(glm::length(Direction(found.dipole[c]) - truth.dipole[c]), 1e-5 * reach * truth.flux[c]);
    EXPECT_GE(std::pow(found.spread, 3) * truth.flux[c], truth.cubes[c]);
  }
  EXPECT_GE(found.uneven, truth.uneven * (1 - 1e-4));
  EXPECT_GE(found.reach, truth.reach * (1 - 1e-6));
}

TEST(Node, ManyPutTogetherHaveTheMomentsOfAllInAnyGroups) {
  on_every_target([](const char* target) {
    SCOPED_TRACE(target);
    for (const std::size_t count : {1U, 2U, 15U, 16U, 17U, 300U, 5000U}) {
      SCOPED_TRACE(count);
      const std::vector<Node> all = some_nodes(count);
      if (count > 7) expect_moments(united(all), truth_of(all));
      const std::size_t half = count / 2;
      const std::array two{united(std::span(all).first(half)), united(std::span(all).subspan(half))};
      if (count > 7) expect_moments(united(two), truth_of(all));
      if (count == 1) {
        EXPECT_EQ(united(two).flux, all[0].flux);
      }
    }
  });
}

TEST(Node, WithoutLightsThereIsNone) {
  EXPECT_FALSE(is_lit(united(std::span<const Node>())));
  const std::array none{Node{}, Node{}};
  const Node found = united(none);
  EXPECT_FALSE(is_lit(found));
  EXPECT_EQ(found.reach, 0);
  EXPECT_EQ(found.spread, 0);
}

}  // namespace
}  // namespace envmap::prefiltering::node_test

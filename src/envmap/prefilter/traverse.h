/// @file
/// The opening criterion of the treecode, and the traversal of the stored nodes (Barnes and Hut 1986, "A hierarchical
/// O(N log N) force-calculation algorithm"; Appel 1985, "An efficient program for many-body simulation"). As in
/// lightcuts (Walter et al. 2005) a node is opened where what it may be off counts beside what a direction gets in all.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "envmap/prefilter/lobe.h"
#include "envmap/prefilter/node.h"

namespace envmap::prefiltering {

/// What the opening criterion asks of nodes, side by side.
template <std::size_t N>
struct alignas(4 * N) NodeHeads {
  using Lanes = std::array<float, N>;
  std::array<Lanes, 3> centre;
  Lanes reach, spread, uneven;
  std::array<Lanes, node_channels> flux;

  /// Far below any horizon.
  static NodeHeads none() {
    NodeHeads h{};
    for (Lanes& x : h.centre) x.fill(9);
    return h;
  }
  /// @param from what the centre is counted from.
  void set(std::size_t lane, const Node& node, const Direction& from = Direction(0)) {
    for (std::size_t n = 0; n < 3; ++n) centre[n][lane] = float(node.centre[int(n)] - from[int(n)]);
    reach[lane] = node.reach, spread[lane] = node.spread, uneven[lane] = node.uneven;
    for (std::size_t c = 0; c < node_channels; ++c) flux[c][lane] = node.flux[c];
  }
};
using NodeQuad = NodeHeads<4>;
using NodeGroup = NodeHeads<16>;  ///< What is judged at once.

/// The directions of a tile, and what is good enough for them.
struct Criterion {
  Direction middle;    ///< A unit vector.
  double radius = 0;   ///< No direction is farther from the middle.
  NodeFlux darkest{};  ///< What every direction gets of a channel besides.
  NodeFlux most{};     ///< 1 over the least that any direction gets of it in all.
  float limit = 0;     ///< What a node may be off, relative to that.
  /// Looks for the least that directions get: a node is good where the lobe changes by less than the limit over it.
  bool surveying = false;
  std::size_t max_nodes = SIZE_MAX;  ///< There is no use for more.
};

/// What a criterion makes of a group of nodes; a bit each.
struct Judged {
  unsigned visible = 0;  ///< Above the horizon.
  unsigned good = 0;     ///< And good enough.
  /// The lobe is no smooth function over the node: the horizon crosses it, or it is wide.
  unsigned bent = 0;
  unsigned crossed = 0;                ///< The horizon may cross the node.
  alignas(64) NodeGroup::Lanes error;  ///< Bounds of what good ones are off, relative to the result.
  /// Of that, what channels make that spread unlike each other, where the lobe is smooth.
  alignas(64) NodeGroup::Lanes uneven;
  alignas(64) NodeGroup::Lanes least;  ///< The lobe, at least, while surveying.
};

/// The bound of what evaluate() makes of a node, for any direction of the tile. It is a theorem, which tests/unit holds
/// against random nodes, lobes and directions.
///
/// A direction r sees the node as a distribution of X = 1 - r.l. evaluate() puts it at X0 - s and X0 + s, X0 = 1 - r.c
/// its mean and s^2 = r^T S r its variance over all channels, with weights that give a channel its own mean. With rho =
/// reach, h = spread and e = (rho + h) / 2, which bounds how far directions leave the tangent plane, |X - X0| is in the
/// cubic mean at most a = h (sin + e), and a channel's variance is off by at most m = sin^2 uneven + (4 sin e + e^2)
/// h^2 and by uneven. All X and X0 +- s lie in [lo, hi], a little more than what rho allows. For the lobe f,
/// falling on [lo, hi]:
///  - smooth, hi < 1: Taylor's series about X0 agrees to the second term, but for m;
/// the rest is at most max|f'''| / 6 x the
///    mean |X - X0|^3, which is at most a^3 of the node and, as s and the channel's mean are at most a,
/// of the two points,
///    too, even where one has a weight below 0. That makes m max|f''| / 2 + a^3 max|f'''| / 3;
///  - convex: with one mean, either lies between f(mean) and the chord of f over [lo, hi], which are apart by at most
///    g (1 - g / (L (hi - lo))), g = f(lo) - f(hi), L = |f'(lo)|; where the mean lies beyond X0 +- s,
/// which it does by at most
///    sqrt(m), the line through the two points goes on, and may leave f by L sqrt(m) more.
/// And neither is ever above f(lo);
///  - else weights are kept between 0 and 1, and either lies between the least and the most of f.
/// Then the mean of the points
///    may be off by sqrt(m), which adds max|f'| sqrt(m) to the first of these bounds. Where f has no step,
/// it differs from a line
///    by half the range G of f' x |X - X0|, which is at most a in the mean, both ways: G a + max|f'| sqrt(m).
/// Where a kink K of f, at the horizon, is within 3^(1/2) s of X0, evaluate() rounds it as an even interval does, which
/// adds at most
/// 0.0774 s K to all of these: (1 / 3^(1/2) - 1/2) s K, what it differs from two points by.
/// @param nodes their centres from the middle of the tile. @param count of them that are asked for.
Judged judge(const Lobe& lobe, const Criterion& criterion, const NodeGroup& nodes, std::size_t count);

inline constexpr double least_part = 1e-3;
inline float least_variance(float most) { return std::max(1e-30F, float(least_part) * most); }

class Tree;

/// A block of the lowest stored level that is not good enough.
struct OpenBlock {
  int face, i, j;
};

/// What many nodes are off together, as a part of the root of the sum of squares of their bounds: of any, and of parts
/// of one texel, which are lit alike and may be off the same way. Measured: see treecode.h.
struct EitherWay {
  static constexpr double any = 0.05, alike = 0.2;
};

/// Nodes that the horizon crosses may all be off the same way: where it runs along the rows of a grid, or its
/// diagonals, it crosses all of them in the same place. Evenly lit ones are then off by up to 0.007 of their bounds,
/// those with the same light in all of them by 0.015 (9 of 10 random lights; the worst 0.023), and by 0.07 under lobes
/// that have no kink there but nearly one: tests/unit/criterion_test.cpp.
/// So this share of the sum of their bounds counts, too.
template <class L>
double together(const L& /*lobe*/) {
  return 0.015;
}
inline double together(const Phong& l) { return l.exponent < 1.5 ? 0.07 : 0.015; }

/// The rows of a latlong map run round its poles. Light that repeats along them is off the same way in all nodes of a
/// row, as seen from near a pole: by up to 0.031 of the sum of all bounds, measured over random patterns
/// (tests/bench/hostile.cpp).
inline constexpr double together_at_pole = 0.035, near_pole = 0.95;  ///< From this height on.

/// A node that the horizon of directions of a tile may cross: where |offset - centre|^2 / 2 is within `reach` of
/// `horizon`.
struct CrossedNode {
  Vec3<float> centre;  ///< From the middle of the tile.
  float horizon, reach;
  float error;  ///< Bound.
};

/// What a traversal found. Kept between traversals for its memory.
struct Traversal {
  std::vector<const Node*> nodes;
  std::vector<Node> channels;  ///< Of nodes that were taken apart.
  std::vector<OpenBlock> opened;
  double stepped;       ///< Sum of the bounds of nodes that a step of the lobe may cut, all off the same way.
  double sum, largest;  ///< Of the bounds of others.
  double uneven;        ///< Sum of what is off because channels spread unlike each other.
  double power;         ///< Sum of the squares of what they are off either way.
  std::vector<CrossedNode> crossed;              ///< But for stepped ones.
  NodeFlux got;                                  ///< What directions get at least of the nodes.
  std::array<double, node_channels> integrated;  ///< What the direction gets of pieces that are no nodes.
  std::size_t count;                             ///< Of good nodes, those below the stored blocks among them.

  /// @param alike whether texels are parts of larger ones: see Tree::parts().
  /// @param pole whether the tile is near one of a latlong map.
  void clear(const Lobe& lobe, bool alike, bool pole) {
    steps_ = std::visit([](const auto& l) { return l.breaks_off(); }, lobe);
    together_ = std::visit([](const auto& l) { return together(l); }, lobe);
    nodes.clear(), channels.clear(), opened.clear(), crossed.clear();
    alike_ = alike, at_pole_ = pole ? together_at_pole : 0;
    stepped = sum = power = largest = uneven = 0;
    count = 0;
    got = {}, integrated = {};
  }
  void add_error(double error, bool bent) {
    if (bent && steps_) {
      stepped += error;
      return;
    }
    const double either = (alike_ ? EitherWay::alike : EitherWay::any) * error;
    sum += error;
    power += either * either;
    largest = std::max(largest, error);
  }
  /// A node that is good enough, as number k of those judged.
  void add(const Node& node, const Judged& judged, std::size_t k, const Direction& middle) {
    ++count;
    add_error(judged.error[k], judged.bent >> k & 1);
    uneven += judged.uneven[k];
    if (judged.crossed >> k & 1) add_crossed(node, middle, judged.error[k]);
  }
  void add_crossed(const Node& node, const Direction& middle, float error) {
    if (steps_) return;
    crossed.push_back(
        {Vec3<float>(node.centre - middle), float(1 - 0.5 * sag_of(covariance_of(node))), node.reach, error});
  }
  /// What all nodes together are off. @param crossed_sum of the bounds of those that the horizon crosses.
  [[nodiscard]] double figure(double crossed_sum) const {
    return stepped + std::min(sum, largest + std::sqrt(power) + together_ * crossed_sum + at_pole_ * sum + uneven);
  }
  void add_least(Criterion& criterion, const NodeFlux& flux, float value) {
    for (std::size_t c = 0; c < node_channels; ++c) {
      got[c] += value * flux[c];
      criterion.most[c] = std::min(criterion.most[c], 1 / (criterion.darkest[c] + got[c]));
    }
  }

 private:
  bool steps_ = false, alike_ = false;
  double together_ = 0, at_pole_ = 0;
};

/// Whether a node that is good enough is so uneven that its channels are better taken one by one: where the light is a
/// coloured pattern, what that is off adds up. What is below this counts in full.
inline constexpr double uneven_part = 0.002;
inline bool is_uneven(const Judged& judged, std::size_t k, const Criterion& criterion) {
  return judged.uneven[k] > uneven_part * criterion.limit;
}
/// Adds the channels of a node one by one. @return false, and nothing is added, where they are not all good enough.
bool add_channels(const Lobe& lobe, const Criterion& criterion, const Node& node, Traversal& found);

/// Goes down from the largest blocks until they are good, or the lowest. @param criterion while surveying `most` falls
/// with what is found. Stops early where there are more nodes than of use.
void traverse(const Tree& tree, const Lobe& lobe, Criterion& criterion, Traversal& found);

}  // namespace envmap::prefiltering

/// @file
/// Nodes of a tree beside the directions of a tile: what a node may be off in any of them, and what nodes add up to.
///
/// Theorem. A node is a measure mu >= 0 on the unit sphere, F its flux, c its centre, D and S the integrals of d - c
/// and (d - c)(d - c)^T. For a unit vector r, t = r.(d - c) and u0 = r.c, Taylor's series of K in the cosine gives
///
///   integral of K(r.d) = F K(u0) + K'(u0) r.D + K''(u0)/2 r.S r + rest,
///   |rest| <= 1/2 (max K'' - min K'') E2          E2 = integral of t^2,
///   |rest| <= 1/6 max|K'''| E3                    E3 = integral of |t|^3,
///   |rest| <= 1/6 max|K'''| |integral of t^3| + 1/24 max|K''''| E4,
///
/// the extremes over the cosines that the node spans, u0 among them. With s the sine of the angle between r and the
/// node's axis, t = s e.T + cos N (TreeNode), so by Minkowski and Cauchy-Schwarz, per unit of flux:
///
///   E2^(1/2) <= s tangent2 + radial2 = t2,   E4^(1/4) <= s tangent4 + radial4 = t4,   E3 <= t2 t4^2,
///   |integral of t^3| <= s^3 tangent3 + 3 s^2 tangent4^2 radial2 + 3 s tangent2 radial4^2 + radial2 radial4^2.
///
/// Where the horizon cuts the node, only the rests hold whose derivatives are bounded there (TreecodeLobe::smooth). Of
/// Phong's lobe k u^m with 1 < m < 2, K + K' t is off by at most k E|t|^m <= k t2^m, as |a^(m-1) - b^(m-1)| <=
/// |a - b|^(m-1). And K always lies between its extremes: half of their distance is the bound of their middle.
///
/// To each bound comes what rounding to float may add, by counting operations. What the logarithms and powers of
/// lobe_lanes-inl.h are off by is stated there. No errors are taken to cancel: the bound of a sum is
/// the sum of the bounds. tests/unit/treecode_bound_test.cpp holds every step against random nodes.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "envmap/prefilter/treecode/lobe_bounds.h"
#include "envmap/prefilter/treecode/tree.h"

namespace envmap::prefiltering {

/// Directions near each other.
struct Tile {
  static constexpr std::size_t most = 64;
  std::size_t count = 0;
  Direction middle;                             ///< A unit vector.
  double cosine, sine;                          ///< Of the angle from the middle that no direction exceeds.
  alignas(64) std::array<float, most> x, y, z;  ///< Of directions from the middle; the last one repeats.

  /// @param directions one at least. One only where they do not have a middle.
  explicit Tile(std::span<const Direction> directions);
};

/// How a node is summed.
enum class Form : unsigned char {
  taylor,  ///< By K, K' and K''.
  linear,  ///< By K and K'.
  even,    ///< As if K were even over it, but for a line.
};

/// The bounds of a group of nodes.
struct Judged {
  unsigned visible = 0;  ///< Above the horizon of some direction; a bit each.
  std::array<Form, 16> form;
  alignas(64) NodeGroup::Lanes bound;  ///< What a node is off in any direction of the tile, per unit of flux, at most.
  alignas(64) NodeGroup::Lanes even, line;  ///< Form::even: K = even - line x cosine.
};
void judge(const TreecodeLobe& lobe, const Tile& tile, const NodeGroup& nodes, Judged& out);

/// A node that was good enough.
struct Accepted {
  const TreeNode* node;
  float even, line;
};

/// Nodes by form.
struct NodeSums {
  std::array<std::vector<Accepted>, 3> by_form;
  std::vector<Accepted>& of(Form f) { return by_form[std::size_t(f)]; }
  [[nodiscard]] const std::vector<Accepted>& of(Form f) const { return by_form[std::size_t(f)]; }
  [[nodiscard]] std::size_t count() const { return by_form[0].size() + by_form[1].size() + by_form[2].size(); }
  void clear() {
    for (auto& f : by_form) f.clear();
  }
};

/// Sums of nodes in each direction of a tile, each channel.
using TileSums = std::array<std::array<double, Tile::most>, channels>;
void evaluate(const TreecodeLobe& lobe, const NodeSums& nodes, const Tile& tile, TileSums& out);

}  // namespace envmap::prefiltering

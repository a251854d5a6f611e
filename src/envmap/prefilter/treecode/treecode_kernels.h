/// @file
/// Nodes of a tree seen from the directions of a tile: the bound of a node's error in all of them, and sums of nodes.
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
/// Phong's lobe k u^m with 1 < m < 2, the error of K + K' t is at most k E|t|^m <= k t2^m, as |a^(m-1) - b^(m-1)| <= |a
/// - b|^(m-1). And K always lies between its extremes: half of their distance is the bound of their middle.
///
/// Each bound includes the rounding to float, derived by counting operations; fast_math-inl.h states the error of
/// logarithms and powers. No step assumes that errors cancel: the bound of a sum is the sum of the bounds.
/// tests/unit/treecode_bound_test.cpp holds every step against random nodes.
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
  double cosine, sine;                          ///< The angle from the middle that no direction exceeds.
  alignas(64) std::array<float, most> x, y, z;  ///< Directions less the middle. The last direction repeats.

  /// @param directions at least one; a single one where they have no middle.
  explicit Tile(std::span<const Direction> directions);
};

/// How a node is summed.
enum class Form : unsigned char {
  taylor,    ///< K is replaced by its Taylor series to the second order.
  linear,    ///< K is replaced by its Taylor series to the first order.
  constant,  ///< K is replaced by the middle of its range, less a line.
};

/// The bounds of a group of nodes.
struct NodeBounds {
  unsigned visible = 0;  ///< A bit for each node that is above the horizon of some direction.
  std::array<Form, 16> form;
  alignas(64) NodeGroup::Lanes bound;           ///< Bound of the error in all directions of the tile, per unit of flux.
  alignas(64) NodeGroup::Lanes constant, line;  ///< Form::constant: K = constant - line x cosine.
};
void bound_nodes(const TreecodeLobe& lobe, const Tile& tile, const NodeGroup& nodes, NodeBounds& out);

/// A node whose bound was small enough, with its constants of NodeBounds.
struct Accepted {
  const TreeNode* node;
  float constant, line;
};

/// The nodes of a tile by form.
struct NodeSums {
  std::array<std::vector<Accepted>, 3> by_form;
  std::vector<Accepted>& of(Form f) { return by_form[std::size_t(f)]; }
  [[nodiscard]] const std::vector<Accepted>& of(Form f) const { return by_form[std::size_t(f)]; }
  [[nodiscard]] std::size_t count() const { return by_form[0].size() + by_form[1].size() + by_form[2].size(); }
  void clear() {
    for (auto& f : by_form) f.clear();
  }
};

/// Sums of nodes, for each channel and each direction of a tile.
using TileSums = std::array<std::array<double, Tile::most>, channels>;
void evaluate(const TreecodeLobe& lobe, const NodeSums& nodes, const Tile& tile, TileSums& out);

}  // namespace envmap::prefiltering

/// @file
/// The node that a few neighbouring directions get from a list of nodes: the inner loop of the hierarchical method.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "envmap/prefilter/node.h"
#include "envmap/prefilter/lobe.h"

namespace envmap::prefiltering {

/// A node as seen from a tile: everything relative to the tile's middle, worked out in double, so that float32 holds it
/// for lobes of any width. With offset o from the middle, x = 1 - cos is (|o - centre|^2 + sag) / 2, the variance of
/// the cosine over the node variance + slope . o + o^T covariance o, the mean cosine of a channel above that of all
/// (lean + dipole . o) / flux. `most_variance` is what judge() takes for granted of it.
struct TileNode {
  std::array<float, 3> centre;
  float sag;
  float variance, most_variance;
  bool near_horizon;  ///< For some direction of the tile.
  std::array<float, 3> slope;
  std::array<float, 6> covariance;
  NodeFlux flux;
  NodeFlux lean;
  std::array<std::array<float, 3>, node_channels> dipole;
};

/// @param radius no direction of the tile is farther from its middle.
TileNode seen_from_tile(const Node& node, const Direction& middle, double radius);

/// Directions near each other. Offsets from the middle, padded to whole vectors by the caller with what it likes.
struct Tile {
  static constexpr std::size_t most = 64;
  Direction middle;   ///< A unit vector.
  double radius = 0;  ///< No direction is farther from it.
  std::size_t count = 0;
  alignas(64) std::array<float, most> x, y, z;
  alignas(64) std::array<std::array<float, most>, node_channels> sums;
};

/// Sets the sums of a tile. Each node is taken as two nodes one standard deviation of the cosine to either side, which
/// have its flux, mean and variance (two-point Gauss-Hermite quadrature); what each has of a channel follows from the
/// channel's own mean. The kink of a lobe at the horizon is taken over an even interval instead, or all nodes that lie
/// in the same way along a horizon would be off alike. Nothing is ever negative.
void evaluate(const Lobe& lobe, std::span<const TileNode> nodes, Tile& tile);

/// Sixteen nodes as one direction sees them: 1 - cos of the mean, the variance of the cosine, and a channel's flux and
/// dipole along the direction.
struct SeenNodes {
  static constexpr std::size_t most = 16;
  alignas(64) std::array<float, most> versine, variance;
  alignas(64) std::array<std::array<float, most>, node_channels> flux, lean;
};

/// Adds a node to the last sight, or to a new one. @param count nodes so far.
void add_seen(const Node& node, const Direction& middle, std::size_t& count, std::vector<SeenNodes>& seen);

/// The same as evaluate() in one direction: a vector is of nodes instead of directions.
std::array<double, node_channels> evaluate(const Lobe& lobe, std::span<const SeenNodes> seen);

}  // namespace envmap::prefiltering

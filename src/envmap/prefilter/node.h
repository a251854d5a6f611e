/// @file
/// A part of the source as a lobe sees it from afar: its flux, where it lies and how it spreads.
#pragma once

#include <array>
#include <span>

#include "envmap/prefilter/cell.h"

namespace envmap::prefiltering {

/// Red, green and blue flux, in units of the source's mean radiance, beyond what the darkest texel gives:
/// see Tree::beyond().
inline constexpr std::size_t node_channels = 3;
using NodeFlux = std::array<float, node_channels>;

/// Moments of the flux over a block of texels about the mean direction of all channels together.
/// Without flux it is none.
struct Node {
  Direction centre;  ///< Mean direction: inside the sphere, by half the variance.
  NodeFlux flux;
  std::array<Vec3<float>, node_channels> dipole;              ///< Sum of flux x offset.
  std::array<std::array<float, 6>, node_channels> second;  ///< Mean square of offsets: xx, xy, xz, yy, yz, zz.
  float uneven;  ///< No channel's second moment is farther than this from the covariance.
  float spread;  ///< Cube root of the mean |offset|^3, that of the channel where it is largest, or above.
  float reach;   ///< No direction is farther from the centre.
};

inline bool is_lit(const Node& node) { return node.flux[0] + node.flux[1] + node.flux[2] > 0; }

/// Of all channels together.
std::array<float, 6> covariance_of(const Node& node);

/// 1 - |centre|^2: for directions, which are unit vectors, that is their mean square offset,
/// of which float32 has more digits.
inline double sag_of(const std::array<float, 6>& covariance) {
  return double(covariance[0]) + covariance[3] + covariance[5];
}

/// One channel of a node as a node, about its own mean direction.
Node channel_of(const Node& node, std::size_t channel);

/// Even radiance over a patch. @param radiance in units of the mean.
Node node_of(const Moments& patch, const Flux& radiance);

/// Several as one.
Node united(std::span<const Node> parts);

/// Sixteen of something side by side, places counted from sixteen origins: what is put together is that at once.
inline constexpr std::size_t batch_size = 16;
using Lanes = std::array<float, batch_size>;

/// How far texels spread by themselves; those of a row of a block are taken to be alike.
struct ShapeBatch {
  alignas(64) std::array<Lanes, 6> covariance;
  alignas(64) Lanes spread, reach;

  void set(std::size_t lane, const Moments& patch);
};
struct TexelBatch {
  alignas(64) std::array<Lanes, 3> centre;
  alignas(64) std::array<Lanes, node_channels> flux;
  const ShapeBatch* row;

  /// @param offset from the origin, of the texel's mean direction. @param radiance in units of the mean.
  void set(std::size_t lane, const Direction& offset, double solid_angle, const Flux& radiance);
};
struct NodeBatch {
  alignas(64) std::array<Lanes, 3> centre;
  alignas(64) std::array<Lanes, node_channels> flux;
  alignas(64) std::array<std::array<Lanes, 3>, node_channels> dipole;
  alignas(64) std::array<std::array<Lanes, 6>, node_channels> second;
  alignas(64) Lanes uneven, spread, reach;

  void set(std::size_t lane, const Node& node, const Direction& origin);
  [[nodiscard]] Node node(std::size_t lane, const Direction& origin) const;
};

/// The first of all parts as one, the second of all, and so on. Parts without flux count nothing.
void unite(std::span<const TexelBatch> parts, NodeBatch& whole);
void unite(std::span<const NodeBatch> parts, NodeBatch& whole);

}  // namespace envmap::prefiltering

/// @file
/// Moments of light on the sphere to the third order, and the node that the treecode makes of them.
///
/// A node is the light of a part of the sphere: a measure for each channel. Moments about the origin add up, so the
/// moments of a block are the plain sums of those of its parts. finished() moves them to the centre of the node, and
/// computes the five scalars of which the bounds of treecode_kernels.h are made.
#pragma once

#include <array>
#include <cstddef>

#include "envmap/maths/quadrature.h"
#include "envmap/maths/vector.h"

namespace envmap::prefiltering {

inline constexpr std::size_t channels = 3;

/// Integrals over one measure of 1, d, dd and ddd, d the direction: 1; x y z; xx xy xz yy yz zz; xxx xxy xxz xyy xyz
/// xzz yyy yyz yzz zzz.
using Moments3 = std::array<double, 20>;

/// Rounding of moments about a centre, per unit of flux, at most: a block is summed row by row, of 64 texels or fewer
/// each, and the moments whose differences are taken are below 1.
inline constexpr double moment_loss = 2e-14;

/// The light of a part of the sphere.
struct Light {
  std::array<Moments3, channels> moments{};
  Direction centre{0};  ///< Mean direction of all channels, each counted relative to its own flux in the whole map.
  double bounding_radius = 0;  ///< No light is farther from the centre.

  [[nodiscard]] bool lit() const { return moments[0][0] + moments[1][0] + moments[2][0] > 0; }
};

/// A node as it is bounded and summed. The scalars are per unit of flux, of the channel where each is largest.
struct TreeNode {
  Direction axis;      ///< Unit vector to the centre c.
  float sag;           ///< 1 - |c|: how deep the centre lies inside the sphere.
  float cosine, sine;  ///< Cosine and sine of the largest angle between the axis and any light.
  /// With d - c = tangential part T + radial part N: (E (e.T)^2)^(1/2) and (E (e.T)^4)^(1/4) at most, for any unit
  /// vector e, the norm of E TTT, (E N^2)^(1/2), and (E N^4)^(1/4) at most.
  float tangent2, tangent4, tangent3, radial2, radial4;
  std::array<float, channels> flux;
  std::array<std::array<float, 3>, channels> first;   ///< Integral of d - c.
  std::array<std::array<float, 6>, channels> second;  ///< Integral of (d - c)(d - c)^T: xx xy xz yy yz zz.
};

/// Weight of each channel in the centre of a node: 1 over its flux in the whole map.
using ChannelWeights = std::array<double, channels>;

/// A rectangle of a cube or latlong map under uniform light.
struct Patch {
  Moments3 moments{};  ///< Moments of radiance 1.
  Direction centre{0};
  double bounding_radius = 0;
};
/// Computes a patch by 3 x 3 Gauss points. @tparam P projection of the map. @param rect at most 1.5 degrees across, so
/// that central moments are right to 4e-12 of those of a rectangle as large, which float_above() of the source file
/// covers.
template <class P>
Patch patch_of(int face, const Rect& rect);

/// Moments of the rotated measure. @param turn an orthogonal matrix.
Moments3 turned(const Moments3& m, const Rotation& turn);

/// Sets the centre of the moments.
void set_centre(Light& light, const ChannelWeights& weights);

/// @param light lit.
TreeNode finished(const Light& light);

/// The node of one patch under uniform light.
TreeNode node_of(const Patch& patch, const std::array<double, channels>& radiance);

}  // namespace envmap::prefiltering

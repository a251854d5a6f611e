/// @file
/// Moments of light on the sphere to the third order, and what a treecode keeps of them.
///
/// A node is the light of a part of the sphere: a measure of each channel. Moments about the origin add up, so a node
/// is the plain sum of its parts. finished() turns them about the node's centre, and works out the five scalars that
/// the bounds of treecode_kernels.h are made of.
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

/// What rounding may add to or take from moments about a centre, per unit of flux: sums of a block go row by row, of 64
/// texels or fewer each, and the moments they are differences of are below 1.
inline constexpr double moment_loss = 2e-14;

/// The light of a part of the sphere.
struct Light {
  std::array<Moments3, channels> moments{};
  Direction centre{0};  ///< Mean direction of all channels, each counted relative to its own flux in the whole map.
  double reach = 0;     ///< No light is farther from the centre.

  [[nodiscard]] bool lit() const { return moments[0][0] + moments[1][0] + moments[2][0] > 0; }
};

/// A node as it is summed and judged. All but the flux is per unit of flux, and of the channel where it is largest.
struct TreeNode {
  Direction axis;      ///< Unit vector to the centre c.
  float sag;           ///< 1 - |c|.
  float cosine, sine;  ///< Of the angle from the axis that no light exceeds.
  /// With d - c = tangential part T + radial part N: (E (e.T)^2)^(1/2) and (E (e.T)^4)^(1/4) at most, for any unit
  /// vector e, the norm of E TTT, (E N^2)^(1/2), and (E N^4)^(1/4) at most.
  float tangent2, tangent4, tangent3, radial2, radial4;
  std::array<float, channels> flux;
  std::array<std::array<float, 3>, channels> first;   ///< Integral of d - c.
  std::array<std::array<float, 6>, channels> second;  ///< Integral of (d - c)(d - c)^T: xx xy xz yy yz zz.
};

/// 1 over the flux of each channel in the whole map: what its light counts in the centre of a node.
using ChannelWeights = std::array<double, channels>;

/// A rectangle of a cube or latlong map, evenly lit.
struct Patch {
  Moments3 moments{};  ///< Of radiance 1.
  Direction centre{0};
  double reach = 0;
};
/// By 3 x 3 Gauss points. @tparam P projection of the map. @param rect at most 1.5 degrees across, so that central
/// moments are right to 4e-12 of those of a rectangle as large, which float_above() of the source file covers.
template <class P>
Patch patch_of(int face, const Rect& rect);

/// The same measure seen from a turned frame. @param turn an orthogonal matrix.
Moments3 turned(const Moments3& m, const Rotation& turn);

/// Sets the centre of the moments.
void set_centre(Light& light, const ChannelWeights& weights);

/// @param light lit.
TreeNode finished(const Light& light);

/// A node of one patch, evenly lit.
TreeNode node_of(const Patch& patch, const std::array<double, channels>& radiance);

}  // namespace envmap::prefiltering

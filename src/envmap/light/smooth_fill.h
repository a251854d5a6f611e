/// @file
/// A region of a map as its rim continues it.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "envmap/light/texel_patch.h"

namespace envmap {

/// Colours for the texels of a region: means of those round it, weighted by 1 / distance^3 (Shepard 1968, "A
/// two-dimensional interpolation function for irregularly-spaced data"), and beyond the rim as much brighter as its
/// surroundings grow towards it: a glow does not stop where a disc begins. None is brighter in any channel than the
/// texel was.
/// @param colour of a texel as it is.
std::vector<Colour> smooth_fill(const TexelGeometry& geometry, std::span<const Texel> region,
                                const std::function<Colour(const Texel&)>& colour);

}  // namespace envmap

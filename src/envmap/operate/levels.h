/// @file
/// Mip levels that keep the light: every texel is the solid-angle weighted mean of what it covers in the level before.
#pragma once

#include "envmap/map/environment_map.h"

namespace envmap {

/// The level after: half as high, rounded down, at least 1. Where a size is odd, texels that straddle two of the result
/// count for each by the solid angle of the part. Flux is kept to the rounding of float32. Texels of a paraboloid map
/// outside the disc are plain means; those of sphere and angular maps 0.
/// @param fine before fill_gutter(), which puts other values into the texels of a rim whose centres lie outside the disc.
Level half_level(const Level& fine);

/// Adds the levels after the last one, down to a height of 1. No gutter is filled.
void add_levels(std::vector<Level>& levels);

}  // namespace envmap

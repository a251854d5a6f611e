/// @file
/// The middle of a narrow lobe, summed over the texels of the source: narrower than any grid of multilevel sums.
#pragma once

#include "envmap/map/environment_map.h"
#include "envmap/prefilter/multilevel_kernels.h"

namespace envmap::prefiltering {

/// The largest angle from the middle at which a core may end, in radians: cube faces farther away are left out.
inline constexpr double widest_core = 0.2;

/// The integral of (radiance - darkest) x kernel over the sphere. Texels are divided until 16 Gauss points of each
/// piece are good enough; what is left is measured by tests/bench/kappa.cpp.
/// @param source a cube or latlong map in texels of 1.5 degrees or less. @param direction a unit vector.
Flux core_sum(const Level& source, const Colour& darkest, const LevelKernel& kernel, const Direction& direction);

}  // namespace envmap::prefiltering

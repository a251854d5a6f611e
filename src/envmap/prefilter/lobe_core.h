/// @file
/// The middle of a narrow lobe, summed over the texels of the source: narrower than any grid of multilevel sums.
#pragma once

#include "envmap/map/environment_map.h"
#include "envmap/prefilter/multilevel_kernels.h"

namespace envmap::prefiltering {

/// The largest angle from the middle at which a core may end, in radians: cube faces farther away are left out.
inline constexpr double widest_core = 0.2;

/// The integral of (radiance - darkest) / unit x kernel over the sphere, eight texels at a time where sixteen Gauss
/// points of each are good enough. The others are divided until they are. What is left is measured by
/// tests/bench/kappa.cpp.
/// @param source a cube or latlong map in texels of 1.5 degrees or less. @param unit about the mean of its radiance.
/// @param direction a unit vector.
Flux core_sum(const Level& source, const Colour& darkest, double unit, const LevelKernel& kernel,
              const Direction& direction);

}  // namespace envmap::prefiltering

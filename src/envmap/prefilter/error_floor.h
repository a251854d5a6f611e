/// @file
/// The floor of relative errors: the error of a texel is relative to the texel, or to 0.001 x the mean radiance of the
/// source if that is larger. All methods, bounds and tests take it from here.
#pragma once

#include "envmap/maths/vector.h"

namespace envmap::prefiltering {

/// The error of a texel below this part of the mean radiance is relative to this part.
inline constexpr double floor_of_mean = 1e-3;

/// The flux of a channel, over the mean radiance of three channels, at most.
inline constexpr double most_flux = 12 * pi;

/// The floor, over the flux of one light: a lobe below it counts less than the floor.
inline constexpr double floor_density = floor_of_mean / most_flux;

}  // namespace envmap::prefiltering

/// @file
/// What errors of dark texels are counted from.
#pragma once

#include "envmap/maths/vector.h"

namespace envmap::prefiltering {

/// Texels below this part of the mean radiance are held to it.
inline constexpr double floor_of_mean = 1e-3;

/// The flux of a channel is at most so many times the mean of three channels.
inline constexpr double most_flux = 12 * pi;

/// The floor, over the flux of one light.
inline constexpr double floor_density = floor_of_mean / most_flux;

}  // namespace envmap::prefiltering

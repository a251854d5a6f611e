/// @file
/// An environment as a few distant lights, so that things keep it from each other.
#pragma once

#include <vector>

#include "envmap/base/export.h"
#include "envmap/map/environment_map.h"
#include "envmap/maths/vector.h"

namespace ENVMAP_EXPORT envmap {

struct DistantLight {
  Direction from{0, 1, 0};  ///< Unit, world.
  Colour irradiance{0};     ///< Across it.
};

inline constexpr int max_distant_lights = 256;

/// At most so many, which share out the flux of the environment: parts of the sphere are cut in two
/// halves of the same luminance, the brightest first, across the longer side. A sun gets many of them, or one where a
/// texel of 1.4 degrees holds it. Source: Debevec 2005, "A median cut algorithm for light probe sampling".
std::vector<DistantLight> distant_lights(const EnvironmentMap& environment, int count);

}  // namespace envmap

/// @file
/// An environment as a few distant lights, so that things keep it from each other.
#pragma once

#include <vector>

#include "envmap/maths/vector.h"

namespace envmap {

struct Environment;

struct DistantLight {
  Direction from{0, 1, 0};  ///< Unit, world.
  Colour irradiance{0};     ///< Across it.
};

inline constexpr int most_distant_lights = 256;

/// At most so many, which share out the flux of the environment with even ambient light: parts of the sphere are cut in two
/// halves of the same luminance, the brightest first, across the longer side. A sun gets many of them, or one where a
/// texel of 1.4 degrees holds it. Source: Debevec 2005, "A median cut algorithm for light probe sampling".
/// @param environment null: black.
std::vector<DistantLight> distant_lights(const Environment* environment, const Colour& ambient, int count);

}  // namespace envmap

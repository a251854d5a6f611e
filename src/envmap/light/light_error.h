/// @file
/// How far lights without a size are from the discs, glows and texels that they stand for.
#pragma once

#include "envmap/base/export.h"
#include "envmap/light/lights.h"
#include "envmap/map/environment_map.h"

namespace ENVMAP_EXPORT envmap {

/// Upper bounds of what changes, in the worst direction of all, where lights without a size and the remainder stand for
/// the map: over the largest value that the map has in any direction, of the worst channel.
struct LightError {
  double irradiance = 0;  ///< Of unshadowed planes.
  double ggx = 0;         ///< Of prefiltered reflection (Lobe::ggx).
};

/// No kernel changes by more than its steepest slope times the distance that light is moved: a theorem, which holds for
/// every direction. @param roughness perceptual, above 0.
LightError light_error(const EnvironmentMap& map, const FoundLights& found, double roughness = 0.5);

}  // namespace envmap

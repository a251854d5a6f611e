/// @file
/// The light of a scene's own in the unit of a map's radiance.
#pragma once

#include "envmap/scenes/scene/scene_graph.h"

namespace envmap {

/// Divides lights and what glows by the luminance of radiance 1. In glTF directional lights are in lux, others in
/// candela (KHR_lights_punctual), and emission in cd/m^2 where a physical unit is needed
/// (KHR_materials_emissive_strength).
/// @param white_luminance in cd/m^2, above 0.
void divide_own_light(SceneGraph& scene, double white_luminance);

}  // namespace envmap

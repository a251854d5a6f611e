/// @file
/// Which prefiltered levels of an environment a scene's rough surfaces need. Between two levels the light is mixed,
/// which shows a small light in the middle of .2 and .4 at 1.5 times its brightness: so each roughness that a material
/// has throughout gets a level of its own.
#pragma once

#include <vector>

#include "envmap/scenes/scene/scene_graph.h"

namespace envmap {

inline constexpr int max_glossy_levels = 24, glossy_size = 64;

/// Where no scene is known.
inline std::vector<float> even_roughnesses() { return {0.2F, 0.4F, 0.6F, 0.8F, 1}; }

/// Of base and coat where they are not smooth (is_smooth()), rising, above 0. Where textures tell a roughness, or a
/// scene has more than fit, also a row of steps of 1.3. Never empty.
/// @param node with all below it; -1: of all materials.
std::vector<float> glossy_roughnesses(const SceneGraph& scene, int node = -1);

/// How often the height of a level's cube is doubled, 0 to 2, so that the cube of glossy_size has two texels across
/// the lobe. That falls to half 1.29 r^2 radians from its middle: GGX seen from above, half vectors turned into
/// directions.
int glossy_doublings(float roughness);

}  // namespace envmap

/// @file
/// Looking up textures on surfaces.
#pragma once

#include "envmap/scenes/scene/scene_graph.h"

namespace envmap {

/// Bilinear between the four texels round a place, colours made linear first (glTF 2.0, 3.8.4). Level 0 always.
glm::vec4 texture_at(const Texture& texture, const glm::vec2& coordinates);

}  // namespace envmap

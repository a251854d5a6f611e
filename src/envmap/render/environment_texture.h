/// @file
/// An environment map as a texture, for lookups by direction (shaders/environment.glsl).
#pragma once

#include "envmap/map/environment_map.h"
#include "envmap/render/gl.h"

namespace envmap {

struct EnvironmentTexture {
  gl::Texture texture;  ///< A layer a face, each with its gutter.
  Projection projection = Projection::cube;
  Rotation to_map{1};  ///< From the world.
};

/// Level 0, as it is; a sphere map, which plain filtering does not do justice at its rim, as a cube of its density.
EnvironmentTexture upload(const EnvironmentMap& map);

}  // namespace envmap

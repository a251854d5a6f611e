/// @file
/// An environment map as a texture, for lookups by direction (shaders/environment.glsl).
#pragma once

#include <array>

#include "envmap/map/environment_map.h"
#include "envmap/render/gl.h"
#include "envmap/render/shading.h"

namespace envmap {

struct EnvironmentTexture {
  gl::Texture texture;  ///< A layer a face, each with its apron.
  Projection projection = Projection::cube;
  Rotation to_map{1};  ///< From the world.
};

/// What an environment gives surfaces (shading.h), as shading.glsl reads it.
struct LightTexture {
  gl::Texture glossy;     ///< A cube array, faces turned as GL has them.
  gl::Texture split_sum;  ///< There for any scene.
  std::array<Colour, 9> irradiance{};
};
/// @param light null: only the table.
LightTexture upload(const EnvironmentLight* light);

/// Level 0, as it is; a sphere map, which plain filtering does not do justice at its rim, as a cube of its density.
EnvironmentTexture upload(const EnvironmentMap& map);

}  // namespace envmap

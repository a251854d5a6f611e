/// @file
/// An environment map as a texture, for lookups by direction (shaders/environment.glsl).
#pragma once

#include <array>

#include "envmap/map/environment_map.h"
#include "envmap/scenes/render/gl.h"
#include "envmap/scenes/render/shading/shading.h"

namespace envmap {

struct EnvironmentTexture {
  gl::Texture texture;  ///< A layer a face, each with its apron.
  Projection projection = Projection::cube;
  Rotation to_map{1};  ///< From the world.
  double texel = 1;    ///< Radians from one to the next.
};

/// What an environment gives surfaces (shading.h), as shading.glsl reads it.
struct LightTexture {
  gl::Texture glossy;                    ///< A cube array, faces turned as GL has them.
  std::vector<float> roughnesses, mips;  ///< Of its layers: each is in the mip level of its size.
  std::array<Colour, 9> irradiance{};
  gl::Texture sampled = {};  ///< A cube with all levels, faces turned as GL has them; 0 where the light has none.
};
LightTexture upload(const EnvironmentLight& light);

/// split_sum_table(), sheen_table().
gl::Texture upload_split_sum();
gl::Texture upload_sheen_table();

/// Level 0, as it is. As a cube of its density: a sphere map, which plain filtering does not do justice at its rim, and
/// maps that no shader can look up.
EnvironmentTexture upload(const EnvironmentMap& map);

}  // namespace envmap

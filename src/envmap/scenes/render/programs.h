/// @file
/// The programs of the shaders, put together for what they draw. All that shaders and C++ must agree about, units and
/// enumerators, is defined for them from here.
#pragma once

#include <map>
#include <optional>
#include <tuple>

#include "envmap/projection/projection.h"
#include "envmap/scenes/render/draw.h"
#include "envmap/scenes/render/drawing_method.h"
#include "envmap/scenes/render/gl.h"

namespace envmap {

/// Units that textures are bound to, and buffers to their own.
enum Unit : GLuint {
  unit_rays,
  unit_base_colour,
  unit_metallic_roughness,
  unit_emissive,
  unit_normal,
  unit_occlusion,
  unit_coat,
  unit_coat_roughness,
  unit_coat_normal,
  unit_sheen,
  unit_sheen_roughness,
  unit_environment,
  unit_surfaces,
  unit_glossy,
  unit_split_sum,
  unit_sheen_table,
  unit_corners,
  unit_tangents,
  unit_instances,
  unit_materials,
  unit_mirror,
  unit_shadows,
  unit_distant_shadows,
  unit_behind,
  unit_sampled,
  buffer_lights = 4,
  buffer_shadow_views,
  buffer_missing,
  block_distant_faces = 0,
  block_distant_lights
};

/// Texels of four floats that a corner takes in its buffer.
inline constexpr unsigned corner_texels = 3;
/// The same of a material.
inline constexpr unsigned material_texels = 7;

/// What finds the surface of each texel. @param method exact, distort or tessellate, as far as can_draw(). @param holes
/// whether the material has an alpha_cutoff. @param layered whether the layer behind is left out (visible.glsl).
gl::Program visibility_program(DrawMethod method, Projection image, bool holes, bool layered);

/// What lights see (shadow_maps.h).
gl::Program shadow_program(bool holes);

/// The environment behind all surfaces. @param environment projection of its texture, has_shader().
gl::Program background_program(Projection environment);

/// Adds DepthPeeling::sample to a map.
gl::Program adding_program();

/// Makes a level of a mirror's map. @param map cube, sphere or paraboloid.
gl::Program level_program(Projection map);

/// What lights the texels of a group.
struct Shading {
  Projection environment;
  int textures = 0;  ///< A bit each: Group::textures.
  bool coated = false, sheen = false;
  bool sampled = false;  ///< Reflection::sampled.
  /// Of the map that is reflected: cube, sphere or paraboloid; none: the environment.
  std::optional<Projection> mirror;
  MirrorLookup lookup = MirrorLookup::direction;
  bool by_picture = false;  ///< Of FrameState::reflections, and no map.
  auto operator<=>(const Shading&) const = default;
};
gl::Program shading_program(const Shading& shading);

/// The programs that drawing has asked for, each made once. They belong to one context, and go before it.
class ProgramCache {
 public:
  const gl::Program& visibility(DrawMethod method, Projection image, bool holes, bool layered);
  const gl::Program& shadow(bool holes);
  const gl::Program& background(Projection environment);
  const gl::Program& adding();
  const gl::Program& level(Projection map);
  const gl::Program& shading(const Shading& shading);

 private:
  std::map<std::tuple<DrawMethod, Projection, bool, bool>, gl::Program> visibility_;
  std::map<bool, gl::Program> shadow_;
  std::map<Projection, gl::Program> background_, levels_;
  std::map<Shading, gl::Program> shading_;
  gl::Program adding_;
};

/// Whether shaders can look up maps of this projection: shaders/projection/NAME.glsl is there.
bool has_shader(Projection p);

}  // namespace envmap

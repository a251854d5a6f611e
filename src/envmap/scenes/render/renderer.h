/// @file
/// Maps of a scene, drawn with OpenGL: a pass that finds what each texel sees, by one of the methods,
/// and one that lights it.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <tuple>
#include <vector>

#include "envmap/scenes/render/draw.h"
#include "envmap/scenes/render/drawing_method.h"
#include "envmap/scenes/render/environment_texture.h"
#include "envmap/scenes/render/gpu_scene.h"
#include "envmap/scenes/render/programs.h"
#include "envmap/scenes/render/shadow_maps.h"
#include "envmap/scenes/render/visibility_buffer.h"

namespace envmap {

/// The 1 / distance of blended surfaces before the environment, in maps of mirrors. The environment itself has 0.
inline constexpr float least_nearness = 1e-30F;

/// A drawn map that stays where it was drawn, a layer a face: what mirrors look up.
struct MapTexture {
  /// @param levels of detail, each half as wide as the one before; of make_levels().
  MapTexture(Projection projection, int size, int levels = 1);
  /// A picture. @param size its height.
  MapTexture(int width, int size);

  /// Of a face. A cube is GL's own with Z mirrored, which seen from inside has right and left where we have them: -Z
  /// and +Z change places.
  [[nodiscard]] int layer(int face) const { return projection == Projection::cube && face >= 4 ? 9 - face : face; }

  Projection projection;
  int width, size, levels = 1;
  gl::Texture texture;  ///< Radiance, and 1 / distance, which is linear along planes: 0 where nothing was hit.
};

/// What a mirror shows of its surroundings.
struct MirrorMap {
  std::optional<MapTexture> texture;   ///< None before it is drawn: the mirror shows the environment.
  Direction at{0};                     ///< Where it was drawn from.
  Rotation axes{1};                    ///< From the map's frame to the world's.
  std::optional<LightTexture> glossy;  ///< Of rough mirrors, from the texture.
  /// What a flat mirror lies in, its front before it; only where pictures are to be drawn so.
  std::optional<Plane> flat;
  bool double_sided = false;  ///< It mirrors behind it, too.
  bool metal = false;         ///< It shows nothing but what it reflects.
  Direction centre{0};        ///< Of the flat mirror, and how far it reaches from there.
  double radius = 0;
};

/// Needs a current context, and goes before it.
class Renderer {
 public:
  /// @param environment of all that is drawn (shading.h); null: black. @param mirrors nodes, of which
  /// FrameState::mirrors are the maps. @param programs that renderers of the same context share; null: its own.
  /// @throws UsageError where GL cannot hold a part of the scene.
  Renderer(const SceneGraph& scene, const Environment* environment, std::vector<int> mirrors = {},
           std::shared_ptr<ProgramCache> programs = nullptr);

  /// Draws the faces of `from.which` and leaves the others alone.
  /// @param method of those that draw: exact, distort or tessellate. @param surfaces of Drawn, if that is asked for.
  /// @throws UsageError where can_draw() says no, and where the face is too large.
  /// @return Drawn::missing_solid_angle.
  double draw(const Viewpoint& from, const FrameState& shot, DrawMethod method, MapTexture& to,
              std::vector<std::uint32_t>* surfaces = nullptr);

  /// The environment alone in the faces of `from.which`.
  void draw_background(const Viewpoint& from, const FrameState& shot, MapTexture& to);

  /// From the level that was drawn, in the faces of `which`. @param map cube, sphere or paraboloid.
  /// @param surfaces alone, without the environment, and how much they cover in place of the distance: what lookup by
  /// distance wants.
  void make_levels(const MapTexture& map, unsigned which, bool surfaces = false);

  /// Takes over a mesh of the scene whose vertices are others now, as many and joined as before. Maps of mirrors stay
  /// as they are until they are drawn again: MirrorOptions::all.
  void update(const SceneGraph& scene, int mesh);

  [[nodiscard]] const std::vector<int>& mirrors() const { return mirrors_; }  ///< Nodes.

 private:
  const gl::Program& shading(const Group& group, const FrameState& shot);
  const gl::Texture& rays(const Viewpoint& from, int face, int sample);
  void begin_finding(GLuint into, bool blended) const;
  // What one search for surfaces is about.
  struct Pass {
    int face, sample;
    GLuint into;
    bool blended;  // Of opaque surfaces the nearest are found, of blended ones the furthest.
    bool counts;   // What is left out is added up.
  };
  void find_surfaces(const Viewpoint& from, const FrameState& shot, DrawMethod method, const Pass& pass);
  const LightTexture& light_of(const Group& group, const FrameState& shot) const;
  void set_light(const gl::Program& program, const Group& group, const Viewpoint& from, const FrameState& shot) const;
  void bind_map(const MapTexture& to, int face, int sample) const;
  void bind_sample() const;
  void begin_shading() const;
  void shade_background(const Viewpoint& from, const FrameState& shot);
  void shade_group(const Viewpoint& from, const FrameState& shot, std::size_t group, bool blended);
  void blend(const Viewpoint& from, const FrameState& shot, DrawMethod method, int face, int sample);
  void add_sample(const MapTexture& to, int face, int sample, int samples);
  void light(const gl::Program& program, const Viewpoint& from, int stencil) const;
  void draw_shadows(const FrameState& shot);
  void bind_shadows(const FrameState& shot, const Direction& eye) const;
  void prepare_canvas(const Viewpoint& from);

  std::shared_ptr<ProgramCache> programs_;
  std::vector<int> mirrors_;
  GpuScene gpu_;
  ShadowMaps shadows_, distant_shadows_;  // Of punctual lights and suns, and of FrameState::distant.
  gl::Buffer distant_lights_;
  EnvironmentTexture environment_;
  LightTexture light_;
  gl::Texture split_sum_, sheen_table_;  // The last of scenes that have any.
  std::optional<VisibilityBuffer> canvas_;
  std::optional<DepthPeeling> layers_;                            // Where something is blended.
  std::map<std::tuple<Projection, int, int>, gl::Texture> rays_;  // Of texels' centres, by projection, size and face.
  gl::Texture sample_rays_;
  float sample_below_ = 0;  // How far the last rays() lie below the centres of texels, in texels.
};

/// The map in memory, by any method but raycast: `resample` draws a cube of the same size and converts it.
Drawn draw(Renderer& renderer, const Viewpoint& from, const FrameState& shot, DrawMethod method);

/// Whether a sphere in the world may be in the picture.
bool is_in_picture(const Viewpoint& from, const Direction& centre, double radius);

/// The picture through from.lens, rows from the top. Flat mirrors (MirrorMap::flat) show what the mirrored eye sees,
/// and flat mirrors in those: as deep as MirrorLook::pictures where there are two of them, once or twice where there
/// are more. Beyond that, and in all others, they look their maps up. Source: Diefenbach 1996, "Pipeline rendering:
/// interaction and realism through hardware-based multi-pass rendering".
std::vector<Colour> draw_picture(Renderer& renderer, const Viewpoint& from, const FrameState& shot);

/// What is in the texture, with distances if asked for.
EnvironmentMap read_back(const MapTexture& map, std::vector<float>* distances = nullptr);

}  // namespace envmap

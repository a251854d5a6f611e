/// @file
/// Maps of a scene, drawn with OpenGL: a pass that finds what each texel sees, by one of the methods, and one that lights it.
#pragma once

#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "envmap/render/canvas.h"
#include "envmap/render/draw.h"
#include "envmap/render/environment_texture.h"
#include "envmap/render/gpu_scene.h"
#include "envmap/render/method.h"

namespace envmap {

/// A drawn map that stays where it was drawn, a layer a face: what mirrors look up.
struct MapTexture {
  MapTexture(Projection projection, int size);
  /// A picture. @param size its height.
  MapTexture(int width, int size);

  /// Of a face. A cube is GL's own with Z mirrored, which seen from inside has right and left where we have them: -Z and
  /// +Z change places.
  [[nodiscard]] int layer(int face) const { return projection == Projection::cube && face >= 4 ? 9 - face : face; }

  Projection projection;
  int width, size;
  gl::Texture texture;  ///< Radiance, and the distance: infinite where nothing was hit.
};

/// What a mirror shows of its surroundings.
struct MirrorMap {
  std::optional<MapTexture> texture;   ///< None before it is drawn: the mirror shows the environment.
  Rotation axes{1};                    ///< From the map's frame to the world's.
  std::optional<LightTexture> glossy;  ///< Of rough mirrors, from the texture.
};

/// Needs a current context, and goes before it.
class Renderer {
 public:
  /// @param environment background of all maps; null: black. @param light what it gives surfaces (shading.h), or null.
  /// @throws UsageError where GL cannot hold a part of the scene.
  /// @param mirrors nodes, of which Shot::mirrors are the maps.
  Renderer(const Scene& scene, const EnvironmentMap* environment, const EnvironmentLight* light = nullptr,
           std::vector<int> mirrors = {});

  /// Draws the faces of `from.which` and leaves the others alone.
  /// @param method of those that draw: exact, distort or tessellate. @param surfaces of Drawn, if that is asked for.
  /// @throws UsageError: distort and tessellate know no latlong maps; the face is too large.
  void draw(const Viewpoint& from, const Shot& shot, DrawMethod method, MapTexture& to,
            std::vector<std::uint32_t>* surfaces = nullptr);

  [[nodiscard]] const GpuScene& scene() const { return gpu_; }

 private:
  const gl::Program& visibility_program(DrawMethod method, Projection p, bool holes);
  [[nodiscard]] gl::Program lighting_program(std::string_view last, const std::string& defines) const;
  const gl::Program& shade_program(const Group& group, const Shot& shot);
  const gl::Texture& rays(const Viewpoint& from, int face, int sample);
  void find_surfaces(const Viewpoint& from, const Shot& shot, DrawMethod method, int face, int sample);
  void bind_mirror(const gl::Program& program, const MirrorMap& mirror, const MirrorLook& look) const;
  void shade(const Viewpoint& from, const Shot& shot, MapTexture& to, int face, int sample);

  std::vector<int> mirrors_;
  GpuScene gpu_;
  std::optional<EnvironmentTexture> environment_;
  LightTexture light_;
  bool lit_by_environment_;
  std::optional<Canvas> canvas_;
  std::map<std::tuple<DrawMethod, Projection, bool>, gl::Program> programs_;
  std::map<std::tuple<Projection, int, int>, gl::Texture> rays_;  // Of texels' centres, by projection, size and face.
  gl::Texture sample_rays_;
  std::map<std::string, gl::Program> shade_;  // By what is defined.
  gl::Program background_;
};

/// The map in memory, by any method but raycast: `resample` draws a cube of the same size and converts it.
Drawn draw(Renderer& renderer, const Viewpoint& from, const Shot& shot, DrawMethod method);

/// The picture through from.lens, rows from the top.
std::vector<Colour> draw_picture(Renderer& renderer, const Viewpoint& from, const Shot& shot);

/// What is in the texture, with distances if asked for.
EnvironmentMap read_back(const MapTexture& map, std::vector<float>* distances = nullptr);

}  // namespace envmap

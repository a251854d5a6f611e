/// @file
/// A scene where the graphics card can read it. What does not move is uploaded once; a frame sends matrices and lights,
/// and meshes that change their shape.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "envmap/scenes/render/draw.h"
#include "envmap/scenes/render/gl.h"
#include "envmap/scenes/render/shading/shading.h"
#include "envmap/scenes/scene/camera.h"

namespace envmap {

/// An instance as it is drawn.
struct Part {
  int node, mesh;
  GLsizei indices;
  std::size_t first_index;  ///< A third of it is the number of its first triangle.
  Vec3<double> centre;      ///< Of a sphere round the mesh, in the frame of its node.
  double radius;
  std::uint8_t stencil;  ///< What it leaves in the stencil: 1 + its group.
  int material, group;   ///< Group of the material.
  bool holes;            ///< The material has an alpha_cutoff.
  bool blended;          ///< Material::blended.
  bool double_sided;
  bool casts_shadow;  ///< By its material.
};

/// Materials with the same textures on the same mirror, which are shaded together.
struct Group {
  /// Base colour, metallic and roughness, emissive, normal, occlusion, coat, its roughness, its normal, sheen, its
  /// roughness: indices into SceneGraph::textures or -1. In this order they are bound, and are bits of
  /// Shading::textures.
  std::array<int, 10> textures;
  int mirror;  ///< Index of the mirror it is part of, or -1.
  bool blended, coated, sheen;
  bool operator==(const Group&) const = default;

  [[nodiscard]] bool is_painted() const { return textures[0] >= 0; }
};

/// How a part lies seen from a viewpoint.
struct InstanceTransform {
  glm::mat4 to_map;  ///< From the mesh to the frame of the map, the viewpoint at the origin.
  bool mirrored;     ///< Right becomes left on the way to the world.
  Ball ball;         ///< What surely holds it, in the frame of the map.
};

/// Needs a current context, and goes before it.
class GpuScene {
 public:
  /// @param mirrors nodes that have a map each, with all below them. @param suns sun_lights() of the environment.
  /// @throws UsageError where a texture is larger than GL takes.
  explicit GpuScene(const SceneGraph& scene, std::span<const int> mirrors = {}, std::vector<PlacedLight> suns = {});

  [[nodiscard]] const std::vector<Part>& parts() const { return parts_; }
  [[nodiscard]] const std::vector<Group>& groups() const { return groups_; }
  [[nodiscard]] bool blends() const { return std::ranges::any_of(groups_, &Group::blended); }
  [[nodiscard]] int lights() const { return lights_; }  ///< Of the scene itself.
  [[nodiscard]] int suns() const { return int(suns_.size()); }
  /// Of the scene, and behind them those of the suns: as shaders number them.
  [[nodiscard]] std::vector<PlacedLight> lights_at(const SceneGraph& scene, const Pose& pose) const;

  /// Uploads a mesh's vertex attributes again. Vertex count and triangles must not have changed.
  void update(const SceneGraph& scene, int mesh);

  /// Where everything is, seen from `at` in a frame of `axes`: one element a part.
  void place(const SceneGraph& scene, const Pose& pose, const Direction& at, const Rotation& axes);
  [[nodiscard]] const std::vector<InstanceTransform>& placed() const { return placed_; }

  /// Binds vertices and buffers for drawing and shading, and the textures of a group.
  void bind() const;
  void bind(const Group& group) const;
  /// Draws one part; as patches whose vertices are not fetched for them: gl_VertexID / 3 is the triangle's number.
  void draw(const Part& part) const;
  void draw_patches(const Part& part) const;

 private:
  // Where a mesh begins in the buffers.
  struct First {
    std::size_t vertex, index;
  };

  std::vector<Part> parts_;
  std::vector<First> first_;  // By mesh.
  std::vector<InstanceTransform> placed_;
  std::vector<Group> groups_;
  int lights_ = 0;
  std::vector<PlacedLight> suns_;
  gl::Buffer vertices_, indices_, corners_, tangents_, materials_, instances_, light_buffer_;
  gl::Texture corner_texels_, tangent_texels_, material_texels_, instance_texels_;
  gl::VertexArray layout_;
  std::vector<gl::Texture> textures_;
};

}  // namespace envmap

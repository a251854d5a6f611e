/// @file
/// A glTF document on its way into a scene: what its parts share.
#pragma once

#include <cmath>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "envmap/io/gltf_document.h"
#include "envmap/scene/mesh.h"
#include "envmap/scene/scene.h"

namespace envmap {

/// Of light and emission, before its strength. The specification has 1, but not every exporter keeps to it.
inline constexpr double most_light = 1e6;

/// KHR_texture_transform: coordinates are scaled, turned counter-clockwise as seen on the image, and moved.
struct TextureTransform {
  glm::dvec2 offset{0}, scale{1};
  double rotation = 0;

  bool operator==(const TextureTransform&) const = default;
  [[nodiscard]] glm::vec2 operator()(const glm::vec2& at) const {
    const double c = std::cos(rotation), s = std::sin(rotation), u = scale.x * at.x, v = scale.y * at.y;
    return {offset.x + c * u + s * v, offset.y - s * u + c * v};
  }
};

struct GltfReader {
  const GltfDocument& document;
  std::uint64_t pixels_left;  ///< Of textures.
  bool allow_missing = false;  ///< As read_scene() has it.
  Scene scene = {};
  std::vector<std::vector<int>> meshes = {};                  ///< Of scene.meshes, for each mesh of the document.
  std::map<int, Deformation> shapes = {};                     ///< Of scene.meshes that move.
  std::vector<TextureTransform> transforms = {};              ///< Of each material's textures.
  std::vector<int> nodes = {};                                ///< In scene.nodes, for each node; -1: not in the scene.
  std::map<std::pair<std::size_t, bool>, int> textures = {};  ///< By index and whether they are colours.
  int plain_material = -1;                                    ///< Of primitives that name none.

  void note_unsupported(const std::string& what) { note_once(scene.unsupported, what); }
};

/// Into scene.materials, with its textures.
void read_material(GltfReader& r, const Field& field);

/// Where in scene.materials a primitive's is. @param index of the document, may be absent.
int material_of(GltfReader& r, const Field& index);

/// Into scene.meshes, one a primitive.
void read_mesh(GltfReader& r, const Field& field);

/// @throws InputError where the meshes have too many corners: files can name the same bytes again and again, so their
/// size says nothing of what they make.
void check_corners(const GltfDocument& document);

// ---- gltf_animations.cpp: where nodes are and how they move ---------------------------------------------------------

/// What a node's matrix is made of; a node that moves has no other.
struct NodeTransform {
  Direction translation{0}, scale{1};
  Quaternion rotation{1, 0, 0, 0};
};
NodeTransform node_transform(const Field& node);

/// All animations into scene.motions. @param placed where in scene.nodes each node of the document is; -1:
/// not in the scene.
void read_motions(const GltfDocument& document, std::span<const int> placed, Scene& scene);

// ---- gltf_shapes.cpp: morph targets and skins -----------------------------------------------------------------------

/// What moves the vertices of a primitive, as the file numbers them; `rest` is not there yet.
/// @param vertices as many as it has.
Deformation read_shape(const GltfDocument& document, const Field& primitive, std::size_t vertices, Scene& scene);

/// The same for a mesh made ready to be drawn, which may have repeated vertices.
/// @param before its corners as they were.
void finish_shape(Deformation& shape, const std::vector<std::uint32_t>& before, const Mesh& mesh);

/// Into scene.deformations, for each node whose mesh moves; a mesh of several nodes is repeated for them.
/// @param placed where in scene.nodes each node of the document is; -1: not in the scene.
/// @param shapes by mesh of the scene.
void read_deformations(const GltfDocument& document, std::span<const int> placed,
                       const std::map<int, Deformation>& shapes, Scene& scene);

}  // namespace envmap

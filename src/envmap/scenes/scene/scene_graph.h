/// @file
/// A scene as it is drawn: triangles, materials, lights and cameras on a tree of nodes that may move.
/// Words and frame are glTF 2.0's: right-handed, +Y up, metres, counter-clockwise front faces, linear colours.
#pragma once

#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <string>
#include <valarray>
#include <vector>

#include "envmap/maths/vector.h"

namespace envmap {

using Matrix = glm::mat<4, 4, double, glm::highp>;
using Quaternion = glm::qua<double, glm::highp>;

/// An image on a surface; texel 0 is the upper left corner, as texture coordinates (0,0) are in glTF.
struct Texture {
  enum class Wrap { repeat, mirror, clamp };
  int width = 0, height = 0;
  std::vector<glm::u8vec4> texels;  ///< Rows from the top.
  bool srgb = true;                 ///< Colours are; roughness and metalness are plain numbers.
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
};

/// glTF's metallic-roughness material. A texture is an index into SceneGraph::textures, -1 where there is none.
struct Material {
  std::string name;
  glm::vec4 base_colour{1};
  int base_colour_texture = -1;
  float metallic = 0, roughness = 1;
  int metallic_roughness_texture = -1;  ///< Green roughness, blue metalness.
  Colour emissive{0};                   ///< KHR_materials_emissive_strength is multiplied in.
  int emissive_texture = -1;
  int normal_texture = -1;     ///< Unit vectors by (texel + 1) / 2: along the mesh's tangent, across it, and outwards.
  float normal_scale = 1;      ///< Of the first two.
  int occlusion_texture = -1;  ///< Red: how much of the light from all round reaches the surface.
  float occlusion_strength = 1;        ///< How far that counts.
  float transmission = 0, ior = 1.5F;  ///< KHR_materials_transmission, KHR_materials_ior.
  /// KHR_materials_clearcoat: how much of a layer of index 1.5 lies over all else.
  float coat = 0, coat_roughness = 0;
  int coat_texture = -1, coat_roughness_texture = -1;  ///< Red; green.
  int coat_normal_texture = -1;  ///< Without one the coat is smooth, whatever the normal map below it says.
  float coat_normal_scale = 1;
  Colour sheen{0};  ///< KHR_materials_sheen: of cloth, under the coat.
  float sheen_roughness = 0;
  int sheen_texture = -1, sheen_roughness_texture = -1;  ///< A colour; alpha.
  /// Bends what it lets through: KHR_materials_volume with a thickness. Else it is a thin wall.
  bool solid = false;
  /// Of a solid, per metre: light that goes d metres falls by exp(-absorption d) (Beer-Lambert).
  Colour absorption{0};
  /// Of a solid, in the frame of the mesh: the way through it for maps, which do not follow rays.
  float thickness = 0;
  float alpha_cutoff = 0;  ///< Above 0: what is below it in alpha is a hole.
  bool blended = false;    ///< Covers what is behind as far as alpha says; then holes are those of shadows alone.
  bool double_sided = false;
};

/// Triangles of one material. All vectors but indices have one element a vertex; colours none where all are white,
/// tangents none where the material has no map of normals.
struct Mesh {
  int material = 0;
  std::vector<glm::vec3> positions, normals;
  std::vector<glm::vec2> coordinates;  ///< Of textures.
  std::vector<glm::vec4> colours;      ///< Linear; the base colour is multiplied with them.
  /// Where u rises; w: 1 where cross(normal, tangent) is up in the image, else -1.
  std::vector<glm::vec4> tangents;
  std::vector<std::uint32_t> indices;  ///< Three a triangle.
};

/// A place in the tree. Parents come before their children.
struct Node {
  std::string name;
  int parent = -1;  ///< Index into SceneGraph::nodes; -1: the root.
  Matrix local{1};  ///< Into the parent, at rest.
  std::vector<int> meshes;
};

/// KHR_lights_punctual, in the frame of its node: at the origin, shining along -Z.
struct PunctualLight {
  enum class Kind { point, spot, directional };
  Kind kind = Kind::point;
  int node = 0;
  Colour intensity{1};          ///< Candela; directional: lux.
  double range = 0;             ///< Metres; 0: no end.
  double inner = 0, outer = 0;  ///< Half angles of the cone in radians.
};

/// In the frame of its node: at the origin, looking along -Z, +Y up.
struct Camera {
  std::string name;
  int node = 0;
  double vertical_field = 0.8;  ///< Of view, whole angle in radians.
  double half_height = 0;       ///< Of what an orthographic camera sees, in metres; 0: it is a perspective one.
  double near = 0.01, far = 1000;
};

/// Key frames of one node. All three parts have keys: one where nothing moves.
struct Animation {
  template <class T>
  struct Key {
    double time;  ///< Seconds; rising.
    T value;
  };
  int node = 0;
  std::vector<Key<Direction>> translations, scales;
  std::vector<Key<Quaternion>> rotations;
};

/// Of a mesh, or what is added to them.
struct Vertices {
  std::vector<glm::vec3> positions, normals;
  std::vector<glm::vec4> tangents;
};

/// What changes the shape of a mesh, which is one node's alone (skin_and_morph.h).
struct Deformation {
  int node = 0, mesh = 0;
  Vertices rest;
  bool flat = false;              ///< Normals are those of the triangles.
  std::vector<Vertices> targets;  ///< Added as often as their weights say; no vectors: nothing.
  std::valarray<double> weights;  ///< One a target, where there are no keys.
  std::vector<Animation::Key<std::valarray<double>>> keys;
  std::vector<int> joints;               ///< Nodes; none: no skin.
  std::vector<Matrix> inverse_bind;      ///< Of each joint: from the mesh to its frame, at rest.
  std::vector<glm::u16vec4> influences;  ///< Of each vertex: four of the joints.
  std::vector<glm::vec4> parts;          ///< What those count for, 1 in all.
};

struct SceneGraph {
  std::vector<Node> nodes;
  std::vector<Mesh> meshes;
  std::vector<Material> materials;
  std::vector<Texture> textures;
  std::vector<PunctualLight> lights;
  std::vector<Camera> cameras;
  std::vector<Animation> animations;
  std::vector<Deformation> deformations;
  std::vector<std::string> unsupported;  ///< What the file uses and this does not draw, each named once.
  /// Sentences on what else the file leaves open, such as a material library that is missing.
  std::vector<std::string> remarks;
  std::vector<std::string> files;  ///< Paths of all that was read: the scene, its buffers, materials and images.
};

/// World matrices of all nodes.
using Pose = std::vector<Matrix>;

/// @param time in seconds; before the first key and after the last one things stand still. Keys are joined by lines,
/// rotations by great arcs.
Pose pose(const SceneGraph& scene, double time);

/// Whether all its numbers are below 1e30, and none is NaN.
bool is_bounded(const Pose& pose);

/// The node of that name, if there is one. @throws UsageError where several have it.
std::optional<int> find_node(const SceneGraph& scene, const std::string& name);

/// The names of nodes, for messages: eight at most, and how many more there are.
std::string list_nodes(const SceneGraph& scene);

/// Whether the scene has light of its own: lights, or materials that glow.
bool has_light(const SceneGraph& scene);

/// The inverse transposed but for its scale, and also there where the matrix has no inverse: turns normals.
Rotation cofactors(const Rotation& m);

/// Whether a node is `ancestor` or lies below it.
bool lies_under(const SceneGraph& scene, int node, int ancestor);

}  // namespace envmap

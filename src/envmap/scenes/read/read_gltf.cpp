#include "envmap/scenes/read/read_gltf.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/gtc/matrix_transform.hpp>
#include <initializer_list>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/io/formats/gltf_document.h"
#include "envmap/maths/portable.h"
#include "envmap/scenes/read/draco.h"
#include "envmap/scenes/read/read_texture.h"
#include "envmap/scenes/scene/mesh.h"
#include "envmap/scenes/scene/scene_graph.h"
#include "envmap/scenes/scene/skin_and_morph.h"
#include "envmap/scenes/scene/tangents.h"

namespace envmap {

// A glTF document on its way into a scene: what its parts share.

namespace {

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
  std::uint64_t pixels_left;   ///< Of textures.
  bool allow_missing = false;  ///< As read_scene() has it.
  SceneGraph scene = {};
  std::vector<std::vector<int>> meshes = {};                  ///< Of scene.meshes, for each mesh of the document.
  std::map<int, Deformation> shapes = {};                     ///< Of scene.meshes that move.
  std::vector<TextureTransform> transforms = {};              ///< Of each material's textures.
  std::vector<int> nodes = {};                                ///< In scene.nodes, for each node; -1: not in the scene.
  std::map<std::pair<std::size_t, bool>, int> textures = {};  ///< By index and whether they are colours.
  int plain_material = -1;                                    ///< Of primitives that name none.

  void note_unsupported(const std::string& what) { note_once(scene.unsupported, what); }
};

// ---- read_gltf.cpp: where nodes are and how they move ---------------------------------------------------------

/// What a node's matrix is made of; a node that moves has no other.
struct NodeTransform {
  Direction translation{0}, scale{1};
  Quaternion rotation{1, 0, 0, 0};
};
// ---- read_gltf.cpp: morph targets and skins -----------------------------------------------------------------------

// Pieces that a cubic spline between two keys is drawn in: straight ones, off by 1/500 of its bow.
constexpr int pieces = 16;

Quaternion as(const std::vector<double>& v, std::size_t at, std::size_t, const Quaternion*) {
  return Quaternion(v[at + 3], v[at], v[at + 1], v[at + 2]);
}
Direction as(const std::vector<double>& v, std::size_t at, std::size_t, const Direction*) {
  return {v[at], v[at + 1], v[at + 2]};
}

std::valarray<double> as(const std::vector<double>& v, std::size_t at, std::size_t wide, const std::valarray<double>*) {
  return {v.data() + at, wide};
}

// @param wide numbers of a value, which are in the accessor as elements of so many components.
template <class T>
std::vector<Animation::Key<T>> read_keys(const GltfDocument& document, const Field& sampler, std::size_t wide,
                                         int components) {
  constexpr const T* kind = nullptr;
  const std::vector<double> times = accessor_numbers(document, sampler["input"], 1);
  const std::vector<double> values = accessor_numbers(document, sampler["output"], components);
  const std::string between = sampler["interpolation"].text("LINEAR");
  const bool cubic = between == "CUBICSPLINE", steps = between == "STEP";
  if (!cubic && !steps && between != "LINEAR") sampler["interpolation"].fail("is '" + between + "', no interpolation");
  if (values.size() != times.size() * wide * (cubic ? 3 : 1))
    sampler["output"].fail("does not have a value for each time");
  std::vector<Animation::Key<T>> keys;
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (k > 0 && !(times[k] > times[k - 1])) sampler["input"].fail("holds times that do not rise");
    if (k > 0 && steps) keys.push_back({times[k], keys.back().value});
    if (k > 0 && cubic) {
      // Hermite's spline (specification, appendix C.4); in tangent, value and out tangent stand together.
      const T p0 = as(values, (3 * k - 2) * wide, wide, kind), m0 = as(values, (3 * k - 1) * wide, wide, kind);
      const T p1 = as(values, (3 * k + 1) * wide, wide, kind), m1 = as(values, 3 * k * wide, wide, kind);
      const double span = times[k] - times[k - 1];
      for (int piece = 1; piece < pieces; ++piece) {
        const double t = double(piece) / pieces, t2 = t * t, t3 = t2 * t;
        keys.push_back({times[k - 1] + t * span, T(p0 * (2 * t3 - 3 * t2 + 1) + m0 * (span * (t3 - 2 * t2 + t)) +
                                                   p1 * (3 * t2 - 2 * t3) + m1 * (span * (t3 - t2)))});
      }
    }
    keys.push_back({times[k], as(values, (cubic ? 3 * k + 1 : k) * wide, wide, kind)});
  }
  return keys;
}

void read_weights(const GltfDocument& document, const Field& sampler, int node, SceneGraph& scene) {
  for (Deformation& d : scene.deformations)
    if (d.node == node && !d.targets.empty()) {
      if (!d.keys.empty()) return note_once(scene.unsupported, "several animations of one node");
      d.keys = read_keys<std::valarray<double>>(document, sampler, d.targets.size(), 1);
    }
}

NodeTransform node_transform(const Field& node) {
  const auto t = node["translation"].numbers({0, 0, 0}), q = node["rotation"].numbers({0, 0, 0, 1}),
             s = node["scale"].numbers({1, 1, 1});
  const Quaternion turn(q[3], q[0], q[1], q[2]);
  if (!(glm::length(turn) > 1e-6)) node["rotation"].fail("is no rotation");
  return {{t[0], t[1], t[2]}, {s[0], s[1], s[2]}, glm::normalize(turn)};
}

/// All animations into scene.motions. @param placed where in scene.nodes each node of the document is; -1:
/// not in the scene.
void read_motions(const GltfDocument& document, std::span<const int> placed, SceneGraph& scene) {
  const Field animations = document.root()["animations"], nodes = document.root()["nodes"];
  std::map<int, Animation> moving;  // By node of the scene.
  for (std::size_t a = 0; a < animations.size(); ++a) {
    const Field channels = animations[a]["channels"], samplers = animations[a]["samplers"];
    for (std::size_t c = 0; c < channels.size(); ++c) {
      const Field target = channels[c]["target"];
      if (!target["node"].there()) continue;
      const std::size_t at = target["node"].index(nodes.size());
      const Field sampler = samplers[channels[c]["sampler"].index(samplers.size())];
      const std::string path = target["path"].text();
      if (placed[at] < 0) continue;
      if (path == "weights") {
        read_weights(document, sampler, placed[at], scene);
        continue;
      }
      if (nodes[at]["matrix"].there()) target.fail("moves a node that has a matrix");
      Animation& motion = moving[placed[at]];
      const auto fill = [&](auto& keys) {
        using T = decltype(keys.front().value);
        if (!keys.empty()) return note_once(scene.unsupported, "several animations of one node");
        keys = read_keys<std::remove_reference_t<T>>(document, sampler, T::length(), T::length());
      };
      if (path == "translation")
        fill(motion.translations);
      else if (path == "rotation")
        fill(motion.rotations);
      else if (path == "scale")
        fill(motion.scales);
      else
        target["path"].fail("is '" + path + "', nothing that moves");
    }
  }
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const auto found = moving.find(placed[k]);
    if (placed[k] < 0 || found == moving.end()) continue;
    // What has no keys stays as the file says, whatever a matrix could be taken apart to.
    const NodeTransform rest = node_transform(nodes[k]);
    Animation& motion = found->second;
    motion.node = placed[k];
    if (motion.translations.empty()) motion.translations = {{0, rest.translation}};
    if (motion.rotations.empty()) motion.rotations = {{0, rest.rotation}};
    if (motion.scales.empty()) motion.scales = {{0, rest.scale}};
    scene.animations.push_back(std::move(motion));
  }
}

Texture::Wrap wrap_of(const Field& mode) {
  switch (mode.index(65536, 10497)) {
    case 10497: return Texture::Wrap::repeat;
    case 33648: return Texture::Wrap::mirror;
    case 33071: return Texture::Wrap::clamp;
    default: mode.fail("is no way to wrap");
  }
}

Texture open_texture(GltfReader& r, const Field& field) {
  const GltfDocument& document = r.document;
  const Field image = document.refer(field["source"], "images"), view = image["bufferView"];
  Resource read;
  if (!view.there()) read = bytes_at(document, image["uri"]);
  if (!read.file.empty()) r.scene.files.push_back(read.file);
  const std::span<const std::byte> bytes =
      view.there() ? view_bytes(document, view) : std::span<const std::byte>(read.bytes);
  const auto* first = reinterpret_cast<const char*>(bytes.data());
  const std::string text = image["uri"].text();
  const std::string name = text.empty() || text.starts_with("data:") ? "an image in the file" : text;
  return decode_texture(name, {first, first + bytes.size()}, r.pixels_left);
}

// @param info a textureInfo, may be absent. @return index into scene.textures or -1.
int texture(GltfReader& r, const Field& info, bool colour) {
  if (!info.there()) return -1;
  const Field field = r.document.refer(info["index"], "textures");
  if (info["texCoord"].index(64, 0) > 0) r.note_unsupported("a second set of texture coordinates");
  if (!field["source"].there()) {
    r.note_unsupported("images in other formats than PNG and JPEG");
    return -1;
  }
  const std::pair key(info["index"].index(1u << 31), colour);
  if (const auto found = r.textures.find(key); found != r.textures.end()) return found->second;
  Texture t;
  try {
    t = open_texture(r, field);
  } catch (const MissingFile& e) {
    if (!r.allow_missing) throw;
    note_once(r.scene.remarks, std::string(e.what()) + "; its surfaces have no texture");
    return r.textures[key] = -1;
  }
  t.srgb = colour;
  if (field["sampler"].there()) {
    const Field sampler = r.document.refer(field["sampler"], "samplers");
    t.wrap_u = wrap_of(sampler["wrapS"]);
    t.wrap_v = wrap_of(sampler["wrapT"]);
    if (sampler["magFilter"].index(65536, 9729) == 9728) r.note_unsupported("textures without interpolation");
  }
  r.scene.textures.push_back(std::move(t));
  return r.textures[key] = int(r.scene.textures.size()) - 1;
}

TextureTransform transform_of(GltfReader& r, const Field& info) {
  const Field extension = info["extensions"]["KHR_texture_transform"];
  if (extension["texCoord"].index(64, 0) > 0) r.note_unsupported("a second set of texture coordinates");
  const auto offset = extension["offset"].numbers({0, 0}), scale = extension["scale"].numbers({1, 1});
  return {{offset[0], offset[1]}, {scale[0], scale[1]}, extension["rotation"].number(0, -1e6, 1e6)};
}

// What all textures of a material share: coordinates are those of the mesh.
TextureTransform transform_of(GltfReader& r, std::initializer_list<Field> infos) {
  std::optional<TextureTransform> first;
  for (const Field& info : infos)
    if (info.there()) {
      const TextureTransform found = transform_of(r, info);
      if (first && *first != found) r.note_unsupported("a transform of each texture of a material");
      if (!first) first = found;
    }
  return first.value_or(TextureTransform{});
}

// KHR_materials_unlit: the base colour is what is seen. It becomes emission, and nothing is reflected.
void make_unlit(Material& m) {
  m.emissive = Colour(m.base_colour);
  m.emissive_texture = m.base_colour_texture;
  m.base_colour = {0, 0, 0, m.base_colour.w};
  m.metallic_roughness_texture = m.normal_texture = m.occlusion_texture = m.coat_normal_texture = -1;
  m.metallic = 0, m.roughness = 1, m.transmission = 0, m.ior = 1, m.coat = 0, m.sheen = Colour(0);
}

// KHR_materials_clearcoat.
void read_coat(GltfReader& r, const Field& coat, Material& m) {
  m.coat = float(coat["clearcoatFactor"].number(0, 0, 1));
  m.coat_roughness = float(coat["clearcoatRoughnessFactor"].number(0, 0, 1));
  if (m.coat == 0) return;
  m.coat_texture = texture(r, coat["clearcoatTexture"], false);
  m.coat_roughness_texture = texture(r, coat["clearcoatRoughnessTexture"], false);
  m.coat_normal_texture = texture(r, coat["clearcoatNormalTexture"], false);
  m.coat_normal_scale = float(coat["clearcoatNormalTexture"]["scale"].number(1, -1e6, 1e6));
}

// KHR_materials_sheen.
void read_sheen(GltfReader& r, const Field& sheen, Material& m) {
  const auto colour = sheen["sheenColorFactor"].numbers({0, 0, 0});
  for (int k = 0; k < 3; ++k) m.sheen[k] = float(std::clamp(colour[std::size_t(k)], 0.0, 1.0));
  m.sheen_roughness = float(sheen["sheenRoughnessFactor"].number(0, 0, 1));
  if (m.sheen == Colour(0)) return;
  m.sheen_texture = texture(r, sheen["sheenColorTexture"], true);
  m.sheen_roughness_texture = texture(r, sheen["sheenRoughnessTexture"], false);
}

// KHR_materials_volume. After `attenuationDistance` metres white light has the attenuation colour.
void read_volume(GltfReader& r, const Field& volume, Material& m) {
  m.thickness = float(volume["thicknessFactor"].number(0, 0, 1e30));
  m.solid = m.thickness > 0;
  if (!m.solid) return;
  if (volume["thicknessTexture"].there()) r.note_unsupported("textures of thickness");
  const Field distance = volume["attenuationDistance"];
  if (!distance.there()) return;
  const auto colour = volume["attenuationColor"].numbers({1, 1, 1}, 0, 1);
  for (int k = 0; k < 3; ++k)
    m.absorption[k] = float(-portable::log(std::max(colour[std::size_t(k)], 1e-30)) / distance.number(1, 1e-30, 1e30));
}

Material material_from(GltfReader& r, const Field& field) {
  const Field metallic = field["pbrMetallicRoughness"], extensions = field["extensions"];
  Material m{.name = field["name"].text()};
  const auto base = metallic["baseColorFactor"].numbers({1, 1, 1, 1}, 0, 1);
  m.base_colour = glm::vec4(base[0], base[1], base[2], base[3]);
  m.base_colour_texture = texture(r, metallic["baseColorTexture"], true);
  m.metallic = float(metallic["metallicFactor"].number(1, 0, 1));
  m.roughness = float(metallic["roughnessFactor"].number(1, 0, 1));
  m.metallic_roughness_texture = texture(r, metallic["metallicRoughnessTexture"], false);
  const auto emissive = field["emissiveFactor"].numbers({0, 0, 0}, 0, most_light);
  const double strength = extensions["KHR_materials_emissive_strength"]["emissiveStrength"].number(1, 0, 1e30);
  m.emissive = Colour(Flux(emissive[0], emissive[1], emissive[2]) * strength);
  m.emissive_texture = texture(r, field["emissiveTexture"], true);
  const Field transmission = extensions["KHR_materials_transmission"];
  m.transmission = float(transmission["transmissionFactor"].number(0, 0, 1));
  if (transmission["transmissionTexture"].there()) r.note_unsupported("textures of transmission");
  // 0 stands for infinity there, the old metal-like workflow; it reflects everything.
  m.ior = float(extensions["KHR_materials_ior"]["ior"].number(1.5, 0, 1e6));
  if (m.ior < 1) m.ior = m.ior == 0 ? 1e6F : 1;
  read_volume(r, extensions["KHR_materials_volume"], m);
  m.double_sided = field["doubleSided"].truth(false);
  const std::string mode = field["alphaMode"].text("OPAQUE");
  if (mode == "MASK") m.alpha_cutoff = float(field["alphaCutoff"].number(0.5, 0, 1e6));
  // Light passes or it does not: it takes half as the limit.
  if (mode == "BLEND") m.blended = true, m.alpha_cutoff = 0.5F;
  const Field normal = field["normalTexture"], occlusion = field["occlusionTexture"];
  m.normal_texture = texture(r, normal, false);
  m.normal_scale = float(normal["scale"].number(1, -1e6, 1e6));
  m.occlusion_texture = texture(r, occlusion, false);
  m.occlusion_strength = float(occlusion["strength"].number(1, 0, 1));
  const Field coat = extensions["KHR_materials_clearcoat"], sheen = extensions["KHR_materials_sheen"];
  read_coat(r, coat, m);
  read_sheen(r, sheen, m);
  r.transforms.push_back(
      transform_of(r, {metallic["baseColorTexture"], metallic["metallicRoughnessTexture"], field["emissiveTexture"],
                       normal, occlusion, coat["clearcoatTexture"], coat["clearcoatRoughnessTexture"],
                       coat["clearcoatNormalTexture"], sheen["sheenColorTexture"], sheen["sheenRoughnessTexture"]}));
  if (extensions["KHR_materials_unlit"].there()) make_unlit(m);
  return m;
}

/// Into scene.materials, with its textures.
void read_material(GltfReader& r, const Field& field) { r.scene.materials.push_back(material_from(r, field)); }

/// Where in scene.materials a primitive's is. @param index of the document, may be absent.
int material_of(GltfReader& r, const Field& index) {
  if (index.there()) return int(index.index(r.document.root()["materials"].size()));
  if (r.plain_material < 0) {
    r.plain_material = int(r.scene.materials.size());
    r.scene.materials.push_back({.metallic = 1, .roughness = 1});
  }
  return r.plain_material;
}

Vertices read_target(const GltfDocument& document, const Field& target, std::size_t vertices) {
  Vertices v{vectors<glm::vec3>(document, target["POSITION"], vertices),
             vectors<glm::vec3>(document, target["NORMAL"], vertices),
             {}};
  for (const glm::vec3& t : vectors<glm::vec3>(document, target["TANGENT"], vertices)) v.tangents.emplace_back(t, 0);
  return v;
}

void read_influences(const GltfDocument& document, const Field& attributes, std::size_t vertices, Deformation& shape) {
  for (const glm::vec4& joints : vectors<glm::vec4>(document, attributes["JOINTS_0"], vertices)) {
    for (int k = 0; k < 4; ++k)
      if (!(joints[k] >= 0 && joints[k] < 65536 && joints[k] == std::floor(joints[k])))
        attributes["JOINTS_0"].fail(fmt::format("holds {}, no number of a joint", joints[k]));
    shape.influences.emplace_back(joints);
  }
  for (const glm::vec4& w : vectors<glm::vec4>(document, attributes["WEIGHTS_0"], vertices)) {
    const float sum = w.x + w.y + w.z + w.w;
    shape.parts.push_back(sum > 0 ? w / sum : glm::vec4(1, 0, 0, 0));
  }
  if (shape.influences.size() != shape.parts.size()) attributes["WEIGHTS_0"].fail("does not go with JOINTS_0");
}

template <class T>
void renumber(std::vector<T>& values, const std::vector<std::uint32_t>& from) {
  if (values.empty()) return;
  std::vector<T> made;
  for (const std::uint32_t k : from) made.push_back(values[k]);
  values = std::move(made);
}

// @return whether all is there that the skin needs.
bool read_skin(const GltfDocument& document, const Field& skin, std::span<const int> placed, Deformation& d) {
  const Field joints = skin["joints"], inverse = skin["inverseBindMatrices"];
  const std::size_t count = joints.size();
  for (std::size_t k = 0; k < count; ++k) d.joints.push_back(placed[joints[k].index(placed.size())]);
  for (const glm::u16vec4& four : d.influences)
    for (int k = 0; k < 4; ++k)
      if (four[k] >= count) skin.fail(fmt::format("has {} joints; a vertex names number {}", count, four[k]));
  d.inverse_bind.assign(count, Matrix(1));
  if (inverse.there()) {
    const std::vector<double> numbers = accessor_numbers(document, inverse, 16);
    if (numbers.size() < 16 * count) inverse.fail("has no matrix for each joint");
    for (std::size_t k = 0; k < 16 * count; ++k) d.inverse_bind[k / 16][int(k % 16 / 4)][int(k % 4)] = numbers[k];
  }
  return std::ranges::find(d.joints, -1) == d.joints.end();
}

std::valarray<double> weights_of(const GltfDocument& document, const Field& node, std::size_t count) {
  const Field own = node["weights"], of_mesh = document.refer(node["mesh"], "meshes")["weights"];
  const std::vector<double> found = (own.there() ? own : of_mesh).numbers(std::vector<double>(count));
  return {found.data(), found.size()};
}

/// What moves the vertices of a primitive, as the file numbers them; `rest` is not there yet.
/// @param vertices as many as it has.
Deformation read_shape(const GltfDocument& document, const Field& primitive, std::size_t vertices, SceneGraph& scene) {
  const Field targets = primitive["targets"], attributes = primitive["attributes"];
  Deformation shape;
  shape.flat = !attributes["NORMAL"].there();
  for (std::size_t k = 0; k < targets.size(); ++k) {
    shape.targets.push_back(read_target(document, targets[k], vertices));
    if (targets[k]["TEXCOORD_0"].there() || targets[k]["COLOR_0"].there())
      note_once(scene.unsupported, "morph targets of colours and texture coordinates");
  }
  if (attributes["JOINTS_0"].there()) read_influences(document, attributes, vertices, shape);
  if (attributes["JOINTS_1"].there()) note_once(scene.unsupported, "more than four joints of a vertex");
  return shape;
}

/// The same for a mesh made ready to be drawn, which may have repeated vertices.
/// @param before its corners as they were.
void finish_shape(Deformation& shape, const std::vector<std::uint32_t>& before, const Mesh& mesh) {
  // Corners keep their order.
  std::vector<std::uint32_t> from(mesh.positions.size());
  std::iota(from.begin(), from.end(), 0U);
  for (std::size_t k = 0; k < before.size(); ++k) from[mesh.indices[k]] = before[k];
  for (Vertices& target : shape.targets) {
    renumber(target.positions, from);
    renumber(target.normals, from);
    renumber(target.tangents, from);
  }
  renumber(shape.influences, from);
  renumber(shape.parts, from);
  shape.rest = {mesh.positions, mesh.normals, mesh.tangents};
}

/// Into scene.deformations, for each node whose mesh moves; a mesh of several nodes is repeated for them.
/// @param placed where in scene.nodes each node of the document is; -1: not in the scene.
/// @param shapes by mesh of the scene.
void read_deformations(const GltfDocument& document, std::span<const int> placed,
                       const std::map<int, Deformation>& shapes, SceneGraph& scene) {
  const Field nodes = document.root()["nodes"];
  std::map<int, int> users;  // Of each mesh: nodes that still show it.
  for (const Node& node : scene.nodes)
    for (const int mesh : node.meshes) ++users[mesh];
  std::size_t vertices = 0;
  for (std::size_t n = 0; n < placed.size(); ++n) {
    if (placed[n] < 0) continue;
    for (int& mesh : scene.nodes[std::size_t(placed[n])].meshes) {
      const auto shape = shapes.find(mesh);
      const bool is_skinned = nodes[n]["skin"].there();
      if (shape == shapes.end() || (shape->second.targets.empty() && !is_skinned)) continue;
      Deformation d = shape->second;
      vertices += d.rest.positions.size() * (1 + d.targets.size());
      if (vertices > max_corners) nodes[n].fail("is one too many: too many vertices move");
      if (!is_skinned || d.influences.empty() ||
          !read_skin(document, document.refer(nodes[n]["skin"], "skins"), placed, d)) {
        if (!d.joints.empty()) note_once(scene.unsupported, "skins with joints outside the scene");
        d.joints.clear();
      }
      d.weights = weights_of(document, nodes[n], d.targets.size());
      if (users[mesh]-- > 1) {
        scene.meshes.push_back(Mesh(scene.meshes[std::size_t(mesh)]));
        mesh = int(scene.meshes.size()) - 1;
      }
      d.mesh = mesh;
      d.node = placed[n];
      scene.deformations.push_back(std::move(d));
    }
  }
}

std::vector<std::uint32_t> corners(const GltfDocument& document, const Field& accessor, std::size_t vertices) {
  std::vector<std::uint32_t> found;
  if (!accessor.there()) {
    for (std::size_t k = 0; k < vertices; ++k) found.push_back(std::uint32_t(k));
    return found;
  }
  for (const double n : accessor_numbers(document, accessor, 1)) {
    if (!(n >= 0) || n >= double(vertices) || n != std::floor(n))
      accessor.fail(fmt::format("points to vertex {}, but there are {}", n, vertices));
    found.push_back(std::uint32_t(n));
  }
  return found;
}

// Triangles of a list, a strip or a fan (specification, 3.7.2.1).
std::vector<std::uint32_t> triangles(std::vector<std::uint32_t> v, const Field& primitive, SceneGraph& scene) {
  const std::size_t mode = primitive["mode"].index(7, 4);
  if (mode == 4) {
    // No program draws a triangle that is not whole.
    if (v.size() % 3 != 0)
      note_once(scene.remarks,
                "against glTF's rules, a mesh has corners beyond its last whole triangle: they are not drawn");
    v.resize(v.size() / 3 * 3);
    return v;
  }
  std::vector<std::uint32_t> found;
  for (std::size_t k = 0; k + 2 < v.size(); ++k) {
    if (mode == 5) found.insert(found.end(), {v[k], v[k + 1 + k % 2], v[k + 2 - k % 2]});
    if (mode == 6) found.insert(found.end(), {v[0], v[k + 1], v[k + 2]});
  }
  return found;
}

// COLOR_0: red, green and blue, and alpha or not, clamped (specification, 3.7.2.1).
std::vector<glm::vec4> colours(const GltfDocument& document, const Field& accessor, std::size_t expected) {
  if (!accessor.there()) return {};
  std::vector<glm::vec4> found;
  if (document.refer(accessor, "accessors")["type"].text() == "VEC4")
    found = vectors<glm::vec4>(document, accessor, expected);
  else
    for (const glm::vec3& c : vectors<glm::vec3>(document, accessor, expected)) found.emplace_back(c, 1);
  for (glm::vec4& c : found) c = glm::clamp(c, 0.0F, 1.0F);
  return found;
}

Mesh plain(GltfReader& r, const Field& primitive) {
  const GltfDocument& document = r.document;
  const Field attributes = primitive["attributes"];
  Mesh mesh;
  mesh.positions = vectors<glm::vec3>(document, attributes["POSITION"], 0);
  if (mesh.positions.empty()) return mesh;
  const std::size_t count = mesh.positions.size();
  mesh.normals = vectors<glm::vec3>(document, attributes["NORMAL"], count);
  mesh.coordinates = vectors<glm::vec2>(document, attributes["TEXCOORD_0"], count);
  mesh.tangents = vectors<glm::vec4>(document, attributes["TANGENT"], count);
  mesh.colours = colours(document, attributes["COLOR_0"], count);
  mesh.indices = triangles(corners(document, primitive["indices"], count), primitive, r.scene);
  return mesh;
}

Mesh compressed(const GltfDocument& document, const Field& primitive) {
  const Field extension = primitive["extensions"]["KHR_draco_mesh_compression"], attributes = extension["attributes"];
  const auto id = [](const Field& field) {
    return field.there() ? std::optional(unsigned(field.index(std::size_t{1} << 31))) : std::nullopt;
  };
  try {
    return decode_draco(view_bytes(document, extension["bufferView"]),
                        {.position = unsigned(attributes["POSITION"].index(std::size_t{1} << 31)),
                         .normal = id(attributes["NORMAL"]),
                         .coordinate = id(attributes["TEXCOORD_0"])});
  } catch (const InputError& e) {
    primitive.fail(e.what());
  }
}

// Where a normal map asks for them: those of the file, or as MikkTSpace makes them.
void complete_tangents(Mesh& mesh, const Material& material) {
  if (material.normal_texture < 0 && material.coat_normal_texture < 0) return mesh.tangents.clear();
  const auto is_none = [](const glm::vec4& t) { return glm::vec3(t) == glm::vec3(0) || std::abs(t.w) != 1; };
  if (mesh.tangents.empty() || std::ranges::any_of(mesh.tangents, is_none)) add_tangents(mesh);
}

/// Into scene.meshes, one a primitive.
void read_mesh(GltfReader& r, const Field& field) {
  const Field primitives = field["primitives"];
  std::vector<int>& made = r.meshes.emplace_back();
  for (std::size_t k = 0; k < primitives.size(); ++k) {
    const Field primitive = primitives[k], attributes = primitive["attributes"];
    if (primitive["mode"].index(7, 4) < 4) {
      r.note_unsupported("points and lines");
      continue;
    }
    const bool draco = primitive["extensions"]["KHR_draco_mesh_compression"].there();
    Mesh mesh = draco ? compressed(r.document, primitive) : plain(r, primitive);
    if (draco && attributes["COLOR_0"].there()) r.note_unsupported("colours of Draco's vertices");
    if (mesh.indices.empty()) continue;
    const bool moves = primitive["targets"].size() > 0 || attributes["JOINTS_0"].there();
    if (draco && moves) r.note_unsupported("skins and morph targets of Draco's vertices");
    std::optional<Deformation> shape;
    if (moves && !draco) shape = read_shape(r.document, primitive, mesh.positions.size(), r.scene);
    const std::vector<std::uint32_t> before = mesh.indices;
    mesh.material = material_of(r, primitive["material"]);
    const bool unlit =
        primitive["material"].there() &&
        r.document.refer(primitive["material"], "materials")["extensions"]["KHR_materials_unlit"].there();
    if (unlit && !mesh.colours.empty()) {
      r.note_unsupported("colours of unlit vertices");
      mesh.colours.clear();
    }
    if (primitive["material"].there())
      std::ranges::transform(mesh.coordinates, mesh.coordinates.begin(), r.transforms[std::size_t(mesh.material)]);
    const auto is_finite = [](const glm::vec2& t) { return std::isfinite(t.x) && std::isfinite(t.y); };
    if (!std::ranges::all_of(mesh.coordinates, is_finite))
      primitive.fail("has transformed texture coordinates beyond float32");
    complete(mesh);
    complete_tangents(mesh, r.scene.materials[std::size_t(mesh.material)]);
    made.push_back(int(r.scene.meshes.size()));
    if (shape) {
      finish_shape(*shape, before, mesh);
      r.shapes.emplace(made.back(), std::move(*shape));
    }
    r.scene.meshes.push_back(std::move(mesh));
  }
}

/// @throws InputError where the meshes have too many corners: files can name the same bytes again and again, so their
/// size says nothing of what they make.
void check_corners(const GltfDocument& document) {
  const Field meshes = document.root()["meshes"];
  std::size_t corners = 0;
  for (std::size_t m = 0; m < meshes.size(); ++m)
    for (std::size_t k = 0; k < meshes[m]["primitives"].size(); ++k) {
      const Field primitive = meshes[m]["primitives"][k];
      for (const Field& list : {primitive["indices"], primitive["attributes"]["POSITION"]})
        if (list.there()) corners += document.refer(list, "accessors")["count"].index(std::size_t{1} << 31);
      for (std::size_t t = 0; t < primitive["targets"].size(); ++t)
        for (const char* what : {"POSITION", "NORMAL", "TANGENT"})
          if (const Field list = primitive["targets"][t][what]; list.there())
            corners += document.refer(list, "accessors")["count"].index(std::size_t{1} << 31);
      if (corners > max_corners)
        primitive.fail(fmt::format("is one too many: over {} million corners", max_corners / 1000000));
    }
}

}  // namespace

// glTF 2.0.

namespace {

constexpr std::string_view modelled[] = {"KHR_materials_emissive_strength",
                                         "KHR_lights_punctual",
                                         "KHR_materials_transmission",
                                         "KHR_materials_ior",
                                         "KHR_materials_volume",
                                         "KHR_materials_clearcoat",
                                         "KHR_materials_sheen",
                                         "KHR_mesh_quantization",
                                         "KHR_draco_mesh_compression",
                                         "KHR_materials_unlit",
                                         "KHR_texture_transform"};

Matrix local_matrix(const Field& node) {
  if (node["matrix"].there()) {
    const auto numbers = node["matrix"].numbers(std::vector<double>(16));
    Matrix m;
    for (int k = 0; k < 16; ++k) m[k / 4][k % 4] = numbers[k];
    for (int k = 0; k < 4; ++k)
      if (m[k][3] != (k == 3 ? 1 : 0)) node["matrix"].fail("is not affine");
    return m;
  }
  const NodeTransform p = node_transform(node);
  return glm::scale(glm::translate(Matrix(1), p.translation) * glm::mat4_cast(p.rotation), p.scale);
}

void read_light(GltfReader& r, const Field& node, int index) {
  const Field reference = node["extensions"]["KHR_lights_punctual"]["light"];
  if (!reference.there()) return;
  const Field all = r.document.root()["extensions"]["KHR_lights_punctual"]["lights"];
  const Field field = all[reference.index(all.size())], spot = field["spot"];
  const std::string type = field["type"].text();
  PunctualLight light{.node = index};
  if (type == "spot")
    light.kind = PunctualLight::Kind::spot;
  else if (type == "directional")
    light.kind = PunctualLight::Kind::directional;
  else if (type != "point")
    field["type"].fail("is '" + type + "', no kind of light");
  const auto colour = field["color"].numbers({1, 1, 1}, 0, most_light);
  light.intensity = Colour(Flux(colour[0], colour[1], colour[2]) * field["intensity"].number(1, 0, 1e30));
  light.range = field["range"].number(0, 0, 1e30);
  constexpr double rounding = 1e-6;  // Of angles that were float32.
  light.outer = std::min(spot["outerConeAngle"].number(pi / 4, 0, pi / 2 + rounding), pi / 2);
  light.inner = std::min(spot["innerConeAngle"].number(0, 0, light.outer + rounding), light.outer);
  r.scene.lights.push_back(light);
}

void read_camera(GltfReader& r, const Field& node, int index) {
  if (!node["camera"].there()) return;
  const Field field = r.document.refer(node["camera"], "cameras"), perspective = field["perspective"];
  const Field orthographic = field["orthographic"], shape = perspective.there() ? perspective : orthographic;
  Camera camera{.name = field["name"].text(), .node = index};
  if (perspective.there()) {
    camera.vertical_field = perspective["yfov"].number(0.8, 1e-4, pi - 1e-4);
  } else {
    // The specification warns of mirrored ones; 0 shows nothing.
    camera.half_height = std::abs(orthographic["ymag"].number(1, -1e30, 1e30));
    if (camera.half_height == 0) orthographic["ymag"].fail("is 0");
  }
  camera.near = shape["znear"].number(0.01, 0, 1e30);
  camera.far = std::max(shape["zfar"].number(1e9, 0, 1e30), camera.near);
  if (camera.name.empty()) camera.name = r.scene.nodes[index].name;
  // So that it can be asked for.
  if (camera.name.empty()) camera.name = fmt::format("camera {}", r.scene.cameras.size());
  r.scene.cameras.push_back(camera);
}

// The parent of each node; -1 of roots. Each node has one at most, so what goes round never comes to a root.
std::vector<int> parents(const Field& nodes) {
  std::vector<int> found(nodes.size(), -1);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const Field children = nodes[k]["children"];
    for (std::size_t c = 0; c < children.size(); ++c) {
      const std::size_t child = children[c].index(nodes.size());
      if (found[child] >= 0) children[c].fail(fmt::format("is node {}, which has another parent", child));
      found[child] = int(k);
    }
  }
  std::vector<int> checked(nodes.size(), -1);  // By the walk that came through.
  for (std::size_t k = 0; k < nodes.size(); ++k)
    for (int up = int(k); up >= 0; up = found[up]) {
      int& mark = checked[up];
      if (mark == int(k)) nodes[k].fail("lies below itself");
      if (mark >= 0) break;
      mark = int(k);
    }
  return found;
}

// Nodes of the scene that hang below no other one of it. What the rules of scenes forbid, and other programs draw, is
// drawn, too.
std::vector<std::size_t> roots(GltfReader& r, const std::vector<int>& parent) {
  std::vector<std::size_t> found;
  const Field scenes = r.document.root()["scenes"];
  if (scenes.size() == 0) {
    for (std::size_t k = 0; k < parent.size(); ++k)
      if (parent[k] < 0) found.push_back(k);
    return found;
  }
  const Field listed = scenes[r.document.root()["scene"].index(scenes.size(), 0)]["nodes"];
  std::vector<bool> named(parent.size());
  for (std::size_t k = 0; k < listed.size(); ++k) named[listed[k].index(parent.size())] = true;
  for (std::size_t k = 0; k < listed.size(); ++k) {
    const std::size_t node = listed[k].index(parent.size());
    int up = parent[node];
    while (up >= 0 && !named[std::size_t(up)]) up = parent[std::size_t(up)];
    if (up >= 0)
      note_once(r.scene.remarks,
                "against glTF's rules, the scene lists nodes that others in it have as children: they "
                "are drawn below these");
    else if (std::ranges::find(found, node) != found.end())
      note_once(r.scene.remarks, "against glTF's rules, the scene lists a node twice: it is drawn once");
    else
      found.push_back(node);
    if (up < 0 && parent[node] >= 0)
      note_once(r.scene.remarks,
                "against glTF's rules, the scene lists nodes that are children of others, which are not "
                "in it: they are drawn as roots");
  }
  return found;
}

void read_nodes(GltfReader& r) {
  const Field all = r.document.root()["nodes"];
  const std::vector<int> parent = parents(all);
  r.nodes.assign(all.size(), -1);
  std::vector<std::size_t> order = roots(r, parent);
  for (std::size_t next = 0; next < order.size(); ++next) {
    const Field field = all[order[next]], children = field["children"];
    const int index = int(next), above = parent[order[next]];
    r.nodes[order[next]] = index;
    Node node{.name = field["name"].text(), .local = local_matrix(field)};
    if (above >= 0) node.parent = r.nodes[above];
    if (field["mesh"].there()) node.meshes = r.meshes[field["mesh"].index(r.meshes.size())];
    r.scene.nodes.push_back(std::move(node));
    read_light(r, field, index);
    read_camera(r, field, index);
    for (std::size_t c = 0; c < children.size(); ++c) order.push_back(children[c].index(all.size()));
  }
}

void check_extensions(GltfReader& r) {
  const Field used = r.document.root()["extensionsUsed"], required = r.document.root()["extensionsRequired"];
  const auto known = [](const std::string& name) { return std::ranges::find(modelled, name) != std::end(modelled); };
  for (std::size_t k = 0; k < required.size(); ++k)
    if (const std::string name = required[k].text(); !known(name))
      throw InputError("not supported: the extension " + name + ", which the file requires");
  for (std::size_t k = 0; k < used.size(); ++k)
    if (const std::string name = used[k].text(); !known(name)) r.note_unsupported("the extension " + name);
}

}  // namespace

SceneGraph read_gltf(std::span<const std::byte> file, const SceneFolder& folder, std::uint64_t max_pixels,
                     bool allow_missing) {
  const GltfDocument document = open_gltf(file, folder);
  GltfReader r{document, max_pixels, allow_missing};
  r.scene.files = document.files;
  check_extensions(r);
  check_corners(document);
  const Field materials = document.root()["materials"], meshes = document.root()["meshes"];
  for (std::size_t k = 0; k < materials.size(); ++k) read_material(r, materials[k]);
  for (std::size_t k = 0; k < meshes.size(); ++k) read_mesh(r, meshes[k]);
  read_nodes(r);
  read_deformations(document, r.nodes, r.shapes, r.scene);
  read_motions(document, r.nodes, r.scene);
  deform(r.scene, pose(r.scene, 0), 0);
  return std::move(r.scene);
}

}  // namespace envmap

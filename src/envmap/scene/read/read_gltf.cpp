#include "envmap/scene/read/read_gltf.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <string_view>

#include "envmap/base/error.h"
#include "envmap/scene/deform.h"
#include "envmap/scene/read/gltf_reader.h"

namespace envmap {
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

Scene read_gltf(std::span<const std::byte> file, const SceneFolder& folder, std::uint64_t max_pixels,
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

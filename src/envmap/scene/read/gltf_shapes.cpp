#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numeric>

#include "envmap/scene/mesh.h"
#include "envmap/scene/read/gltf_reader.h"

namespace envmap {
namespace {

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

}  // namespace

Deformation read_shape(const GltfDocument& document, const Field& primitive, std::size_t vertices, Scene& scene) {
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

void read_deformations(const GltfDocument& document, std::span<const int> placed,
                       const std::map<int, Deformation>& shapes, Scene& scene) {
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

}  // namespace envmap

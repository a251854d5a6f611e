#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "envmap/scene/read/draco.h"
#include "envmap/scene/read/gltf_reader.h"
#include "envmap/scene/tangents.h"

namespace envmap {
namespace {

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
std::vector<std::uint32_t> triangles(std::vector<std::uint32_t> v, const Field& primitive, Scene& scene) {
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

}  // namespace

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

}  // namespace envmap

#include "envmap/scenes/scene/mesh.h"

#include <algorithm>
#include <cmath>

namespace envmap {
namespace {

// In double, so that triangles of 1e-6 and 1e6 have one; of a triangle without area some unit vector.
glm::vec3 triangle_normal(const Mesh& mesh, std::size_t first) {
  const auto corner = [&](std::size_t k) { return Direction(mesh.positions[mesh.indices[first + k]]); };
  const Direction normal = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
  const double length = glm::length(normal);
  return length > 0 && std::isfinite(length) ? glm::vec3(normal / length) : glm::vec3(0, 0, 1);
}

void make_flat(Mesh& mesh) {
  Mesh flat{.material = mesh.material};
  for (std::size_t k = 0; k < mesh.indices.size(); ++k) {
    const std::uint32_t v = mesh.indices[k];
    flat.indices.push_back(std::uint32_t(k));
    flat.positions.push_back(mesh.positions[v]);
    flat.normals.push_back(triangle_normal(mesh, k - k % 3));
    if (!mesh.coordinates.empty()) flat.coordinates.push_back(mesh.coordinates[v]);
    if (!mesh.colours.empty()) flat.colours.push_back(mesh.colours[v]);
  }
  mesh = std::move(flat);
}

}  // namespace

void complete(Mesh& mesh) {
  if (mesh.normals.empty()) make_flat(mesh);
  for (glm::vec3& normal : mesh.normals) {
    const double length = glm::length(Direction(normal));
    normal = length > 1e-30 ? glm::vec3(Direction(normal) / length) : glm::vec3(0);
  }
  for (std::size_t k = 0; k < mesh.indices.size(); ++k)
    if (glm::vec3& normal = mesh.normals[mesh.indices[k]]; normal == glm::vec3(0))
      normal = triangle_normal(mesh, k - k % 3);
  mesh.coordinates.resize(mesh.positions.size(), glm::vec2(0));
}

void make_normals_flat(Mesh& mesh) {
  for (std::size_t k = 0; k < mesh.indices.size(); ++k)
    mesh.normals[mesh.indices[k]] = triangle_normal(mesh, k - k % 3);
}

void note_once(std::vector<std::string>& list, const std::string& what) {
  if (std::ranges::find(list, what) == list.end()) list.push_back(what);
}

}  // namespace envmap

#include "envmap/scenes/scene/tangents.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace envmap {
namespace {

Direction without(const Direction& normal, const Direction& v) { return unit(v - glm::dot(normal, v) * normal); }

// Some direction across a normal.
Direction across(const Direction& normal) {
  return without(normal, std::abs(normal.x) < 0.9 ? Direction(1, 0, 0) : Direction(0, 1, 0));
}

// Of the image that lies on a triangle.
struct Mapped {
  Direction along{0};  // Where u rises; 0 where the triangle has no area in the image.
  int handed = 0;      // Of tangents; 0 there.
};

Mapped mapped(const Mesh& mesh, std::size_t first) {
  const auto from_first = [&](const auto& values, std::size_t k) {
    return values[mesh.indices[first + k]] - values[mesh.indices[first]];
  };
  const Direction p(from_first(mesh.positions, 1)), q(from_first(mesh.positions, 2));
  const glm::dvec2 a(from_first(mesh.coordinates, 1)), b(from_first(mesh.coordinates, 2));
  const double area = a.x * b.y - a.y * b.x;
  if (area == 0) return {};
  // v runs down in the image: what runs counter-clockwise there has a negative area.
  return {unit((b.y * p - a.y * q) * (area < 0 ? -1.0 : 1.0)), area < 0 ? 1 : -1};
}

// Between the sides at a corner, seen along the normal.
double angle_at(const Mesh& mesh, std::size_t first, std::size_t k, const Direction& normal) {
  const auto corner = [&](std::size_t j) { return Direction(mesh.positions[mesh.indices[first + j % 3]]); };
  const Direction a = without(normal, corner(k + 1) - corner(k)), b = without(normal, corner(k + 2) - corner(k));
  return std::acos(std::clamp(glm::dot(a, b), -1.0, 1.0));
}

using Place = std::array<float, 9>;  // Vertex key: position, normal, texture coordinates, UV handedness.

Place place_of(const Mesh& mesh, std::uint32_t v, int handed) {
  const glm::vec3 &p = mesh.positions[v], &n = mesh.normals[v];
  return {p.x, p.y, p.z, n.x, n.y, n.z, mesh.coordinates[v].x, mesh.coordinates[v].y, float(handed)};
}

void repeat_vertex(Mesh& mesh, std::uint32_t v) {
  mesh.positions.push_back(glm::vec3(mesh.positions[v]));
  mesh.normals.push_back(glm::vec3(mesh.normals[v]));
  mesh.coordinates.push_back(glm::vec2(mesh.coordinates[v]));
  if (!mesh.colours.empty()) mesh.colours.push_back(glm::vec4(mesh.colours[v]));
  mesh.tangents.emplace_back(0);
}

}  // namespace

void add_tangents(Mesh& mesh) {
  std::vector<Mapped> images;
  std::map<Place, Direction> sums;
  for (std::size_t first = 0; first < mesh.indices.size(); first += 3) {
    const Mapped image = images.emplace_back(mapped(mesh, first));
    if (image.handed == 0) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.indices[first + k];
      const Direction normal(mesh.normals[v]);
      const auto [sum, is_new] = sums.try_emplace(place_of(mesh, v, image.handed), 0);
      sum->second += angle_at(mesh, first, k, normal) * without(normal, image.along);
    }
  }
  mesh.tangents.assign(mesh.positions.size(), glm::vec4(0));
  std::map<std::pair<std::uint32_t, int>, std::uint32_t> repeated;
  for (std::size_t k = 0; k < mesh.indices.size(); ++k) {
    std::uint32_t& v = mesh.indices[k];
    const Direction normal(mesh.normals[v]);
    int handed = images[k / 3].handed;
    auto sum = sums.end();
    for (const int side : {1, -1})  // A triangle without an image takes what its neighbours have.
      if (sum == sums.end() && (handed == 0 || handed == side)) sum = sums.find(place_of(mesh, v, side));
    if (handed == 0) handed = sum == sums.end() ? 1 : int(sum->first.back());
    Direction tangent = sum == sums.end() ? Direction(0) : without(normal, sum->second);
    if (tangent == Direction(0)) tangent = across(normal);
    if (mesh.tangents[v].w == float(-handed)) {
      const auto [other, is_new] = repeated.try_emplace({v, handed}, std::uint32_t(mesh.positions.size()));
      if (is_new) repeat_vertex(mesh, v);
      v = other->second;
    }
    mesh.tangents[v] = glm::vec4(glm::vec3(tangent), handed);
  }
}

}  // namespace envmap

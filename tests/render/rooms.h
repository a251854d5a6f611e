/// @file
/// Scenes with known answers.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "envmap/projection/visit.h"
#include "envmap/scenes/render/draw.h"

namespace rooms {

using namespace envmap;

/// The box [-1,1]^3 seen from inside, `edge` vertices along each of its edges: 12 (edge - 1)^2 triangles. Each wall is
/// an instance, in the order of a cube's faces. At p it shines with (p + 1) / 2: textures of 2x2 texels, of which only
/// what lies between their centres is used.
inline SceneGraph room(int edge) {
  SceneGraph scene;
  for (int face = 0; face < 6; ++face) {
    const Cube::Axes& axes = Cube::axes[face];
    const auto corner = [&](double s, double t) { return axes.forward + s * axes.right + t * axes.up; };
    Texture texture{
        .width = 2, .height = 2, .srgb = false, .wrap_u = Texture::Wrap::clamp, .wrap_v = Texture::Wrap::clamp};
    for (const double t : {1.0, -1.0})
      for (const double s : {-1.0, 1.0}) texture.texels.emplace_back(glm::u8vec3(127.5 * (corner(s, t) + 1.0)), 255);
    scene.textures.push_back(texture);
    scene.materials.push_back(
        {.base_colour = {0, 0, 0, 1}, .emissive = Colour(1), .emissive_texture = face, .double_sided = false});
    Mesh mesh{.material = face};
    const auto last = double(edge - 1);
    for (int j = 0; j < edge; ++j)
      for (int i = 0; i < edge; ++i) {
        mesh.positions.emplace_back(corner(2 * i / last - 1, 1 - 2 * j / last));
        mesh.normals.emplace_back(-axes.forward);
        mesh.coordinates.emplace_back(0.25 + 0.5 * i / last, 0.25 + 0.5 * j / last);
      }
    const auto vertex = [&](int i, int j) { return std::uint32_t(j * edge + i); };
    for (int j = 0; j + 1 < edge; ++j)
      for (int i = 0; i + 1 < edge; ++i)
        for (const std::uint32_t index : {vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1), vertex(i, j),
                                          vertex(i + 1, j + 1), vertex(i + 1, j)})
          mesh.indices.push_back(index);
    scene.meshes.push_back(mesh);
    scene.nodes.push_back({.name = "wall " + std::to_string(face), .meshes = {face}});
  }
  return scene;
}

/// A ball about the origin, `rings` high, of material 0.
inline Mesh ball(int rings, double radius = 1) {
  Mesh mesh;
  for (int j = 0; j <= rings; ++j)
    for (int i = 0; i <= 2 * rings; ++i) {
      const double polar = pi * j / rings, turn = pi * i / rings;
      const Direction n(std::sin(polar) * std::cos(turn), std::cos(polar), -std::sin(polar) * std::sin(turn));
      mesh.positions.emplace_back(radius * n);
      mesh.normals.emplace_back(n);
      mesh.coordinates.emplace_back(0, 0);
    }
  const auto at = [&](int i, int j) { return std::uint32_t(j * (2 * rings + 1) + i); };
  for (int j = 0; j < rings; ++j)
    for (int i = 0; i < 2 * rings; ++i)
      for (const std::uint32_t k : {at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i + 1, j)})
        mesh.indices.push_back(k);
  return mesh;
}

struct Hit {
  std::uint32_t surface;
  double distance;
  Direction place;
};

/// Where a ray from inside the room meets it.
inline Hit hit(const Direction& from, const Direction& ray) {
  Hit first{0, std::numeric_limits<double>::infinity(), {}};
  for (int axis = 0; axis < 3; ++axis) {
    if (ray[axis] == 0) continue;
    const double distance = (std::copysign(1.0, ray[axis]) - from[axis]) / ray[axis];
    if (distance < first.distance) first = {std::uint32_t(2 * axis + (ray[axis] < 0) + 1), distance, {}};
  }
  first.place = from + first.distance * ray;
  return first;
}

/// f(texel, ray in the frame of the map) for every texel that is part of the map.
template <class F>
void for_each_texel(Projection p, int size, F f) {
  const int width = size * aspect(p);
  for (int face = 0; face < faces(p); ++face)
    for (int row = 0; row < size; ++row) {
      const Columns in = columns(p, size, row);
      std::vector<Direction> rays(in.count());
      texel_directions(p, size, face, row, in.first, rays);
      for (std::size_t k = 0; k < rays.size(); ++k)
        f(std::size_t(face * size + row) * std::size_t(width) +
              std::size_t(in.first) + k,
          rays[k]);
    }
}

inline Colour colour_at(const Drawn& map, std::size_t texel) {
  const Level& level = map.radiance.base();
  const auto width = std::size_t(level.width()), height = std::size_t(level.height());
  return *level.texel(int(texel / (width * height)), int(texel % width),
                      int(texel / width % height));
}

/// What is wrong in a map of the room: parts of its texels, and the largest difference in radiance where the surface is
/// right.
struct Faults {
  double holes = 0, surface = 0, distance = 0, colour = 0;
};

inline Faults judge(const Drawn& map, const Viewpoint& from) {
  Faults faults;
  double texels = 0;
  for_each_texel(from.to, from.size, [&](std::size_t k, const Direction& ray) {
    const Hit truth = hit(from.at, from.axes * ray);
    ++texels;
    if (map.surfaces[k] == 0)
      ++faults.holes;
    else if (map.surfaces[k] != truth.surface)
      ++faults.surface;
    else
      faults.colour =
          std::max(faults.colour,
                   double(glm::length(glm::vec3(colour_at(map, k) - Colour(0.5 * (truth.place + 1.0))))));
    if (!(std::abs(map.distances[k] - truth.distance) <= 0.01 * truth.distance)) ++faults.distance;
  });
  faults.holes /= texels;
  faults.surface /= texels;
  faults.distance /= texels;
  return faults;
}

}  // namespace rooms

/// @file
/// Things on a floor under lights, and who looks at them.
#pragma once

#include "rooms.h"

namespace small_scenes {

using namespace envmap;

inline constexpr int size = 128;
inline const Material plaster{.roughness = 1, .ior = 1};  // No interface: all is diffused.

// Turns -Z, where lights shine, to a direction.
inline Matrix shining(const Direction& at, const Direction& along) {
  return glm::inverse(glm::lookAt(at, at + along, Direction(0.1, 1, 0.2)));
}

inline void add(SceneGraph& scene, Mesh mesh, const Material& material, const Matrix& local = Matrix(1)) {
  mesh.material = int(scene.materials.size());
  scene.materials.push_back(material);
  scene.nodes.push_back({.local = local, .meshes = {int(scene.meshes.size())}});
  scene.meshes.push_back(std::move(mesh));
}

inline void add(SceneGraph& scene, PunctualLight light, const Direction& at, const Direction& along) {
  light.node = int(scene.nodes.size());
  scene.nodes.push_back({.local = shining(at, along)});
  scene.lights.push_back(light);
}

// A square of half a side `half` at y = 0 that faces +Y.
inline Mesh square(float half) {
  Mesh mesh;
  for (const auto& [x, z] : {std::pair(-1.0F, 1.0F), {1.0F, 1.0F}, {1.0F, -1.0F}, {-1.0F, -1.0F}}) {
    mesh.positions.emplace_back(half * x, 0, half * z);
    mesh.normals.emplace_back(0, 1, 0);
    mesh.coordinates.emplace_back(0.5F + 0.5F * x, 0.5F + 0.5F * z);
  }
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

inline Viewpoint camera() {
  const Direction at(0.8, 2.6, 3.2), back = glm::normalize(at - Direction(0, 0.2, 0));
  const Direction right = glm::normalize(glm::cross(Direction(0, 1, 0), back));
  return {.size = size, .at = at, .axes = {right, glm::cross(back, right), back}, .lens = Lens{size, {0.6, 0.6}, 0}};
}

// f(pixel's number, its ray in the world).
inline void for_each_pixel(const Viewpoint& from, auto&& f) {
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) f(j * size + i, from.axes * from.lens->ray((i + 0.5) / size, (j + 0.5) / size));
}

// A ball, a leaning card with holes and a wall on a floor, glass above them.
inline SceneGraph still_life() {
  SceneGraph scene;
  scene.textures = {{.width = 2,
                     .height = 2,
                     .texels = {{255, 255, 255, 255}, {255, 255, 255, 0}, {255, 255, 255, 0}, {255, 255, 255, 255}}}};
  add(scene, square(2), plaster);
  add(scene, rooms::ball(48, 0.4), {.roughness = 0.5F}, glm::translate(Matrix(1), Direction(0.5, 0.4, -0.2)));
  add(scene, square(0.4F), {.base_colour_texture = 0, .roughness = 1, .alpha_cutoff = 0.5F, .double_sided = true},
      glm::translate(Matrix(1), Direction(-0.3, 0.8, 0.1)) * glm::rotate(Matrix(1), 0.6, Direction(0, 0, 1)));
  add(scene, square(0.6F), plaster,
      glm::translate(Matrix(1), Direction(0, 0.6, -1.2)) * glm::rotate(Matrix(1), 0.5 * pi, Direction(1, 0, 0)));
  add(scene, rooms::ball(24, 0.2), {.roughness = 0, .transmission = 1},
      glm::translate(Matrix(1), Direction(-0.9, 0.9, 0.8)));
  return scene;
}

}  // namespace small_scenes

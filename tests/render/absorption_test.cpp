// Light that a solid absorbs on its way, by rays and by maps, against Beer and Lambert's law in float64.
#include <gtest/gtest.h>

#include <cmath>

#include "drawing.h"
#include "envmap/operate/generate.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/render/renderer.h"
#include "gltf_file.h"
#include "rooms.h"

namespace absorption_test {
namespace {

using namespace envmap;

constexpr int size = 40;
const Colour absorption(0.9F, 0.4F, 0.05F);

const Environment& white() {
  static const Environment sky(generate(Constant{Direction(1)}, Projection::cube, 16), 8);
  return sky;
}

Material glass(float ior) {
  return {.roughness = 0, .transmission = 1, .ior = ior, .solid = true, .absorption = absorption, .thickness = 0.3F};
}

SceneGraph scene_of(Mesh mesh, const Material& material, const Matrix& local = Matrix(1)) {
  SceneGraph scene;
  scene.materials = {material};
  scene.meshes = {std::move(mesh)};
  scene.nodes = {{.local = local, .meshes = {0}}};
  return scene;
}

// From z = -0.5 to 0.5, so wide that light between its faces stays between them.
Mesh slab() {
  constexpr float wide = 400, deep = 0.5;
  Mesh mesh;
  for (const float side : {1.0F, -1.0F}) {
    const auto first = std::uint32_t(mesh.positions.size());
    for (const auto& [x, y] : {std::pair(-1.0F, -1.0F), {1.0F, -1.0F}, {1.0F, 1.0F}, {-1.0F, 1.0F}}) {
      mesh.positions.emplace_back(side * wide * x, wide * y, side * deep);
      mesh.normals.emplace_back(0, 0, side);
      mesh.coordinates.emplace_back(0, 0);
    }
    for (const std::uint32_t k : {0U, 1U, 2U, 0U, 2U, 3U}) mesh.indices.push_back(first + k);
  }
  return mesh;
}

Viewpoint camera() {
  const Direction at(0.5, 0.4, 3), back = glm::normalize(at), right = glm::normalize(glm::cross({0, 1, 0}, back));
  return {.size = size, .at = at, .axes = {right, glm::cross(back, right), back}, .lens = Lens{size, {0.6, 0.6}, 0}};
}

// What arrives in a white world through a solid where light inside meets its surfaces at the angle at which it entered,
// always after the same way: it is reflected outside, or enters and leaves at one of its returns. Schlick 1994.
double through(double ior, double cosine, double absorbed, double way) {
  const double normal = std::pow((ior - 1) / (ior + 1), 2);
  const double reflected = ior > 1 ? normal + (1 - normal) * std::pow(1 - cosine, 5) : 0;
  const double left = std::exp(-absorbed * way);
  return reflected + (1 - reflected) * left * (1 - reflected) / (1 - left * reflected);
}

double cosine_inside(double ior, double cosine) { return std::sqrt(1 - (1 - cosine * cosine) / (ior * ior)); }

// @param way (cosine of incidence outside, inside, ray) -> metres, or less than 0 where the ray is not to be judged.
void expect_law(const SceneGraph& scene, double ior, auto&& way) {
  const Viewpoint from = camera();
  const auto picture =
      raycast_picture({.scene = scene, .pose = pose(scene, 0), .environment = &white()}, from, {.mirrors = {0}});
  int judged = 0;
  for (int k = 0; k < size * size; ++k) {
    const Direction ray = from.axes * from.lens->ray((k % size + 0.5) / size, (k / size + 0.5) / size);
    const auto [cosine, length] = way(ray);
    if (length < 0) continue;
    for (int c = 0; c < 3; ++c)
      ASSERT_NEAR(picture[std::size_t(k)][c], through(ior, cosine, absorption[c], length), 0.015) << k;
    ++judged;
  }
  EXPECT_GT(judged, 200);
}

TEST(Absorption, ASlabLeavesWhatBeerAndLambertSay) {
  for (const double ior : {1.0, 1.5})
    expect_law(scene_of(slab(), glass(float(ior))), ior,
               [&](const Direction& ray) { return std::pair(-ray.z, 1 / cosine_inside(ior, -ray.z)); });
}

TEST(Absorption, ABallLeavesWhatBeerAndLambertSay) {
  for (const double ior : {1.0, 1.5})
    expect_law(scene_of(rooms::ball(128), glass(float(ior))), ior, [&](const Direction& ray) {
      const Direction from = camera().at;
      const double b = glm::dot(ray, from), root = b * b - glm::dot(from, from) + 1;
      if (root < 0.05) return std::pair(0.0, -1.0);
      const double cosine = std::sqrt(root);  // Of the ray with the normal, on a unit sphere.
      return std::pair(cosine, 2 * cosine_inside(ior, cosine));
    });
}

// Without rays inside it, a solid is as thick as its material says, in the frame of its mesh.
TEST(Absorption, MapsTakeTheThicknessOfTheMaterial) {
  const Matrix twice = glm::scale(Matrix(1), Direction(2));
  const SceneGraph scene = scene_of(rooms::ball(32, 0.4), glass(1), twice);
  const FrameState shot{.scene = scene, .pose = pose(scene, 0), .environment = &white()};
  drawing::context();
  Renderer renderer(scene, &white());
  for (const auto& picture : {draw_picture(renderer, camera(), shot), raycast_picture(shot, camera(), {})})
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(picture[std::size_t(size * size / 2 + size / 2)][c], std::exp(-absorption[c] * 0.6), 2e-3);
}

TEST(Absorption, IsReadAsColourAndDistance) {
  scenes::GltfFile file;
  file.document["nodes"] = {{{"mesh", 0}}};
  const int positions = file.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  file.document["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", positions}}}, {"material", 0}}}}}};
  const auto volume = [&](double thickness) {
    file.document["materials"] = {
        {{"extensions",
          {{"KHR_materials_volume",
            {{"thicknessFactor", thickness}, {"attenuationDistance", 0.5}, {"attenuationColor", {0.25, 1, 0}}}}}}}};
    const auto path = std::filesystem::temp_directory_path() / "envmap-absorption.glb";
    file.write(path);
    const SceneGraph scene = read_scene(path.string());
    std::filesystem::remove(path);
    return scene.materials.front();
  };
  const Material m = volume(0.2);
  EXPECT_TRUE(m.solid);
  EXPECT_FLOAT_EQ(m.thickness, 0.2F);
  EXPECT_NEAR(m.absorption.x, std::log(4) / 0.5, 1e-5);
  EXPECT_EQ(m.absorption.y, 0);
  EXPECT_GT(m.absorption.z, 100);
  EXPECT_TRUE(std::isfinite(m.absorption.z));
  EXPECT_EQ(volume(0).absorption, Colour(0)) << "a thin wall absorbs nothing";
}

}  // namespace
}  // namespace absorption_test

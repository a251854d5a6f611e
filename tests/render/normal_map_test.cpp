// Normal maps: tangents, and what OpenGL and rays make of them, against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "drawing.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/render/renderer.h"
#include "envmap/scenes/scene/tangents.h"
#include "small_scenes.h"

namespace normal_map_test {
namespace {

using namespace envmap;

// The square lies at y = 0, u along X and v, which runs down, along Z: up in its image is -Z, which is Y x X.
TEST(Tangents, OfASquareLieAlongU) {
  Mesh mesh = small_scenes::square(2);
  add_tangents(mesh);
  for (const glm::vec4& t : mesh.tangents) EXPECT_EQ(t, glm::vec4(1, 0, 0, 1));
  for (glm::vec2& at : mesh.coordinates) at.y = 1 - at.y;
  add_tangents(mesh);
  for (const glm::vec4& t : mesh.tangents) EXPECT_EQ(t, glm::vec4(1, 0, 0, -1));
}

// Where u is the longitude of a ball, tangents run east.
TEST(Tangents, OfABallRunEast) {
  Mesh mesh = rooms::ball(16);
  for (std::size_t k = 0; k < mesh.normals.size(); ++k) {
    const std::size_t turn = k % 33, polar = k / 33;
    mesh.coordinates[k] = {float(turn) / 32, float(polar) / 16};
  }
  add_tangents(mesh);
  for (std::size_t k = 33; k + 33 < 17 * 33; ++k) {
    const double turn = pi * double(k % 33) / 16;
    const double off = glm::length(Direction(mesh.tangents[k]) - Direction(-std::sin(turn), 0, -std::cos(turn)));
    EXPECT_LT(off, k % 33 == 0 || k % 33 == 32 ? 0.12 : 1e-6) << k;  // The seam has neighbours on one side alone.
    EXPECT_EQ(mesh.tangents[k].w, 1);
  }
}

// Two triangles whose images are mirrored share a side: its vertices come to stand twice.
TEST(Tangents, OfMirroredImagesAreKeptApart) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.coordinates = {{0, 1}, {1, 1}, {0, 0}, {1, 1}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  add_tangents(mesh);
  EXPECT_EQ(mesh.positions.size(), 6U);
  for (std::size_t k = 0; k < 6; ++k) {
    const float side = k < 3 ? 1 : -1;
    EXPECT_EQ(mesh.tangents[mesh.indices[k]], glm::vec4(side, 0, 0, side)) << k;
  }
  EXPECT_EQ(mesh.positions[mesh.indices[3]], glm::vec3(0, 0, 0));
  EXPECT_EQ(mesh.positions[mesh.indices[4]], glm::vec3(0, 1, 0));
}

TEST(Tangents, AreUnitVectorsWhereThereIsNoImage) {
  Mesh mesh = small_scenes::square(1);
  for (glm::vec2& at : mesh.coordinates) at = {0.5F, 0.5F};
  add_tangents(mesh);
  for (const glm::vec4& t : mesh.tangents) {
    EXPECT_FLOAT_EQ(glm::length(glm::vec3(t)), 1);
    EXPECT_EQ(t.y, 0);
  }
}

// 1 above the horizon, 0 below it.
const Environment& half() {
  static const Environment sky([] {
    EnvironmentMap map;
    map.levels.emplace_back(Projection::latlong, 64);
    for (int row = 0; row < 32; ++row)
      for (int i = 0; i < 128; ++i) *map.base().texel(0, i, row) = Colour(1);
    return map;
  }());
  return sky;
}

struct Turned {
  const char* name;
  Matrix local;  // The square of the test below faces +Y in it.
  Direction eye;
  Direction tilted;  // Where the texel's (0.6, 0, 0.8) points in the world, on the side that is seen.
};
const Matrix upright =
    glm::rotate(Matrix(1), 0.5 * pi, Direction(1, 0, 0)) * glm::rotate(Matrix(1), 0.5 * pi, Direction(0, 1, 0));
const Turned turned[] = {{"Flat", Matrix(1), {0, 3, 0.1}, {0.6, 0.8, 0}},
                         {"Upright", upright, {0, 0, 3}, {0, 0.6, 0.8}},
                         {"Back", upright, {0, 0, -3}, {0, -0.6, -0.8}},
                         {"Mirrored", glm::scale(Matrix(1), Direction(1, -1, 1)) * upright, {0, 0, 3}, {0, -0.6, 0.8}},
                         {"Stretched", upright* glm::scale(Matrix(1), Direction(0.5, 7, 2)), {0, 0, 3}, {0, 0.6, 0.8}}};

class NormalMap : public ::testing::TestWithParam<Turned> {};
INSTANTIATE_TEST_SUITE_P(All, NormalMap, ::testing::ValuesIn(turned),
                         [](const auto& p) { return std::string(p.param.name); });

// Half a sphere of sky gives E = pi (1 + n.y) / 2 (Lambert 1760), of the normal that the map says.
TEST_P(NormalMap, TiltsTheNormal) {
  const Turned& t = GetParam();
  SceneGraph scene;
  scene.textures = {{.width = 1, .height = 1, .texels = {{204, 128, 230, 255}}, .srgb = false}};
  small_scenes::add(scene, small_scenes::square(1),
                    {.roughness = 1, .normal_texture = 0, .ior = 1, .double_sided = true}, t.local);
  add_tangents(scene.meshes[0]);
  const FrameState shot{.scene = scene, .pose = pose(scene, 0), .environment = &half()};
  const View view = looking_at({.at = t.eye}, Direction(0));
  const Viewpoint from{.size = 1, .at = t.eye, .axes = view.axes, .lens = Lens{1, {0.01, 0.01}, 0}};
  drawing::context();
  Renderer renderer(scene, &half());
  const double expected = 0.5 * (1 + t.tilted.y);
  EXPECT_NEAR(draw_picture(renderer, from, shot)[0].y, expected, 0.01);
  EXPECT_NEAR(raycast_picture(shot, from, {})[0].y, expected, 0.01);
}

}  // namespace
}  // namespace normal_map_test

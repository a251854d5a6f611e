// Meshes that change their shape, against closed forms, and drawn by OpenGL against rays.
#include "envmap/scenes/scene/skin_and_morph.h"

#include "drawing.h"
#include "envmap/scenes/lit_scene.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/render/renderer.h"
#include "gltf_file.h"
#include "rooms.h"

namespace skin_and_morph_test {
namespace {

using namespace envmap;
using namespace scenes;
using DeformTest = SceneTest;

constexpr float quarter = 0.70710678F;  // Of a turn, as a quaternion: sine and cosine of 45 degrees.

void animate(GltfFile& file, int node, const char* path, const std::vector<float>& values, const char* type,
             int components) {
  const int times = file.add<float>({0, 1}, "SCALAR", 1), output = file.add<float>(values, type, components);
  json& animation = file.document["animations"][0];
  animation["channels"].push_back(
      {{"sampler", animation["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
  animation["samplers"].push_back({{"input", times}, {"output", output}});
}

// A square at z = 0 that faces +Z; its only target lifts it by 2 and turns its normals to +X.
GltfFile square(bool normals) {
  GltfFile file;
  json& primitive = file.document["meshes"][0]["primitives"][0];
  primitive["attributes"]["POSITION"] = file.add<float>({-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0}, "VEC3", 3);
  primitive["targets"][0]["POSITION"] = file.add<float>({0, 0, 2, 0, 0, 2, 0, 0, 2, 0, 0, 2}, "VEC3", 3);
  if (normals) {
    primitive["attributes"]["NORMAL"] = file.add<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
    primitive["targets"][0]["NORMAL"] = file.add<float>({1, 0, -1, 1, 0, -1, 1, 0, -1, 1, 0, -1}, "VEC3", 3);
  }
  primitive["indices"] = file.add<std::uint16_t>({0, 1, 2, 0, 2, 3}, "SCALAR", 1);
  file.document["nodes"] = {{{"mesh", 0}}};
  return file;
}

TEST_F(DeformTest, MorphTargetsAreAddedByTheirWeights) {
  GltfFile file = square(true);
  file.document["meshes"][0]["weights"] = {0.25};
  file.write(folder / "rest.glb");
  SceneGraph rest = read_scene(path("rest.glb"));
  EXPECT_EQ(rest.meshes[0].positions[0], glm::vec3(-1, -1, 0.5F)) << "the mesh's own weights";
  EXPECT_TRUE(deform(rest, pose(rest, 0), 0).empty()) << "as it was read";
  file.document["nodes"][0]["weights"] = {0.5};
  file.write(folder / "node.glb");
  EXPECT_EQ(read_scene(path("node.glb")).meshes[0].positions[0], glm::vec3(-1, -1, 1)) << "the node's";
  animate(file, 0, "weights", {0, 1}, "SCALAR", 1);
  file.write(folder / "moving.glb");
  SceneGraph scene = read_scene(path("moving.glb"));
  EXPECT_TRUE(scene.unsupported.empty());
  EXPECT_EQ(scene.meshes[0].positions[2], glm::vec3(1, 1, 0));
  EXPECT_EQ(deform(scene, pose(scene, 0.75), 0.75), std::vector<int>{0});
  EXPECT_EQ(scene.meshes[0].positions[2], glm::vec3(1, 1, 1.5F));
  EXPECT_LT(glm::distance(scene.meshes[0].normals[2], glm::normalize(glm::vec3(0.75F, 0, 0.25F))), 1e-6F);
}

// Without normals in the file triangles have their own, of which each vertex is one's alone.
TEST_F(DeformTest, FlatTrianglesGetNewNormals) {
  GltfFile file = square(false);
  json& primitive = file.document["meshes"][0]["primitives"][0];
  primitive["targets"][0]["POSITION"] = file.add<float>({0, 0, 0, 0, 0, 2, 0, 0, 2, 0, 0, 0}, "VEC3", 3);
  animate(file, 0, "weights", {0, 1}, "SCALAR", 1);
  file.write(folder / "flat.glb");
  SceneGraph scene = read_scene(path("flat.glb"));
  for (const glm::vec3& n : scene.meshes[0].normals) EXPECT_EQ(n, glm::vec3(0, 0, 1));
  deform(scene, pose(scene, 1), 1);
  for (const glm::vec3& p : scene.meshes[0].positions) EXPECT_FLOAT_EQ(p.z, p.x + 1);
  for (const glm::vec3& n : scene.meshes[0].normals)
    EXPECT_LT(glm::distance(n, glm::vec3(-quarter, 0, quarter)), 1e-6F);
}

// A tube of radius 0.3 along Y from 0 to 2, bones at 0 and 1; the upper one bends by 90 degrees about Z within a
// second. What hangs on it goes from (x, 1 + t, z) to (-t, 1 + x, z); the ring at 1, which both hold,
// to the middle of where each has it.
GltfFile tube() {
  GltfFile file;
  std::vector<float> positions, normals, weights;
  std::vector<std::uint16_t> indices;
  std::vector<std::uint8_t> joints;
  constexpr int around = 24, rings = 21;
  for (int j = 0; j < rings; ++j)
    for (int i = 0; i < around; ++i) {
      const double turn = 2 * pi * i / around, y = 0.1 * j;
      const auto c = float(std::cos(turn)), s = float(std::sin(turn));
      positions.insert(positions.end(), {0.3F * c, float(y), 0.3F * s});
      normals.insert(normals.end(), {c, 0, s});
      joints.insert(joints.end(), {0, 1, 0, 0});
      const float upper = j < 10 ? 0 : j == 10 ? 0.5F : 1;
      weights.insert(weights.end(), {1 - upper, upper, 0, 0});
      if (j + 1 == rings) continue;
      const auto at = [&](int di, int dj) { return std::uint16_t((j + dj) * around + (i + di) % around); };
      indices.insert(indices.end(), {at(0, 0), at(0, 1), at(1, 1), at(0, 0), at(1, 1), at(1, 0)});
    }
  json& primitive = file.document["meshes"][0]["primitives"][0];
  primitive["attributes"] = {{"POSITION", file.add(positions, "VEC3", 3)},
                             {"NORMAL", file.add(normals, "VEC3", 3)},
                             {"JOINTS_0", file.add(joints, "VEC4", 4)},
                             {"WEIGHTS_0", file.add(weights, "VEC4", 4)}};
  primitive["indices"] = file.add(indices, "SCALAR", 1);
  primitive["material"] = 0;
  file.document["materials"] = {{{"doubleSided", true}, {"pbrMetallicRoughness", {{"metallicFactor", 0}}}}};
  const int inverse =
      file.add<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1},
                      "MAT4", 16);
  file.document["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", inverse}}};
  // A skin's node moves nothing by itself.
  file.document["nodes"] = {
      {{"mesh", 0}, {"skin", 0}, {"name", "tube"}, {"translation", {7, 8, 9}}, {"scale", {2, 3, 4}}},
      {{"name", "lower"}, {"children", {2}}},
      {{"name", "upper"}, {"translation", {0, 1, 0}}}};
  file.document["scenes"][0]["nodes"] = {0, 1};
  animate(file, 2, "rotation", {0, 0, 0, 1, 0, 0, quarter, quarter}, "VEC4", 4);
  return file;
}

Direction in_world(const SceneGraph& scene, const Pose& pose, std::size_t vertex) {
  return Direction(pose[0] * glm::dvec4(scene.meshes[0].positions[vertex], 1));
}

TEST_F(DeformTest, ATubeOfTwoBonesBends) {
  tube().write(folder / "tube.glb");
  SceneGraph scene = read_scene(path("tube.glb"));
  EXPECT_TRUE(scene.unsupported.empty());
  const Pose straight = pose(scene, 0), bent = pose(scene, 1);
  std::vector<Direction> before;
  for (std::size_t k = 0; k < scene.meshes[0].positions.size(); ++k) before.push_back(in_world(scene, straight, k));
  EXPECT_NEAR(before[0].x, 0.3, 1e-6);
  EXPECT_EQ(deform(scene, bent, 1), std::vector<int>{0});
  const Rotation normals = glm::transpose(glm::inverse(Rotation(bent[0])));
  for (std::size_t k = 0; k < before.size(); ++k) {
    const Direction &p = before[k], turned(1 - p.y, 1 + p.x, p.z);
    const Direction wanted = p.y > 1.05 ? turned : p.y > 0.95 ? 0.5 * (p + turned) : p;
    EXPECT_LT(glm::distance(in_world(scene, bent, k), wanted), 1e-5) << k;
    const Direction n = glm::normalize(normals * Direction(scene.meshes[0].normals[k])), round(p.x / 0.3, 0, p.z / 0.3);
    if (p.y > 0.95 && p.y < 1.05) continue;
    EXPECT_LT(glm::distance(n, p.y > 1 ? Direction(0, round.x, round.z) : round), 1e-5) << k;
  }
}

// After it has moved, shadows included: a tube that bends shades itself.
TEST_F(DeformTest, IsDrawnAsRaysSeeIt) {
  GltfFile file = tube();
  file.document["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "directional"}, {"intensity", 3}}};
  file.document["nodes"].push_back(
      {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}, {"rotation", {-0.5, 0.3, 0, 0.8}}});
  file.document["scenes"][0]["nodes"].push_back(3);
  file.write(folder / "tube.glb");
  SceneGraph scene = read_scene(path("tube.glb"));
  drawing::context();
  Renderer renderer(scene, nullptr);
  const Viewpoint from{.to = Projection::cube, .size = 96, .at = {-0.2, 1, 2.2}, .which = 1U << 5};
  for (const double time : {0.0, 1.0, 0.4}) {
    const Pose now = pose(scene, time);
    for (const int mesh : deform(scene, now, time)) renderer.update(scene, mesh);
    const FrameState shot{.scene = scene, .pose = now, .ambient = Colour(0.2F)};
    const Drawn map = draw(renderer, from, shot, DrawMethod::exact), truth = raycast(shot, from);
    int others = 0, on_tube = 0, farther = 0, darker = 0;
    for (std::size_t k = 0; k < truth.surfaces.size(); ++k) {
      on_tube += truth.surfaces[k] != 0;
      others += map.surfaces[k] != truth.surfaces[k];
      if (map.surfaces[k] == 0 || truth.surfaces[k] == 0) continue;
      farther += std::abs(map.distances[k] - truth.distances[k]) > 1e-3F;
      darker += glm::distance(rooms::colour_at(map, k), rooms::colour_at(truth, k)) > 0.01F;
    }
    EXPECT_GT(on_tube, 500) << time;
    EXPECT_LE(others, 3) << time;
    EXPECT_LE(farther, 3) << time;
    EXPECT_LE(darker, on_tube / 100) << time;
  }
}

TEST_F(DeformTest, ANodeWithoutASkinKeepsTheMesh) {
  GltfFile file = tube();
  file.document["nodes"].push_back({{"mesh", 0}, {"name", "plain"}});
  file.document["scenes"][0]["nodes"].push_back(3);
  file.write(folder / "tubes.glb");
  SceneGraph scene = read_scene(path("tubes.glb"));
  const Mesh& plain = scene.meshes[std::size_t(scene.nodes[std::size_t(*find_node(scene, "plain"))].meshes[0])];
  const std::vector<glm::vec3> rest = plain.positions;
  EXPECT_EQ(deform(scene, pose(scene, 1), 1).size(), 1U);
  EXPECT_EQ(plain.positions, rest);
}

TEST_F(DeformTest, SizesAreCheckedAtEachMoment) {
  GltfFile file = square(true);
  animate(file, 0, "scale", {1, 1, 1, 1e38F, 1, 1}, "VEC3", 3);
  file.write(folder / "huge.glb");
  LitScene lit{.scene = read_scene(path("huge.glb"))};
  lit.move_to(1e-9);
  EXPECT_THROW(lit.move_to(1), InputError);
}

TEST_F(DeformTest, BrokenSkinsAreRefused) {
  const auto says = [&](auto&& change) {
    GltfFile file = tube();
    change(file.document);
    file.write(folder / "broken.glb");
    return why(path("broken.glb"));
  };
  EXPECT_NE(says([](json& d) { d["skins"][0]["joints"] = {1}; }).find("has 1 joints; a vertex names number 1"),
            std::string::npos);
  EXPECT_NE(says([](json& d) { d["skins"][0]["joints"] = {1, 9}; }).find("is 9, but there are 3"), std::string::npos);
  EXPECT_NE(says([](json& d) { d["nodes"][0]["skin"] = 1; }).find("is 1, but there are 1"), std::string::npos);
  EXPECT_NE(says([](json& d) {
              d["meshes"][0]["primitives"][0]["attributes"].erase("WEIGHTS_0");
            }).find("does not go with"),
            std::string::npos);
  GltfFile file = square(true);
  file.document["meshes"][0]["weights"] = {1, 2};
  file.write(folder / "broken.glb");
  EXPECT_NE(why(path("broken.glb")).find("holds 2 values, not 1"), std::string::npos);
}

}  // namespace
}  // namespace skin_and_morph_test

// Maps by moved vertices of surfaces with one side and with two: in front of the eye, beside it, behind it, and round
// the direction that a map has no place for.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "drawing.h"
#include "envmap/operate/measure.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/render/renderer.h"
#include "gltf_file.h"
#include "rooms.h"

namespace distort_test {
namespace {

using namespace envmap;

enum class Sides { one, two, both_windings };

SceneGraph with(SceneGraph scene, Sides sides) {
  for (Material& m : scene.materials) m.double_sided = sides == Sides::two;
  if (sides == Sides::both_windings)
    for (Mesh& mesh : scene.meshes) {
      const std::size_t count = mesh.indices.size();
      for (std::size_t k = 0; k < count; k += 3)
        for (const std::size_t corner : {0, 2, 1}) mesh.indices.push_back(mesh.indices[k + corner]);
    }
  return scene;
}

// A square of 2 x `half` that faces the origin from `at`, `edge` vertices along each side.
SceneGraph plate(const Direction& at, double half, int edge) {
  SceneGraph scene;
  scene.materials.push_back({.base_colour = {0, 0, 0, 1}, .emissive = Colour(1, 0.5F, 0.25F), .double_sided = false});
  scene.nodes.push_back({.name = "plate", .meshes = {0}});
  Mesh mesh;
  const Direction normal = -glm::normalize(at);
  const Direction right =
      glm::normalize(glm::cross(std::abs(normal.y) > 0.9 ? Direction(1, 0, 0) : Direction(0, 1, 0), normal));
  const Direction up = glm::cross(normal, right);
  for (int j = 0; j < edge; ++j)
    for (int i = 0; i < edge; ++i) {
      mesh.positions.emplace_back(at + half * ((2.0 * i / (edge - 1) - 1) * right + (2.0 * j / (edge - 1) - 1) * up));
      mesh.normals.emplace_back(normal);
      mesh.coordinates.emplace_back(0, 0);
    }
  const auto vertex = [&](int i, int j) { return std::uint32_t(j * edge + i); };
  for (int j = 0; j + 1 < edge; ++j)
    for (int i = 0; i + 1 < edge; ++i)
      for (const std::uint32_t k :
           {vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)})
        mesh.indices.push_back(k);
  scene.meshes.push_back(mesh);
  return scene;
}

struct Judged {
  double rms, missing;
};

// Against rays, which know no sides of maps.
Judged judged(const SceneGraph& scene, const Viewpoint& from, DrawMethod method) {
  drawing::context();
  Renderer renderer(scene, nullptr);
  const FrameState shot{scene, pose(scene, 0)};
  const Drawn map = draw(renderer, from, shot, method), truth = raycast(shot, from);
  return {compare(map.radiance.base(), truth.radiance.base()).rms, map.missing_solid_angle};
}

double missing(const SceneGraph& scene, const Viewpoint& from, DrawMethod method) {
  return judged(scene, from, method).missing;
}

// The mean over all directions of what a map shows, in the first channel.
double mean(const SceneGraph& scene, const Viewpoint& from, DrawMethod method) {
  drawing::context();
  Renderer renderer(scene, nullptr);
  return flux(draw(renderer, from, {scene, pose(scene, 0)}, method).radiance.base()).x / (4 * pi);
}

Viewpoint inside(Projection to) {
  return {.to = to, .size = 128, .at = {0.1, -0.2, 0.15}, .axes = rotation(20, 30, 40)};
}

class Distort : public ::testing::TestWithParam<std::tuple<Projection, DrawMethod>> {
 protected:
  [[nodiscard]] Projection to() const { return std::get<0>(GetParam()); }
  [[nodiscard]] DrawMethod method() const { return std::get<1>(GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(All, Distort,
                         ::testing::Combine(::testing::Values(Projection::sphere, Projection::paraboloid,
                                                              Projection::angular),
                                            ::testing::Values(DrawMethod::distort, DrawMethod::tessellate)),
                         [](const auto& p) {
                           return std::string(identifier(std::get<0>(p.param))) + "_" +
                                  std::string(draw_method_names[std::size_t(std::get<1>(p.param))]);
                         });

// A closed room shows its inner sides alone, whether its walls have outer ones or not.
TEST_P(Distort, RoomsWithTwoSidesAreAsRightAsThoseWithOne) {
  for (const int edge : {4, 16, 32}) {
    const Viewpoint from = inside(to());
    const double one = judged(with(rooms::room(edge), Sides::one), from, method()).rms;
    for (const Sides sides : {Sides::two, Sides::both_windings})
      EXPECT_LE(judged(with(rooms::room(edge), sides), from, method()).rms, 1.01 * one + 1e-4) << edge;
    const double most = method() == DrawMethod::tessellate ? 0.01 : edge == 4 ? 0.12 : 0.02;
    EXPECT_LT(one, most) << edge;
  }
}

TEST_P(Distort, PlatesInAnyDirectionPaintNoOther) {
  struct {
    const char* where;
    Direction at;
    double half;
  } const plates[] = {{"before", {0, 0, 1}, 0.6},        {"beside", {1, 0, 0.2}, 0.6},
                      {"behind", {0.02, 0.03, -1}, 0.6}, {"across", {0.5, 0.1, -1}, 0.6},
                      {"huge before", {0.1, 0.1, 1}, 4}, {"huge behind", {0.1, 0.1, -1}, 4}};
  for (const auto& [where, at, half] : plates)
    for (const int edge : {2, 16}) {
      const Viewpoint from{.to = to(), .size = 128};
      const SceneGraph scene = plate(at, half, edge);
      const double one = judged(with(scene, Sides::one), from, method()).rms;
      const Judged two = judged(with(scene, Sides::two), from, method());
      const double truth = mean(with(scene, Sides::two), from, DrawMethod::exact);
      const double seen = mean(with(scene, Sides::two), from, method());
      EXPECT_LE(two.rms, 1.01 * one + 1e-4) << where << ' ' << edge;
      // The plate alone shines, so what is painted beside it would make the map brighter. Straight sides take a tenth.
      EXPECT_LE(seen, 1.1 * truth + 1e-3) << where << ' ' << edge;
      // What is dark is stated.
      if (method() == DrawMethod::tessellate) {
        EXPECT_LE(truth - seen, two.missing / (4 * pi) + 0.01) << where << ' ' << edge;
      }
    }
}

TEST_P(Distort, NearAndFarCutAway) {
  Viewpoint from{.to = to(), .size = 128, .near = 0.01, .far = 1.2};
  const SceneGraph room = with(rooms::room(16), Sides::two);
  // Of a cube of 2 m, what is nearer than 1.2 m: caps of its walls.
  EXPECT_NEAR(mean(room, from, method()), mean(room, from, DrawMethod::exact), 0.02);
  from.near = 1.2, from.far = 10;
  EXPECT_NEAR(mean(room, from, method()), mean(room, from, DrawMethod::exact), 0.02);
}

// Outside faces of a box behind the eye are no one's inside, and must not come round its back.
TEST_P(Distort, BacksAreNotPainted) {
  const Viewpoint from{.to = to(), .size = 128};
  SceneGraph scene = plate({0.02, 0.03, -1}, 0.6, 2);
  for (Mesh& mesh : scene.meshes)
    for (std::size_t k = 0; k < mesh.indices.size(); k += 3) std::swap(mesh.indices[k], mesh.indices[k + 1]);
  EXPECT_EQ(mean(with(scene, Sides::one), from, method()), 0);
}

TEST_P(Distort, ObjectFilesHaveTwoSides) {
  const SceneGraph room = rooms::room(9);
  std::string text;
  std::size_t first = 1;
  for (const Mesh& mesh : room.meshes) {
    for (const glm::vec3& p : mesh.positions) text += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
    for (std::size_t k = 0; k < mesh.indices.size(); k += 3)
      text += fmt::format("f {} {} {}\n", first + mesh.indices[k], first + mesh.indices[k + 1],
                          first + mesh.indices[k + 2]);
    first += mesh.positions.size();
  }
  const std::string path = ::testing::TempDir() + fmt::format("two-sided-{}.obj", ::getpid());
  std::ofstream(path) << text;
  const SceneGraph read = read_scene(path);
  std::filesystem::remove(path);
  drawing::context();
  const Viewpoint from = inside(to());
  Renderer renderer(read, nullptr);
  const FrameState shot{.scene = read, .pose = pose(read, 0), .ambient = Colour(1)};
  const Drawn map = draw(renderer, from, shot, method()), truth = raycast(shot, from);
  EXPECT_LT(compare(map.radiance.base(), truth.radiance.base()).rms, 0.15);
}

TEST_P(Distort, NothingIsDrawnBeyondTheRim) {
  const SceneGraph room = with(rooms::room(4), Sides::two);
  drawing::context();
  Renderer renderer(room, nullptr);
  const Viewpoint from = inside(to());
  const Drawn map = draw(renderer, from, {room, pose(room, 0)}, method());
  std::vector<bool> part_of_map(map.surfaces.size(), false);
  rooms::for_each_texel(from.to, from.size, [&](std::size_t k, const Direction&) { part_of_map[k] = true; });
  for (std::size_t k = 0; k < part_of_map.size(); ++k)
    if (!part_of_map[k]) {
      ASSERT_EQ(rooms::colour_at(map, k), Colour(0)) << k;
    }
}

TEST(DistortMissing, IsTheSolidAngleRoundTheSingularity) {
  const Viewpoint sphere{.to = Projection::sphere, .size = 128}, halves{.to = Projection::paraboloid, .size = 128};
  const SceneGraph behind = with(plate({0.02, 0.03, -1}, 0.6, 2), Sides::two),
                   before = with(plate({0, 0, 1}, 0.6, 2), Sides::two);
  // Two triangles; all of their solid angle, that of a square of 1.2 m seen from 1 m, but for the tilt.
  const double square = 4 * std::atan(0.36 / std::sqrt(1 + 2 * 0.36));
  EXPECT_NEAR(missing(behind, sphere, DrawMethod::distort), square, 0.02);
  // A piece of 64 x 64 and those within epsilon.
  EXPECT_LT(missing(behind, sphere, DrawMethod::tessellate), 0.25 * square);
  EXPECT_EQ(missing(before, sphere, DrawMethod::distort), 0);
  EXPECT_EQ(missing(before, halves, DrawMethod::distort), 0);
  EXPECT_EQ(missing(behind, halves, DrawMethod::distort), 0);
  EXPECT_EQ(missing(behind, sphere, DrawMethod::exact), 0);
  // Beyond the far sphere nothing is missed.
  Viewpoint near = sphere;
  near.far = 0.5;
  EXPECT_EQ(missing(behind, near, DrawMethod::distort), 0);
}

}  // namespace
}  // namespace distort_test

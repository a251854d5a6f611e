// Flat mirrors in pictures, against rays in every pixel.
#include <gtest/gtest.h>

#include <cmath>

#include "drawing.h"
#include "envmap/scenes/render/mirrors.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "rooms.h"

namespace flat_mirror_test {
namespace {

using namespace envmap;
using drawing::context;

constexpr int width = 120, height = 90;

// A plate of 1.4 x 1.2 m about a point, with its front along `normal`, which reflects two thirds.
void add_mirror(SceneGraph& scene, const Direction& at, const Direction& normal, bool double_sided) {
  const Rotation axes = upright_about(normal);
  scene.materials.push_back({.base_colour = glm::vec4(2.0F / 3, 2.0F / 3, 2.0F / 3, 1),
                             .metallic = 1,
                             .roughness = 0,
                             .double_sided = double_sided});
  Mesh mesh{.material = int(scene.materials.size()) - 1};
  for (const auto& [x, y] : {std::pair(-0.7, -0.6), {0.7, -0.6}, {0.7, 0.6}, {-0.7, 0.6}}) {
    mesh.positions.emplace_back(x * axes[0] + y * axes[1]);
    mesh.normals.emplace_back(normal);
    mesh.coordinates.emplace_back(0, 0);
  }
  mesh.indices = {0, 1, 2, 0, 2, 3};
  scene.meshes.push_back(mesh);
  scene.nodes.push_back({.name = "mirror " + std::to_string(scene.nodes.size()),
                         .local = glm::translate(Matrix(1), at),
                         .meshes = {int(scene.meshes.size()) - 1}});
}

void add_ball(SceneGraph& scene, const Direction& at) {
  scene.materials.push_back({.base_colour = {0, 0, 0, 1}, .roughness = 1, .emissive = Colour(0.9F, 0.1F, 0.1F)});
  scene.meshes.push_back(rooms::ball(24, 0.12));
  scene.meshes.back().material = int(scene.materials.size()) - 1;
  scene.nodes.push_back(
      {.name = "ball", .local = glm::translate(Matrix(1), at), .meshes = {int(scene.meshes.size()) - 1}});
}

// Two mirrors that face each other, not quite parallel; one ball between them, one behind each.
SceneGraph facing(bool double_sided = false) {
  SceneGraph scene = rooms::room(2);
  add_mirror(scene, {0, 0, -0.6}, glm::normalize(Direction(0.05, 0.03, 1)), double_sided);
  add_mirror(scene, {0, 0, 0.6}, (double_sided ? -1.0 : 1.0) * glm::normalize(Direction(-0.02, 0.06, -1)),
             double_sided);
  for (const double z : {-0.8, 0.1, 0.8}) add_ball(scene, {-0.2, -0.1, z});
  return scene;
}

Viewpoint camera(bool parallel = false, double shift = 0) {
  const Rotation axes = upright_about(glm::normalize(Direction(0.2, 0.1, 1)));
  return {.size = height,
          .at = {0.15, 0.1, 0.45},
          .axes = axes,
          .far = 2,
          .samples = 1,
          .lens = Lens{width, parallel ? Vec2<double>(0.6, 0.45) : Vec2<double>(0.8, 0.6), shift, parallel}};
}

std::vector<Colour> drawn(const SceneGraph& scene, const Viewpoint& from, int bounces) {
  context();
  const std::vector<Mirror> found = find_mirrors(scene, Projection::paraboloid);
  Renderer renderer(scene, nullptr, nodes_of(found));
  Mirrors mirrors(scene, found);
  FrameState shot{.scene = scene, .pose = pose(scene, 0), .look = {.pictures = bounces}};
  mirrors.update(renderer, shot, {{.at = from.at, .pixel = 0.013}}, {.size = 32, .bounces = 1});
  shot.mirrors = mirrors.maps();
  return draw_picture(renderer, from, shot);
}

// The part of pixels that are off, in %: some at edges are, where OpenGL rounds otherwise than Embree.
double wrong(const SceneGraph& scene, const Viewpoint& from) {
  const std::vector<Colour> picture = drawn(scene, from, 16);
  Viewpoint all = from;
  all.far = 100;
  const auto truth = raycast_picture({.scene = scene, .pose = pose(scene, 0)}, all,
                                     {.mirrors = nodes_of(find_mirrors(scene, Projection::cube))});
  int count = 0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const Colour off = glm::abs(picture[k] - truth[k]);
    count += std::max({off.x, off.y, off.z}) > 0.004F ? 1 : 0;
  }
  return 100.0 * count / double(truth.size());
}

TEST(FlatMirrors, ShowWhatRaysDo) {
  EXPECT_LT(wrong(facing(), camera()), 1.0);
  EXPECT_LT(wrong(facing(true), camera()), 1.0) << "from behind";
  EXPECT_LT(wrong(facing(), camera(false, 0.3)), 1.0) << "one of two eyes";
  EXPECT_LT(wrong(facing(), camera(true)), 1.0) << "parallel rays";
}

// Each picture within a picture is nearer to the truth, and none of them shows the ball behind the mirror.
TEST(FlatMirrors, AreDrawnAsDeepAsIsAsked) {
  const SceneGraph scene = facing();
  const auto truth = raycast_picture({.scene = scene, .pose = pose(scene, 0)}, camera(),
                                     {.mirrors = nodes_of(find_mirrors(scene, Projection::cube)), .far = 100});
  double before = 1e9;
  for (const int bounces : {0, 1, 2, 4}) {
    const auto picture = drawn(scene, camera(), bounces);
    double sum = 0;
    for (std::size_t k = 0; k < truth.size(); ++k)
      sum += glm::dot(Flux(picture[k] - truth[k]), Flux(picture[k] - truth[k]));
    EXPECT_LT(sum, 0.7 * before) << bounces;
    before = sum;
  }
}

}  // namespace
}  // namespace flat_mirror_test

// White things in a white world: whatever is drawn, through whatever maps, in whatever frame, every pixel is white.
#include <gtest/gtest.h>

#include "drawing.h"
#include "envmap/operate/generate.h"
#include "envmap/scenes/render/mirrors.h"
#include "envmap/scenes/render/shading/shading.h"
#include "rooms.h"

namespace furnace_test {
namespace {

using namespace envmap;

const Environment& white() {
  static const Environment sky(generate(Constant{Direction(1)}, Projection::cube, 16), 8);
  return sky;
}

struct Ball {
  Direction centre;
  Material material;
};

SceneGraph scene_of(const std::vector<Ball>& balls) {
  SceneGraph scene;
  for (const Ball& ball : balls) {
    const auto k = int(scene.nodes.size());
    scene.materials.push_back(ball.material);
    scene.meshes.push_back(rooms::ball(24, 0.6));
    scene.meshes.back().material = k;
    scene.nodes.push_back({.name = std::to_string(k), .local = glm::translate(Matrix(1), ball.centre), .meshes = {k}});
  }
  return scene;
}

constexpr int width = 160, height = 120;
constexpr double up = 0.4, across = up * width / height;

Viewpoint looking(const Direction& from, const Direction& towards) {
  const Direction back = glm::normalize(from - towards), right = glm::normalize(glm::cross(Direction(0, 1, 0), back));
  return {.size = height,
          .at = from,
          .axes = {right, glm::cross(back, right), back},
          .lens = Lens{width, {across, up}, 0}};
}

Viewer viewer(const Viewpoint& from) {
  Viewer v{.at = from.at, .pixel = 2 * up / height};
  for (const Direction& inwards : {Direction(1, 0, -across), {-1, 0, -across}, {0, 1, -up}, {0, -1, -up}, {0, 0, -1}}) {
    const Direction n = glm::normalize(from.axes * inwards);
    v.planes.emplace_back(n, 1e-3 - glm::dot(n, from.at));
  }
  return v;
}

// Pixels that are not white, in each of the frames of a camera that moves past the balls.
std::vector<int> dark_pixels(const SceneGraph& scene, Projection maps, std::optional<int> bounces, bool ambient) {
  drawing::context();
  const std::vector<Mirror> mirrors = find_mirrors(scene, maps);
  std::vector<int> nodes, dark;
  for (const Mirror& m : mirrors) nodes.push_back(m.node);
  Renderer renderer(scene, ambient ? nullptr : &white(), nodes);
  Mirrors drawn(scene, mirrors);
  for (int frame = 0; frame <= 12; ++frame) {
    const double t = frame / 12.0;
    const Viewpoint from = looking(glm::mix(Direction(-1, 0, 6), Direction(1.7, 0.5, 4), t), Direction(0));
    FrameState shot{.scene = scene, .pose = pose(scene, 0), .environment = ambient ? nullptr : &white()};
    if (ambient) shot.ambient = Colour(1);
    drawn.update(renderer, shot, {viewer(from)}, {.bounces = bounces});
    shot.mirrors = drawn.maps();
    Viewpoint bright = from;
    bright.show_ambient = true;
    const std::vector<Colour> picture = draw_picture(renderer, bright, shot);
    dark.push_back(int(std::ranges::count_if(picture, [](const Colour& c) {
      return std::abs(c.x - 1) > 5e-3 || std::abs(c.y - 1) > 5e-3 || std::abs(c.z - 1) > 5e-3;
    })));
  }
  return dark;
}

const Material mirror{.metallic = 1, .roughness = 0}, glass{.roughness = 0, .transmission = 1},
    rough{.roughness = 0.7F};

class Furnace : public ::testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(Maps, Furnace, ::testing::Values(Projection::sphere, Projection::paraboloid, Projection::cube),
                         [](const auto& p) { return identifier(p.param); });

TEST_P(Furnace, ACameraMovesPastTwoMirrors) {
  const SceneGraph scene = scene_of({{{-0.8, 0, 0}, mirror}, {{0.8, 0.1, 0.3}, mirror}});
  for (const std::optional<int> bounces : {std::optional<int>(1), std::optional<int>(2), std::optional<int>()})
    EXPECT_EQ(dark_pixels(scene, GetParam(), bounces, false), std::vector<int>(13, 0)) << bounces.value_or(0);
}

TEST_P(Furnace, ACameraMovesPastMirrorsGlassAndPlaster) {
  const SceneGraph scene =
      scene_of({{{-0.8, 0, 0}, mirror}, {{0.8, 0.1, 0.3}, glass}, {{0, 0.2, -1.3}, rough}, {{0.1, -1.1, 0}, mirror}});
  for (const bool ambient : {false, true})
    EXPECT_EQ(dark_pixels(scene, GetParam(), 1, ambient), std::vector<int>(13, 0)) << ambient;
}

}  // namespace
}  // namespace furnace_test

// Orthographic cameras: what OpenGL draws against rays, and both against a closed form.
#include <gtest/gtest.h>

#include "drawing.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/render/renderer.h"
#include "small_scenes.h"

namespace orthographic_test {
namespace {

using namespace envmap;

double difference(const Colour& a, const Colour& b) {
  const Colour off = glm::abs(a - b);
  return std::max(off.x, std::max(off.y, off.z));
}

// The wall at z = -1 shines with (p + 1) / 2; the picture is 1.6 by 1.2 metres of it, its middle at (0.1, 0.05).
TEST(Orthographic, AWallIsSeenWithoutPerspective) {
  const SceneGraph scene = rooms::room(2);
  const FrameState shot{.scene = scene, .pose = pose(scene, 0)};
  drawing::context();
  Renderer renderer(scene, nullptr);
  for (const int samples : {1, 4}) {
    const Viewpoint from{
        .size = 48, .at = {0.1, 0.05, 0.7}, .far = 10, .samples = samples, .lens = Lens{64, {0.8, 0.6}, 0, true}};
    for (const auto& picture : {draw_picture(renderer, from, shot), raycast_picture(shot, from, {})})
      for (int k = 0; k < 48 * 64; ++k) {
        const double x = 0.1 + 0.8 * ((k % 64 + 0.5) / 32 - 1), y = 0.05 + 0.6 * (1 - (k / 64 + 0.5) / 24);
        EXPECT_LT(difference(picture[std::size_t(k)], Colour(0.5 * (x + 1), 0.5 * (y + 1), 0)), 0.005) << k;
      }
  }
}

// Masked, curved and shaded things, from above.
TEST(Orthographic, ThingsAreDrawnAsRaysSeeThem) {
  SceneGraph scene = small_scenes::still_life();
  small_scenes::add(scene, {.kind = PunctualLight::Kind::directional, .intensity = Colour(3)}, {0, 0, 0},
                    {0.5, -1, -0.4});
  const FrameState shot{.scene = scene, .pose = pose(scene, 0), .ambient = Colour(0.2F)};
  const View view = looking_at({.at = {0.8, 2.6, 3.2}}, {0, 0.2, 0});
  const Viewpoint from{.size = 96, .at = view.at, .axes = view.axes, .far = 8, .lens = Lens{96, {1.6, 1.6}, 0, true}};
  drawing::context();
  Renderer renderer(scene, nullptr);
  const auto map = draw_picture(renderer, from, shot), truth = raycast_picture(shot, from, {});
  int others = 0, lit = 0;
  for (std::size_t k = 0; k < map.size(); ++k) {
    lit += truth[k] != Colour(0);
    others += difference(map[k], truth[k]) > 0.01;
  }
  EXPECT_GT(lit, 3000);
  EXPECT_LT(others, 90);  // Outlines of things and shadows.
}

}  // namespace
}  // namespace orthographic_test

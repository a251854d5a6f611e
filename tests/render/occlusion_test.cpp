// What things keep of the environment from each other: what OpenGL draws against rays, and both against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "drawing.h"
#include "envmap/operate/generate.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/render/renderer.h"
#include "small_scenes.h"

namespace occlusion_test {
namespace {

using namespace envmap;
using namespace small_scenes;

const Environment& white() {
  static const Environment sky(generate(Constant{Direction(1)}, Projection::cube, 16), 8);
  return sky;
}
const Environment& clear() {
  static const Environment sky(generate(Sky{}, Projection::latlong, 64), 8);
  return sky;
}

// Radiance of each pixel, in a scene that keeps to itself what it does.
struct Pictures {
  std::vector<Colour> drawn, cast;
};
Pictures pictures(const SceneGraph& scene, const Environment* sky, std::span<const DistantLight> distant,
                  Colour ambient = Colour(0)) {
  drawing::context();
  Renderer renderer(scene, sky);
  const FrameState shot{
      .scene = scene, .pose = pose(scene, 0), .environment = sky, .ambient = ambient, .distant = distant};
  return {draw_picture(renderer, camera(), shot), raycast_picture(shot, camera(), {})};
}

// ---- the lights -----------------------------------------------------------------------------------------------------

TEST(DistantLights, ShareOutTheFlux) {
  for (const int count : {1, 2, 7, 64, 256}) {
    Flux sum(0);
    const std::vector<DistantLight> lights = distant_lights(white().map, count);
    EXPECT_EQ(lights.size(), std::size_t(count));
    for (const DistantLight& light : lights) {
      EXPECT_NEAR(glm::length(light.from), 1, 1e-9);
      sum += Flux(light.irradiance);
    }
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(sum[k], 4 * pi, 1e-3);
  }
  const Environment black(generate(Constant{Direction(0)}, Projection::cube, 4), 4);
  EXPECT_TRUE(distant_lights(black.map, 16).empty());
}

// The mean of cosines round a direction is that of the environment: E = pi where all is 1.
TEST(DistantLights, GiveItsIrradiance) {
  const std::vector<DistantLight> lights = distant_lights(white().map, 256);
  for (const Direction n : {Direction(0, 1, 0), {0, -1, 0}, {0.6, 0, 0.8}, {0, 0.6, -0.8}}) {
    double sum = 0;
    for (const DistantLight& light : lights) sum += light.irradiance.x * std::max(0.0, glm::dot(n, light.from));
    EXPECT_NEAR(sum / pi, 1, 0.02);
  }
}

TEST(DistantLights, StandWhereASunDoes) {
  const Direction towards = glm::normalize(Direction(1, 2, 3));
  const Environment sun(generate(Sun{.towards = towards,
                                     .radius_degrees = 3,
                                     .radiance = Direction(1000),
                                     .sky = {Rgb<double>(0), Rgb<double>(0)}},
                                 Projection::cube, 128),
                        8);
  double near = 0, all = 0;
  for (const DistantLight& light : distant_lights(sun.map, 32)) {
    all += light.irradiance.y;
    if (angle_between(light.from, towards) < 0.08) near += light.irradiance.y;
  }
  EXPECT_GT(near / all, 0.95);
}

// ---- against closed forms -------------------------------------------------------------------------------------------

// A floor in a white world, under a ball: what the ball covers of the sky, weighted by cosines, is (r/d)^2 cos(angle)
// where all of it is above the horizon (Nusselt's analog).
TEST(Occlusion, UnderABallIsItsFormFactor) {
  const Direction centre(0.2, 0.7, 0);
  constexpr double radius = 0.5;
  SceneGraph scene;
  add(scene, square(2), plaster);
  add(scene, rooms::ball(64, radius), plaster, glm::translate(Matrix(1), centre));
  const Viewpoint from = camera();
  for (const int count : {64, 256}) {
    const Pictures both = pictures(scene, &white(), distant_lights(white().map, count));
    for (const auto& picture : {both.drawn, both.cast}) {
      double worst = 0, sum = 0, darkest = 1;
      int pixels = 0;
      for_each_pixel(from, [&](int k, const Direction& ray) {
        const Direction place = from.at - from.at.y / ray.y * ray, off = from.at - centre;
        if (ray.y >= 0 || glm::length(off - glm::dot(off, ray) * ray) < radius * 1.03) return;
        if (std::max(std::abs(place.x), std::abs(place.z)) > 1.98) return;
        const double distance = glm::length(centre - place);
        const double expected = 1 - radius * radius * centre.y / std::pow(distance, 3);
        const double error = std::abs(picture[std::size_t(k)].x - expected);
        worst = std::max(worst, error), sum += error, ++pixels, darkest = std::min(darkest, expected);
      });
      EXPECT_LT(darkest, 0.6);
      EXPECT_LT(worst, count == 64 ? 0.12 : 0.05);
      EXPECT_LT(sum / pixels, count == 64 ? 0.02 : 0.01);
    }
  }
}

SceneGraph closed_box(float half) {
  SceneGraph scene;
  Material walls = plaster;
  walls.double_sided = true;
  const Matrix down = glm::translate(Matrix(1), Direction(0, -half, 0));
  for (int k = 0; k < 4; ++k)
    add(scene, square(half), walls, glm::rotate(Matrix(1), 0.5 * pi * k, Direction(1, 0, 0)) * down);
  for (const int k : {1, 3})
    add(scene, square(half), walls, glm::rotate(Matrix(1), 0.5 * pi * k, Direction(0, 0, 1)) * down);
  return scene;
}

// However near to the edges of its walls: by the nearest texels of shadow maps alone, 99 pixels would be lit.
TEST(Occlusion, NoLightComesIntoAClosedBox) {
  const SceneGraph scene = closed_box(4);
  const Pictures both = pictures(scene, &white(), distant_lights(white().map, 64));
  const auto lit = [](const std::vector<Colour>& picture) {
    return std::ranges::count_if(picture, [](const Colour& c) { return c.y > 1e-6F; });
  };
  EXPECT_EQ(lit(both.cast), 0);
  EXPECT_LE(lit(both.drawn), 8);
}

// The furnace: what is convex and alone keeps nothing from itself, however coarse.
TEST(Occlusion, NothingKeepsLightFromItself) {
  for (const int rings : {6, 64}) {
    SceneGraph scene;
    add(scene, rooms::ball(rings, 0.9), {.roughness = 0.6F});
    const std::vector<DistantLight> distant = distant_lights(clear().map, 64);
    const Pictures with = pictures(scene, &clear(), distant), without = pictures(scene, &clear(), {});
    for (std::size_t k = 0; k < with.drawn.size(); ++k) {
      EXPECT_NEAR(with.drawn[k].y, without.drawn[k].y, 1e-6) << rings << ": " << k;
      EXPECT_NEAR(with.cast[k].y, without.cast[k].y, 1e-6) << rings << ": " << k;
    }
  }
}

// It stands for light that is everywhere, such as what walls of a room give back.
TEST(Occlusion, IsNotOfAmbientLight) {
  const SceneGraph scene = still_life();
  const Pictures with = pictures(scene, nullptr, distant_lights(white().map, 32), Colour(1));
  const Pictures without = pictures(scene, nullptr, {}, Colour(1));
  for (std::size_t k = 0; k < with.cast.size(); ++k) {
    EXPECT_NEAR(with.cast[k].y, without.cast[k].y, 1e-6) << k;
    EXPECT_NEAR(with.drawn[k].y, without.drawn[k].y, 1e-6) << k;
  }
}

// ---- against rays ---------------------------------------------------------------------------------------------------

// Each light's outline is right to a texel; so few of them differ in a pixel,
// and next to none where there are no outlines.
TEST(Occlusion, IsDrawnAsRaysFindIt) {
  const SceneGraph scene = still_life();
  const std::vector<DistantLight> distant = distant_lights(clear().map, 64);
  const Pictures both = pictures(scene, &clear(), distant);
  double sum = 0;
  int far_off = 0;
  for (std::size_t k = 0; k < both.cast.size(); ++k) {
    const double error = std::abs(both.drawn[k].y - both.cast[k].y);
    sum += error;
    far_off += error > 3.0 / 64;
  }
  EXPECT_LT(sum / double(both.cast.size()), 3e-3);
  EXPECT_LT(far_off, int(both.cast.size() / 200));
}

}  // namespace
}  // namespace occlusion_test

// Shadows of punctual lights: what OpenGL draws against rays, and both against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "drawing.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/render/renderer.h"
#include "small_scenes.h"

namespace shadow_test {
namespace {

using namespace envmap;
using namespace small_scenes;
using Kind = PunctualLight::Kind;

using Picture = std::vector<Colour>;

Picture drawn(const SceneGraph& scene, const Viewpoint& from, bool shadows = true) {
  drawing::context();
  Renderer renderer(scene, nullptr);
  return draw_picture(renderer, from, {.scene = scene, .pose = pose(scene, 0), .shadows = shadows});
}
Picture cast(const SceneGraph& scene, const Viewpoint& from, bool shadows = true) {
  return raycast_picture({.scene = scene, .pose = pose(scene, 0), .shadows = shadows}, from, {});
}

bool differ(const Colour& a, const Colour& b) {
  const Flux off = glm::abs(Flux(a) - Flux(b)) / glm::max(Flux(0.1), Flux(b));
  return std::max(off.x, std::max(off.y, off.z)) > 0.01;
}

// ---- against rays ---------------------------------------------------------------------------------------------------

struct Lamp {
  const char* name;
  PunctualLight light;
  Direction at, along;
};
const Lamp lamps[] = {
    {"Point", {.kind = Kind::point, .intensity = Colour(9)}, {-0.8, 2, 0.7}, {0, -1, 0}},
    {"Spot", {.kind = Kind::spot, .intensity = Colour(9), .inner = 0.4, .outer = 0.7}, {-0.8, 2, 0.7}, {0.4, -1, -0.3}},
    {"WideSpot",
     {.kind = Kind::spot, .intensity = Colour(9), .inner = 1, .outer = 1.3},
     {-0.8, 2, 0.7},
     {0.4, -1, -0.3}},
    {"Sun", {.kind = Kind::directional, .intensity = Colour(3)}, {0, 0, 0}, {0.5, -1, -0.4}}};

class ShadowsOf : public ::testing::TestWithParam<Lamp> {};
INSTANTIATE_TEST_SUITE_P(All, ShadowsOf, ::testing::ValuesIn(lamps),
                         [](const auto& p) { return std::string(p.param.name); });

// Pixels that differ lie at an outline: within two pixels, rays see light and shadow, or another surface. A card
// interpolates alpha with 8 bits of fraction: of holes that end at the plate's edge it leaves a hair.
TEST_P(ShadowsOf, AreDrawnWhereRaysFindThem) {
  SceneGraph scene = still_life();
  add(scene, GetParam().light, GetParam().at, GetParam().along);
  const Viewpoint from = camera();
  const Picture map = drawn(scene, from), truth = cast(scene, from), unshaded = cast(scene, from, false);
  int others = 0, dark = 0, inside = 0;
  const auto in_dark = [&](int k) { return differ(truth[k], unshaded[k]); };
  for (int k = 0; k < size * size; ++k) {
    dark += in_dark(k);
    if (!differ(map[k], truth[k])) continue;
    ++others;
    int lit = 0, all = 0;
    for (int j = std::max(0, k / size - 2); j <= std::min(size - 1, k / size + 2); ++j)
      for (int i = std::max(0, k % size - 2); i <= std::min(size - 1, k % size + 2); ++i, ++all)
        lit += !in_dark(j * size + i);
    inside += lit == 0 || lit == all;
    EXPECT_LE(inside, drawing::context().on_processor() ? 0 : 8) << k % size << ' ' << k / size << ": " << map[k].x;
  }
  EXPECT_GT(dark, 200);
  EXPECT_LT(others, size * size / 200);
  const Picture bright = drawn(scene, from, false);
  for (int k = 0; k < size * size; ++k) EXPECT_FALSE(differ(bright[k], unshaded[k])) << k;
}

// ---- against closed forms -------------------------------------------------------------------------------------------

// A point of the floor is dark where the way to the light meets the ball.
TEST_P(ShadowsOf, ABallShadesTheFloorAsASphereDoes) {
  const Direction centre(0.3, 0.6, 0);
  constexpr double radius = 0.4;
  const bool parallel = GetParam().light.kind == Kind::directional;
  SceneGraph scene;
  add(scene, square(2), plaster);
  add(scene, rooms::ball(96, radius), plaster, glm::translate(Matrix(1), centre));
  add(scene, GetParam().light, GetParam().at, GetParam().along);
  const Viewpoint from = camera();
  const Picture unshaded = cast(scene, from, false);
  for (const Picture& picture : {drawn(scene, from), cast(scene, from)}) {
    int dark = 0, lit = 0;
    for_each_pixel(from, [&](int k, const Direction& ray) {
      const Direction place = from.at - from.at.y / ray.y * ray, off = from.at - centre;
      const double seen = glm::length(off - glm::dot(off, ray) * ray);
      if (ray.y >= 0 || seen < radius * 1.02 || std::max(std::abs(place.x), std::abs(place.z)) > 1.98) return;
      const Direction towards = glm::normalize(parallel ? -GetParam().along : GetParam().at - place);
      const Direction way = centre - place;
      const double miss = glm::length(way - glm::dot(way, towards) * towards) / radius;
      if (miss < 0.98 || miss > 1.02) {
        (miss < 1 ? dark : lit) += unshaded[k].x > 1e-3F;
        EXPECT_NEAR(picture[k].x, miss < 1 ? 0 : unshaded[k].x, 1e-4) << k % size << ' ' << k / size;
      }
    });
    EXPECT_GT(dark, 100);
    EXPECT_GT(lit, 1000);
  }
}

// What is convex or concave and alone is lit wherever its normals face the light: no surface shades itself,
// however coarse.
TEST_P(ShadowsOf, NothingShadesItself) {
  for (const int rings : {6, 16, 96}) {
    SceneGraph scene;
    add(scene, rooms::ball(rings, 0.9), plaster);
    add(scene, GetParam().light, GetParam().at, GetParam().along);
    const Viewpoint from = camera();
    const Picture unshaded = cast(scene, from, false);
    for (const Picture& picture : {drawn(scene, from), cast(scene, from)})
      for (int k = 0; k < size * size; ++k)
        EXPECT_FALSE(differ(picture[k], unshaded[k])) << rings << ": " << k % size << ' ' << k / size;
  }
}

TEST(Shadows, ABowlDoesNotShadeItself) {
  SceneGraph scene;
  add(scene, rooms::ball(96, 5), {.roughness = 1, .ior = 1, .double_sided = true});
  add(scene, {.intensity = Colour(30)}, {-0.8, 2, 0.7}, {0, -1, 0});
  const Viewpoint from = camera();
  const Picture unshaded = cast(scene, from, false);
  for (const Picture& picture : {drawn(scene, from), cast(scene, from)})
    for (int k = 0; k < size * size; ++k) EXPECT_FALSE(differ(picture[k], unshaded[k])) << k % size << ' ' << k / size;
}

// A lamp's own mesh round the light lets it out; what is not below the light's node keeps it in.
TEST(Shadows, OfALampAreNotCastByWhatHangsOnIt) {
  for (const bool own : {true, false}) {
    SceneGraph scene;
    add(scene, square(2), plaster);
    add(scene, {.intensity = Colour(9)}, {0, 1.5, 0}, {0, -1, 0});
    add(scene, rooms::ball(16, 0.1), plaster);
    if (own)
      scene.nodes.back().parent = 1;
    else
      scene.nodes.back().local = glm::translate(Matrix(1), Direction(0, 1.5, 0));
    const Viewpoint from = camera();
    for (const Picture& picture : {drawn(scene, from), cast(scene, from)})
      EXPECT_EQ(picture[100 * size + 64].x > 0.1F, own);
  }
}

// Its vertices, colours and shadow are those that it has now; so is what it needs in memory.
TEST(Shadows, OfAMeshThatChangesAreThoseItHasNow) {
  drawing::context();
  SceneGraph scene = still_life();
  add(scene, {.kind = Kind::point, .intensity = Colour(9)}, {-0.8, 2, 0.7}, {0, -1, 0});
  Renderer renderer(scene, nullptr);
  const FrameState shot{.scene = scene, .pose = pose(scene, 0)};
  const Picture before = draw_picture(renderer, camera(), shot);
  Mesh& ball = scene.meshes[1];
  for (glm::vec3& p : ball.positions) p = 0.8F * p + glm::vec3(-0.9F, 0.2F, 0.6F);
  ball.colours.assign(ball.positions.size(), glm::vec4(0.9F, 0.3F, 0.1F, 1));
  renderer.update(scene, 1);
  const Picture after = draw_picture(renderer, camera(), shot);
  EXPECT_EQ(after, drawn(scene, camera()));
  EXPECT_NE(after, before);
}

// A map drawn from inside of a ball, without it, shows the shadow of the ball.
TEST(Shadows, OfWhatIsLeftOutStay) {
  SceneGraph scene;
  add(scene, square(2), plaster);
  add(scene, rooms::ball(32, 0.3), plaster, glm::translate(Matrix(1), Direction(0, 1, 0)));
  add(scene, {.intensity = Colour(9)}, {0, 2, 0}, {0, -1, 0});
  const Viewpoint from{.to = Projection::cube, .size = 33, .at = {0, 1, 0}, .without = 1};
  drawing::context();
  Renderer renderer(scene, nullptr);
  const FrameState shot{.scene = scene, .pose = pose(scene, 0)};
  for (const Drawn& map : {draw(renderer, from, shot, DrawMethod::exact), raycast(shot, from)}) {
    EXPECT_EQ(rooms::colour_at(map, 3 * 33 * 33 + 16 * 33 + 16), Colour(0));
    EXPECT_GT(rooms::colour_at(map, 3 * 33 * 33 + 2 * 33 + 2).x, 0.1F);
  }
}

}  // namespace
}  // namespace shadow_test

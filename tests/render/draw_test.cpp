// Maps by every method against rays through a box in float64, and against raycast().
#include <gtest/gtest.h>

#include <random>

#include "drawing.h"
#include "envmap/scenes/render/choose_drawing.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/render/renderer.h"
#include "envmap/scenes/render/shading/shading.h"
#include "rooms.h"
#include "small_scenes.h"

namespace draw_test {
namespace {

using namespace envmap;
using drawing::context;

Drawn drawn(const SceneGraph& scene, const Viewpoint& from, DrawMethod method) {
  context();
  Renderer renderer(scene, nullptr);
  return draw(renderer, from, {scene, pose(scene, 0)}, method);
}

// Turned, so that no edge of the room runs along texels.
Viewpoint inside(Projection to, int size) {
  return {.to = to, .size = size, .at = {0.1, -0.2, 0.15}, .axes = rotation(20, 30, 40)};
}

class Draw : public ::testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(All, Draw, ::testing::ValuesIn(all_projections),
                         [](const auto& p) { return identifier(p.param); });

TEST_P(Draw, ExactlyWhatRaysMeet) {
  if (!can_draw(DrawMethod::exact, GetParam())) GTEST_SKIP() << "rays and resampling alone";
  for (const int edge : {2, 9}) {
    const Viewpoint from = inside(GetParam(), 512);
    const rooms::Faults faults = rooms::judge(drawn(rooms::room(edge), from, DrawMethod::exact), from);
    EXPECT_EQ(faults.holes, 0);
    EXPECT_LT(faults.surface, 1e-4);
    EXPECT_EQ(faults.distance, 0);
    EXPECT_LT(faults.colour, 0.01);  // Textures of 8 bits.
  }
}

TEST_P(Draw, ResampledWithinATexelOfTheCube) {
  const Viewpoint from = inside(GetParam(), 256);
  const rooms::Faults faults = rooms::judge(drawn(rooms::room(4), from, DrawMethod::resample), from);
  EXPECT_EQ(faults.holes, 0);
  EXPECT_LT(faults.surface, 4e-3);
}

TEST_P(Draw, OnlyTheFacesAskedFor) {
  if (!can_draw(DrawMethod::exact, GetParam())) GTEST_SKIP() << "rays and resampling alone";
  context();
  const SceneGraph scene = rooms::room(2);
  Renderer renderer(scene, nullptr);
  Viewpoint from = inside(GetParam(), 32);
  from.which = 1;
  MapTexture map(from.to, from.size);
  const float untouched[] = {7, 7, 7, 7};
  glClearTexImage(map.texture, 0, GL_RGBA, GL_FLOAT, untouched);
  renderer.draw(from, {scene, pose(scene, 0)}, DrawMethod::exact, map);
  const EnvironmentMap seen = read_back(map);
  EXPECT_NE(*seen.base().texel(0, 16, 16), Colour(7));
  for (int face = 1; face < faces(from.to); ++face) EXPECT_EQ(*seen.base().texel(face, 16, 16), Colour(7));
}

// Large and small, near and far, through the point, round it, and none at all.
SceneGraph extremes() {
  SceneGraph scene;
  scene.materials.push_back({.base_colour = {1, 1, 1, 1}, .double_sided = true});
  scene.nodes.push_back({.name = "all"});
  std::mt19937 random(1);
  const auto anywhere = [&](float size) {
    std::uniform_real_distribution<float> d(-size, size);
    return glm::vec3(d(random), d(random), d(random));
  };
  const auto add = [&](glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    const glm::vec3 n(0, 0, 1);
    scene.nodes[0].meshes.push_back(int(scene.meshes.size()));
    scene.meshes.push_back(
        {.positions = {a, b, c}, .normals = {n, n, n}, .coordinates = {{}, {}, {}}, .indices = {0, 1, 2}});
  };
  add({-1e6F, -1e6F, -30}, {1e6F, -1e6F, -30}, {0, 2e6F, -30});  // All of -Z, and the singularity.
  add({-1e6F, 40, -1e6F}, {1e6F, 40, -1e6F}, {0, 40, 2e6F});     // A ceiling to the horizon.
  add({-1, 0, -1}, {1, 0, -1}, {0, 0, 2});                       // Through the point itself.
  add({1, 1, 1}, {1, 1, 1}, {1, 1, 1});                          // A point,
  add({1, 1, 1}, {2, 2, 2}, {3, 3, 3});                          // a line,
  add({0, 0, 0}, {1, 0, 1}, {0, 1, 1});                          // a corner at the point.
  add({5e-7F, 0, 0.02F}, {-5e-7F, 1e-6F, 0.02F}, {-5e-7F, -1e-6F, 0.02F});
  for (int k = 0; k < 60; ++k) {
    const glm::vec3 at = anywhere(8);
    add(at, at + anywhere(3), at + anywhere(3));
  }
  for (int k = 0; k < 20; ++k) {
    const glm::vec3 at = anywhere(0.1F);
    add(at, at + anywhere(1e-2F), at + anywhere(2));
  }
  return scene;
}

TEST_P(Draw, AsRaycastOfExtremeTriangles) {
  if (!can_draw(DrawMethod::exact, GetParam())) GTEST_SKIP() << "rays and resampling alone";
  const SceneGraph scene = extremes();
  const Viewpoint from{.to = GetParam(), .size = 256, .far = 1e7};
  const Drawn map = drawn(scene, from, DrawMethod::exact), truth = raycast({scene, pose(scene, 0)}, from);
  std::size_t texels = 0, others = 0, holes = 0;
  rooms::for_each_texel(from.to, from.size, [&](std::size_t k, const Direction&) {
    ++texels;
    if (map.surfaces[k] != truth.surfaces[k])
      ++(map.surfaces[k] == 0 ? holes : others);
    else if (truth.surfaces[k] != 0 && !(std::abs(map.distances[k] - truth.distances[k]) <= 1e-3F * truth.distances[k]))
      ++others;
  });
  EXPECT_LE(double(others + holes), 2e-4 * double(texels)) << holes << " holes";
}

TEST(DrawMethods, DistortedFineTrianglesAreNearlyRight) {
  const Viewpoint from = inside(Projection::paraboloid, 256);
  const SceneGraph fine = rooms::room(40), coarse = rooms::room(2);
  EXPECT_LT(rooms::judge(drawn(fine, from, DrawMethod::distort), from).surface, 1e-3);
  EXPECT_GT(rooms::judge(drawn(coarse, from, DrawMethod::distort), from).surface, 1e-2);
}

TEST(DrawMethods, TessellationBendsSides) {
  const Viewpoint from = inside(Projection::paraboloid, 256);
  for (const int edge : {2, 30}) {
    const rooms::Faults faults = rooms::judge(drawn(rooms::room(edge), from, DrawMethod::tessellate), from);
    EXPECT_LT(faults.surface, 3e-3) << edge;
    EXPECT_LT(faults.distance, 1e-3) << edge;
  }
}

// The room is its own mirror image, and so is what the middle of it sees.
TEST(DrawMethods, Symmetry) {
  const Viewpoint from{.to = Projection::sphere, .size = 128};
  const Drawn map = drawn(rooms::room(3), from, DrawMethod::exact);
  for (std::size_t row = 0; row < 128; ++row)
    for (std::size_t k = 0; k < 64; ++k) {
      const float left = map.distances[128 * row + k], right = map.distances[128 * row + 127 - k];
      if (std::isfinite(left) || std::isfinite(right)) {
        ASSERT_NEAR(left, right, 1e-5F * left) << k << ", " << row;
      }
    }
}

// Each sample is found in its own place, not at the centre of its texel.
TEST_P(Draw, SamplesAreAMean) {
  if (!can_draw(DrawMethod::exact, GetParam())) GTEST_SKIP() << "rays and resampling alone";
  Viewpoint from = inside(GetParam(), 16);
  from.samples = 16;
  SceneGraph scene = rooms::room(2);
  for (std::size_t wall = 0; wall < 6; ++wall)  // One colour each: textures are filtered, which raycast() does not do.
    scene.materials[wall] = {.emissive = Colour(wall & 1, wall >> 1 & 1, wall >> 2), .double_sided = true};
  const Drawn map = drawn(scene, from, DrawMethod::exact), truth = raycast({scene, pose(scene, 0)}, from);
  double worst = 0;
  rooms::for_each_texel(from.to, from.size, [&](std::size_t k, const Direction&) {
    worst = std::max(worst, double(glm::length(rooms::colour_at(map, k) - rooms::colour_at(truth, k))));
  });
  EXPECT_LT(worst, 0.01);
}

TEST(DrawMethods, ANodeIsLeftOut) {
  const SceneGraph scene = rooms::room(2);
  Viewpoint from = inside(Projection::cube, 32);
  from.without = 2;
  const Drawn map = drawn(scene, from, DrawMethod::exact);
  EXPECT_EQ(std::ranges::count(map.surfaces, 3U), 0);
  EXPECT_GT(std::ranges::count(map.surfaces, 0U), 100);
}

// Radiance from a direction comes out in that direction, whatever the projection of the environment.
TEST(DrawMethods, EnvironmentIsTheBackground) {
  context();
  SceneGraph empty;
  for (const Projection p : all_projections) {
    EnvironmentMap coded;
    Level& level = coded.levels.emplace_back(p, 256);
    const int width = level.width();
    rooms::for_each_texel(p, 256, [&](std::size_t k, const Direction& ray) {
      const auto at = int(k);
      *level.texel(at / (width * 256), at % width, at / width % 256) = Colour(0.5 * (ray + 1.0));
    });
    const Environment sky(std::move(coded), 4);
    Renderer renderer(empty, &sky);
    const Viewpoint from{.to = Projection::paraboloid, .size = 64, .axes = rotation(10, 20, 30)};
    const Drawn map = draw(renderer, from, {empty, {}, &sky}, DrawMethod::exact);
    double worst = 0;
    rooms::for_each_texel(from.to, from.size, [&](std::size_t k, const Direction& ray) {
      const Colour wanted(0.5 * (from.axes * ray + 1.0));
      worst = std::max(worst, double(glm::length(rooms::colour_at(map, k) - wanted)));
    });
    EXPECT_LT(worst, p == Projection::sphere ? 0.02 : 0.01) << name(p);  // A sphere map becomes a cube of 64.
  }
}

// A card, and OSMesa too, draws triangles faster than the processor builds their tree.
TEST(DrawMethods, FollowTheMeasuredTimes) {
  EXPECT_EQ(cheapest(Projection::sphere, 512, {.triangles = 12}), DrawMethod::exact);
  EXPECT_EQ(cheapest(Projection::sphere, 64, {.triangles = 12}), DrawMethod::exact);
  EXPECT_EQ(cheapest(Projection::sphere, 512, {.triangles = 1'000'000}), DrawMethod::exact);
  EXPECT_EQ(cheapest(Projection::sphere, 512, {.triangles = 1'000'000}, true, true), DrawMethod::exact);
  EXPECT_EQ(cheapest(Projection::cube, 512, {.triangles = 1'000'000}, true, true), DrawMethod::resample);
  EXPECT_EQ(cheapest(Projection::octahedral, 64, {.triangles = 1'000'000}, true, true), DrawMethod::resample);
  EXPECT_EQ(cheapest(Projection::octahedral, 1024, {.triangles = 1'000'000}, true, true), DrawMethod::raycast);
}

TEST(DrawMethods, ShadowMapsOfTheProcessorCostMoreThanRaysOfASmallMap) {
  SceneGraph scene = small_scenes::still_life();
  small_scenes::add(scene, {.kind = PunctualLight::Kind::point, .intensity = Colour(9)}, {-0.8, 2, 0.7}, {0, -1, 0});
  FrameState shot{.scene = scene, .pose = pose(scene, 0)};
  const DrawLoad lamp = draw_load(shot);
  EXPECT_EQ(lamp.lights, 1);
  EXPECT_EQ(lamp.shadow_texels, 6 * 1024 * 1024);
  EXPECT_EQ(cheapest(Projection::cube, 64, lamp), DrawMethod::raycast);
  EXPECT_EQ(cheapest(Projection::cube, 512, lamp, true, true), DrawMethod::resample) << "on a card";
  EXPECT_EQ(cheapest(Projection::cube, 2048, lamp), DrawMethod::resample);
  const std::vector<DistantLight> sky(64);
  shot.distant = sky;
  EXPECT_EQ(draw_load(shot).lights, 65);
  EXPECT_EQ(draw_load(shot).shadow_texels, (6 * 1024 + 64 * 512 / 2) * 1024);
  shot.shadows = false;
  EXPECT_EQ(draw_load(shot).lights, 64);
}

}  // namespace
}  // namespace draw_test

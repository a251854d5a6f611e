// Blended surfaces: what OpenGL draws layer by layer, and rays that go on,
// against the sum of what lies behind each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "drawing.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/render/renderer.h"
#include "small_scenes.h"

namespace blend_test {
namespace {

using namespace envmap;

// A plane that shines, and covers a part of what is behind it.
struct Card {
  Direction normal, place;
  Colour colour;
  float alpha;
};
// Some pass through each other, and they do not stand in any order.
const Card cards[] = {{{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, 0.5F},
                      {{0.6, 0, 0.8}, {0, 0, 0}, {0, 1, 0}, 0.25F},
                      {{-0.6, 0, 0.8}, {0, 0, 0}, {0, 0, 1}, 0.75F},
                      {{0, 0.6, 0.8}, {0, 0, -0.5}, {1, 1, 0}, 0.4F}};

Material shining(const Card& card) {
  return {.base_colour = {0, 0, 0, card.alpha},
          .roughness = 1,
          .emissive = card.colour,
          .ior = 1,
          .blended = true,
          .double_sided = true};
}

SceneGraph stack() {
  SceneGraph scene;
  for (const Card& card : cards) {
    const Direction across = glm::normalize(glm::cross(card.normal, Direction(0.3, 0.8, 0.1)));
    Matrix local(1);
    local[0] = {across, 0}, local[1] = {card.normal, 0}, local[2] = {glm::cross(across, card.normal), 0};
    local[3] = {card.place, 1};
    small_scenes::add(scene, small_scenes::square(40), shining(card), local);
  }
  return scene;
}

// Porter and Duff 1984: each over what is behind it.
Colour expected(const Direction& from, const Direction& ray) {
  std::vector<std::pair<double, const Card*>> met;
  for (const Card& card : cards)
    if (const double t = glm::dot(card.normal, card.place - from) / glm::dot(card.normal, ray); t > 0)
      met.emplace_back(t, &card);
  std::ranges::sort(met, std::ranges::greater());
  Colour sum(0);
  for (const auto& [t, card] : met) sum = glm::mix(sum, card->colour, card->alpha);
  return sum;
}

double difference(const Colour& a, const Colour& b) {
  const Colour off = glm::abs(a - b);
  return std::max(off.x, std::max(off.y, off.z));
}

Viewpoint camera(int samples) {
  return {.size = 48, .at = {0.2, 0.3, 4}, .samples = samples, .lens = Lens{48, {0.5, 0.5}, 0}};
}

// But beside the lines where cards pass through each other.
TEST(Blended, PicturesAreTheSumOfLayers) {
  const SceneGraph scene = stack();
  const FrameState shot{.scene = scene, .pose = pose(scene, 0)};
  drawing::context();
  Renderer renderer(scene, nullptr);
  for (const int samples : {1, 4}) {
    const Viewpoint from = camera(samples);
    for (const auto& picture : {draw_picture(renderer, from, shot), raycast_picture(shot, from, {})}) {
      int others = 0;
      for (int k = 0; k < 48 * 48; ++k) {
        Colour mean(0);
        for (int s = 0; s < samples; ++s) {
          const Vec2<double> off = 0.5 + sample_offset(s, samples);
          mean += expected(from.at, from.lens->ray((k % 48 + off.x) / 48, (k / 48 + off.y) / 48)) / float(samples);
        }
        others += difference(picture[std::size_t(k)], mean) > 1e-4;
      }
      EXPECT_LE(others, 8 * samples) << samples;
    }
  }
}

TEST(Blended, MapsAreTheSumOfLayersByAllMethods) {
  const SceneGraph scene = stack();
  const FrameState shot{.scene = scene, .pose = pose(scene, 0)};
  drawing::context();
  Renderer renderer(scene, nullptr);
  for (const DrawMethod method : {DrawMethod::exact, DrawMethod::distort, DrawMethod::raycast}) {
    const Viewpoint from{.to = Projection::cube, .size = 32, .at = {0.2, 0.3, 4}};
    const Drawn map = method == DrawMethod::raycast ? raycast(shot, from) : draw(renderer, from, shot, method);
    int others = 0, seen = 0;
    rooms::for_each_texel(from.to, from.size, [&](std::size_t k, const Direction& ray) {
      if (ray.z > -0.75) return;  // Where the cards do not end.
      ++seen;
      others += difference(rooms::colour_at(map, k), expected(from.at, ray)) > 1e-4;
      EXPECT_EQ(map.surfaces[k], 0U);  // Nothing that covers all.
    });
    EXPECT_GT(seen, 500);
    EXPECT_LE(others, 6) << int(method);
  }
}

// The furnace: half of a white ball, before and behind, over white is white.
TEST(Blended, WhiteInWhiteIsNotSeen) {
  static const Environment white([] {
    EnvironmentMap map;
    map.levels.emplace_back(Projection::cube, 1);
    for (int face = 0; face < 6; ++face) *map.base().texel(face, 0, 0) = Colour(1);
    return map;
  }());
  SceneGraph scene;
  small_scenes::add(scene, rooms::ball(24, 1),
                    {.base_colour = {1, 1, 1, 0.5F}, .roughness = 0.6F, .blended = true, .double_sided = true});
  const FrameState shot{.scene = scene, .pose = pose(scene, 0), .environment = &white};
  drawing::context();
  Renderer renderer(scene, &white);
  for (const auto& picture : {draw_picture(renderer, camera(1), shot), raycast_picture(shot, camera(1), {})})
    for (const Colour& c : picture) EXPECT_LT(difference(c, Colour(1)), 5e-3);
}

// Light passes or it does not: what covers more than half casts a shadow.
TEST(Blended, CardsCastShadowsWhereTheyCoverHalf) {
  for (const float alpha : {0.4F, 0.6F}) {
    SceneGraph scene;
    small_scenes::add(scene, small_scenes::square(2), small_scenes::plaster);
    Material card{.base_colour = {1, 1, 1, alpha}, .alpha_cutoff = 0.5F, .blended = true, .double_sided = true};
    small_scenes::add(scene, small_scenes::square(0.4F), card, glm::translate(Matrix(1), Direction(0.6, 1, 0)));
    small_scenes::add(scene, {.kind = PunctualLight::Kind::directional, .intensity = Colour(3)}, {0, 0, 0},
                      {-0.6, -1, 0});
    const FrameState shot{.scene = scene, .pose = pose(scene, 0)};
    const View view = looking_at({.at = {-1, 2, 2}}, Direction(0));  // Past the card.
    const Viewpoint from{.size = 1, .at = view.at, .axes = view.axes, .lens = Lens{1, {0.01, 0.01}, 0}};
    drawing::context();
    Renderer renderer(scene, nullptr);
    const bool is_dark = alpha > 0.5F;
    EXPECT_EQ(draw_picture(renderer, from, shot)[0] == Colour(0), is_dark) << alpha;
    EXPECT_EQ(raycast_picture(shot, from, {})[0] == Colour(0), is_dark) << alpha;
  }
}

}  // namespace
}  // namespace blend_test

// Suns as lights: against closed forms, and against rays to the map that they come from.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "drawing.h"
#include "envmap/operate/generate.h"
#include "envmap/scenes/render/rays/lobe_integral.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/render/renderer.h"
#include "envmap/scenes/render/shading/prepared_environment.h"
#include "envmap/scenes/render/shading/sampled_reflection.h"
#include "small_scenes.h"

namespace suns_test {
namespace {

using namespace envmap;
using namespace small_scenes;

constexpr double degree = pi / 180;
EnvironmentMap sunny(const Direction& towards, double radius_degrees, double sky, double radiance = 1000) {
  return generate(Sun{.towards = towards,
                      .radius_degrees = radius_degrees,
                      .radiance = Direction(radiance),
                      .sky = {Rgb<double>(sky), Rgb<double>(sky)}},
                  Projection::latlong, 512);
}

// A map as it is, and the same with suns as lights.
struct Lit {
  std::shared_ptr<const Environment> texels, lights;
  std::vector<DistantLight> of_texels, of_lights;

  Lit(const EnvironmentMap& map, const SceneGraph& scene, int distant = 0,
      Reflection reflection = Reflection::split_sum) {
    const PreparedEnvironment as_it_is(map.clone()), with_suns(map.clone(), {}, find_lights(map));
    const std::vector<float> roughnesses = glossy_roughnesses(scene);
    texels = as_it_is.light(roughnesses, reflection, {}), lights = with_suns.light(roughnesses, reflection, {});
    if (distant > 0) of_texels = as_it_is.distant(distant, {}), of_lights = with_suns.distant(distant, {});
  }
  [[nodiscard]] FrameState with_texels(const SceneGraph& scene) const {
    return {.scene = scene, .pose = pose(scene, 0), .environment = texels.get(), .distant = of_texels};
  }
  [[nodiscard]] FrameState with_lights(const SceneGraph& scene) const {
    return {.scene = scene, .pose = pose(scene, 0), .environment = lights.get(), .distant = of_lights};
  }
};

std::vector<Colour> drawn(const FrameState& shot, const Viewpoint& from) {
  drawing::context();
  Renderer renderer(shot.scene, shot.environment);
  return draw_picture(renderer, from, shot);
}

// A floor below a plate that ends above x = 0.
SceneGraph knife_edge(double height) {
  SceneGraph scene;
  add(scene, square(4), plaster);
  add(scene, square(1), plaster, glm::translate(Matrix(1), Direction(-1, height, 0)));
  return scene;
}

// Calls f(pixel, place on the floor) where the plate is not in the way, well inside of its ends.
void for_each_place(const Viewpoint& from, double height, auto&& f) {
  for_each_pixel(from, [&](int k, const Direction& ray) {
    if (ray.y >= 0) return;
    const Direction place = from.at - from.at.y / ray.y * ray, above = from.at + (height - from.at.y) / ray.y * ray;
    const bool hidden = above.x < 0.05 && above.x > -2.05 && std::abs(above.z) < 1.05;
    if (!hidden && std::abs(place.z) < 0.7 && place.x > -1.7 && place.x < 3.9) f(k, place);
  });
}

// The part of a unit disc beyond a line at a distance from its middle, -1 to 1.
double segment(double distance) {
  const double d = std::clamp(distance, -1.0, 1.0);
  return (std::acos(d) - d * std::sqrt(1 - d * d)) / pi;
}

// Under a sun in the zenith a place at x sees the plate's edge at the angle x / height: what is beyond it is lit.
TEST(Suns, CastHalfShadowsAsWideAsTheirDisc) {
  constexpr double height = 1, radius = 4;
  const SceneGraph scene = knife_edge(height);
  const Lit lit(sunny({0, 1, 0}, radius, 0), scene);
  ASSERT_EQ(lit.lights->light.suns.size(), 1);
  const Viewpoint from = camera();
  const double sine = std::sin(radius * degree), unshaded = 1000 * sine * sine;
  for (const bool by_rays : {true, false}) {
    const FrameState shot = lit.with_lights(scene);
    const std::vector<Colour> picture = by_rays ? raycast_picture(shot, from, {}) : drawn(shot, from);
    int umbra = 0, half = 0, full = 0;
    for_each_place(from, height, [&](int k, const Direction& place) {
      const double offset = std::atan(place.x / height) / (radius * degree);
      // Within a pixel, and within a step: 1 of 64 or 16 lights, which are not quite even along any line.
      const double expected = segment(-offset), step = std::abs(offset) < 1.1 ? (by_rays ? 0.05 : 0.12) : 1e-3;
      EXPECT_NEAR(picture[std::size_t(k)].y / unshaded, expected, step) << by_rays << ' ' << place.x;
      ++(offset < -1.1 ? umbra : offset > 1.1 ? full : half);
    });
    EXPECT_GT(umbra, 300);
    EXPECT_GT(half, 80);
    EXPECT_GT(full, 300);
  }
}

// In the umbra and where all is lit, rays to the map itself see the same: by 256 lights for its shadows, which put all
// of the sun's into one place, and by an integral for its light, within 5% of it.
TEST(Suns, LightAsTheirTexelsDidOutsideOfHalfShadows) {
  constexpr double height = 1;
  const SceneGraph scene = knife_edge(height);
  const Direction towards = glm::normalize(Direction(0.3, 1, 0.1));
  const EnvironmentMap map = sunny(towards, 1, 1, 4000);
  const Lit lit(map, scene, 256);
  const Viewpoint from = camera();
  const std::vector<Colour> truth = raycast_picture(lit.with_texels(scene), from, {.lobe_samples = 1024});
  for (const bool by_rays : {true, false}) {
    const FrameState shot = lit.with_lights(scene);
    const std::vector<Colour> picture = by_rays ? raycast_picture(shot, from, {}) : drawn(shot, from);
    int umbra = 0, full = 0;
    for_each_place(from, height, [&](int k, const Direction& place) {
      const Direction at_plate = place + height / towards.y * towards;
      if (std::abs(at_plate.x) < 0.04 || std::abs(at_plate.z) > 0.9) return;
      const bool shaded = at_plate.x < 0;
      const double seen = picture[std::size_t(k)].y, expected = truth[std::size_t(k)].y;
      // The sky's own shadow is by 256 lights of it in one, and by fewer of them beside the sun in the other.
      EXPECT_NEAR(seen, expected, shaded ? 0.12 : 0.05 * expected) << by_rays << ' ' << place.x << ' ' << place.z;
      ++(shaded ? umbra : full);
    });
    EXPECT_GT(umbra, 300);
    EXPECT_GT(full, 300);
  }
}

// Surfaces without shadows: the integral over the map, sun and all, against a light and the rest.
TEST(Suns, LightEveryMaterialAsTheIntegralDoes) {
  const Direction towards = glm::normalize(Direction(0.4, 0.3, 1));
  const EnvironmentMap map = sunny(towards, 1, 1);
  SceneGraph scene;
  for (const float roughness : {0.3F, 0.5F, 0.8F}) scene.materials.push_back({.roughness = roughness});
  for (const Material& m : scene.materials) add(scene, square(1), m);
  const Lit lit(map, scene, 0, Reflection::sampled);
  const LobeIntegral integral(map, lit.texels->lookup, 1 << 14);
  Lighting reference{{}, lit.texels.get(), Colour(0)};
  reference.integral = &integral;
  const Lighting lights = lighting(lit.with_lights(scene));
  for (const float metallic : {0.0F, 1.0F})
    for (const float roughness : {0.3F, 0.5F, 0.8F})
      for (const float coat : {0.0F, 1.0F})
        for (const double angle : {-0.3, 0.2, 0.9}) {
          const ShadingPoint s{.base_colour = glm::vec4(0.8F, 0.5F, 0.2F, 1),
                               .metallic = metallic,
                               .roughness = roughness,
                               .coat = coat,
                               .coat_roughness = 0.5F};
          const Direction v(std::sin(angle), 0, std::cos(angle));
          const Colour a = shade(s, v, lights), b = shade(s, v, reference);
          for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(a[c] / b[c], 1, 0.03) << metallic << ' ' << roughness << ' ' << coat << ' ' << angle;
        }
}

// Through rough glass the light is the lobe's, as prefiltered levels of the whole map have it.
TEST(Suns, ShineThroughRoughGlass) {
  const EnvironmentMap map = sunny({0.1, 0.2, -1}, 1, 0.5);
  SceneGraph scene;
  add(scene, square(1), {.roughness = 0.5F, .transmission = 1, .ior = 1});
  const Lit lit(map, scene);
  const Lighting texels{{}, lit.texels.get(), Colour(0)}, lights = lighting(lit.with_lights(scene));
  for (const double angle : {0.0, 0.3, 0.8}) {
    const Direction from(std::sin(angle), 0, -std::cos(angle));
    EXPECT_NEAR(transmitted_radiance(lights, from, 0.5).y / glossy_radiance(texels, from, 0.5).y, 1, 0.02) << angle;
  }
}

// A mirror, clear glass and the sky behind all show the map as it is, and no glint beside it.
TEST(Suns, StayInTheMapForSharpReflections) {
  SceneGraph scene;
  add(scene, rooms::ball(64, 0.5), {.base_colour = {1, 1, 1, 1}, .metallic = 1, .roughness = 0},
      glm::translate(Matrix(1), Direction(-0.6, 0.2, 0)));
  add(scene, rooms::ball(64, 0.5), {.base_colour = {1, 1, 1, 1}, .roughness = 0, .transmission = 1},
      glm::translate(Matrix(1), Direction(0.6, 0.2, 0)));
  const Lit lit(sunny({0.4, 0.5, 0.6}, 4, 1), scene);
  ASSERT_EQ(lit.lights->light.suns.size(), 1);
  const Viewpoint from = camera();
  const RayPaths paths{.mirrors = {0, 1}};
  const auto expect_same = [](const std::vector<Colour>& a, const std::vector<Colour>& b) {
    float brightest = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
      EXPECT_NEAR(a[k].y, b[k].y, 0.03 * b[k].y) << k;  // Glass diffuses a little, by harmonics that ring.
      brightest = std::max(brightest, a[k].y);
    }
    EXPECT_GT(brightest, 100);
  };
  expect_same(raycast_picture(lit.with_lights(scene), from, paths),
              raycast_picture(lit.with_texels(scene), from, paths));
  expect_same(drawn(lit.with_lights(scene), from), drawn(lit.with_texels(scene), from));
}

// Where half shadows are, shadow maps of 16 lights have other steps than 64 rays.
TEST(Suns, AreDrawnAsRaysFindThem) {
  const SceneGraph scene = still_life();
  for (const double radius : {0.5, 3.0}) {
    const Lit lit(sunny({-0.5, 1, 0.4}, radius, 0.2), scene);
    ASSERT_EQ(lit.lights->light.suns.size(), 1);
    const FrameState shot = lit.with_lights(scene);
    const std::vector<Colour> map = drawn(shot, camera()), truth = raycast_picture(shot, camera(), {});
    double error = 0, power = 0;
    for (std::size_t k = 0; k < map.size(); ++k) {
      error += glm::dot(map[k] - truth[k], map[k] - truth[k]);
      power += glm::dot(truth[k], truth[k]);
    }
    EXPECT_LT(std::sqrt(error / power), 0.05) << radius;
  }
}

}  // namespace
}  // namespace suns_test

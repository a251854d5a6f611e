// Every kind of material under every kind of environment: what OpenGL draws against rays,
// and both against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "drawing.h"
#include "envmap/scenes/render/choose_drawing.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/render/renderer.h"
#include "envmap/scenes/render/shading/sampled_reflection.h"
#include "envmap/scenes/render/shading/shading.h"
#include "envmap/scenes/render/shading/sheen_brdf.h"
#include "envmap/scenes/scene/tangents.h"
#include "rooms.h"

namespace materials_test {
namespace {

using namespace envmap;

// ---- what is lit ----------------------------------------------------------------------------------------------------

struct Lit {
  const char* name;
  Material material;
  bool white;  // Reflects and lets through all light: in a white environment it is not seen.
};

// Texture 0 is of colours, 1 of roughness and metalness, 2 has holes, 3 is of normals, 4 of occlusion.
const Lit materials[] = {
    {"WhiteRough", {.roughness = 1}, true},
    {"WhiteDielectric", {.roughness = 0.4F}, true},
    {"WhitePolished", {.roughness = 0}, true},
    {"Coloured", {.base_colour = {0.8F, 0.4F, 0.1F, 1}, .roughness = 0.7F}, false},
    {"MirrorMetal", {.metallic = 1, .roughness = 0}, true},
    {"Metal10", {.metallic = 1, .roughness = 0.1F}, true},
    {"Metal35", {.metallic = 1, .roughness = 0.35F}, true},
    {"Metal60", {.metallic = 1, .roughness = 0.6F}, true},
    {"Metal100", {.metallic = 1, .roughness = 1}, true},
    {"Copper", {.base_colour = {0.95F, 0.64F, 0.54F, 1}, .metallic = 1, .roughness = 0.2F}, false},
    {"HalfMetal", {.metallic = 0.5F, .roughness = 0.5F}, true},
    {"Emissive", {.base_colour = {0, 0, 0, 1}, .roughness = 1, .emissive = Colour(3, 2, 1)}, false},
    {"Textured", {.base_colour_texture = 0, .roughness = 0.8F}, false},
    {"TexturedMetal", {.metallic = 1, .roughness = 1, .metallic_roughness_texture = 1}, true},
    {"TexturedGlow", {.roughness = 1, .emissive = Colour(2), .emissive_texture = 0}, false},
    {"Glass", {.roughness = 0, .transmission = 1}, true},
    {"SolidGlass", {.roughness = 0, .transmission = 1, .solid = true}, true},
    {"FrostedGlass", {.roughness = 0.5F, .transmission = 0.8F, .ior = 1.3F}, true},
    {"Painted", {.name = "painted", .roughness = 0.6F}, false},
    {"PaintedHoles", {.name = "painted", .roughness = 0.6F, .alpha_cutoff = 0.5F, .double_sided = true}, false},
    {"Bumpy", {.roughness = 0.8F, .normal_texture = 3, .normal_scale = 0.5F}, true},
    {"BumpyMetal", {.metallic = 1, .roughness = 0.35F, .normal_texture = 3, .normal_scale = 0.05F}, true},
    {"Occluded", {.roughness = 0.6F, .occlusion_texture = 4, .occlusion_strength = 0.1F}, false},
    {"Lacquer", {.roughness = 0.8F, .coat = 1, .coat_roughness = 0.1F}, true},
    {"CarPaint", {.base_colour = {0.6F, 0.05F, 0.1F, 1}, .metallic = 0.8F, .roughness = 0.5F, .coat = 1}, false},
    {"CoatedGlass", {.roughness = 0, .transmission = 1, .coat = 0.5F, .coat_roughness = 0.6F}, true},
    {"CoatedLamp",
     {.roughness = 1, .emissive = Colour(2), .emissive_texture = 0, .coat = 0.7F, .coat_roughness = 0.3F},
     false},
    {"SmoothCoatOnBumps",
     {.roughness = 0.8F, .normal_texture = 3, .normal_scale = 0.5F, .coat = 1, .coat_roughness = 0.2F},
     true},
    {"WornCoat",
     {.roughness = 0.8F,
      .coat = 1,
      .coat_roughness = 1,
      .coat_texture = 4,
      .coat_roughness_texture = 1,
      .coat_normal_texture = 3,
      .coat_normal_scale = 0.1F},
     true},
    {"Velvet", {.roughness = 1, .sheen = Colour(1), .sheen_roughness = 0.5F}, true},
    {"Satin", {.metallic = 0.5F, .roughness = 0.4F, .sheen = Colour(0.6F), .sheen_roughness = 0.1F}, true},
    {"CoatedFelt",
     {.base_colour = {0.3F, 0.1F, 0.4F, 1},
      .roughness = 0.8F,
      .coat = 0.5F,
      .sheen = Colour(0.9F, 0.5F, 0.2F),
      .sheen_roughness = 1,
      .sheen_texture = 0,
      .sheen_roughness_texture = 2},
     false},
    {"Masked", {.base_colour_texture = 2, .roughness = 0.6F, .alpha_cutoff = 0.5F, .double_sided = true}, true},
};

Texture texture(bool srgb, std::vector<glm::u8vec4> texels) {
  return {.width = 2, .height = 2, .texels = std::move(texels), .srgb = srgb};
}

// A ball of radius 1 about the origin.
SceneGraph scene_of(const Material& material) {
  SceneGraph scene;
  scene.textures = {
      texture(true, {{255, 40, 40, 255}, {40, 255, 40, 255}, {40, 40, 255, 255}, {250, 250, 40, 255}}),
      texture(false, {{0, 30, 255, 255}, {0, 200, 255, 255}, {0, 90, 255, 255}, {0, 250, 255, 255}}),
      texture(true, {{255, 255, 255, 255}, {255, 255, 255, 0}, {255, 255, 255, 255}, {255, 255, 255, 255}}),
      texture(false, {{160, 128, 250, 255}, {128, 170, 245, 255}, {90, 128, 240, 255}, {128, 100, 250, 255}}),
      texture(false, {{255, 0, 0, 255}, {100, 0, 0, 255}, {180, 0, 0, 255}, {220, 0, 0, 255}}),
  };
  scene.materials = {material};
  scene.meshes = {rooms::ball(64)};
  for (std::size_t k = 0; k < scene.meshes[0].positions.size(); ++k) {
    const glm::vec3& n = scene.meshes[0].normals[k];
    scene.meshes[0].coordinates[k] = 0.5F + 0.25F * glm::vec2(n.x, n.y);  // Magnified: rays know no mip levels.
  }
  if (material.name == "painted")
    for (const glm::vec3& n : scene.meshes[0].normals)
      scene.meshes[0].colours.emplace_back(0.5F + 0.5F * n, 0.5F + n.y);
  if (is_bumpy(material)) add_tangents(scene.meshes[0]);
  scene.nodes = {{.name = "ball", .meshes = {0}}};
  return scene;
}

// ---- what lights it -------------------------------------------------------------------------------------------------

EnvironmentMap map_of(auto&& radiance) {
  EnvironmentMap map;
  map.levels.emplace_back(Projection::latlong, 128);
  std::vector<Direction> rays(256);
  for (int row = 0; row < 128; ++row) {
    texel_directions(Projection::latlong, 128, 0, row, 0, rays);
    for (int i = 0; i < 256; ++i) *map.base().texel(0, i, row) = radiance(rays[i]);
  }
  return map;
}

const Environment& white() {
  static const Environment sky(map_of([](const Direction&) { return Colour(1); }));
  return sky;
}
// 1 above the horizon, 0 below it.
const Environment& half() {
  static const Environment sky(map_of([](const Direction& d) { return Colour(d.y > 0 ? 1 : 0); }));
  return sky;
}
// As probes are: a bright small sun, a sky brighter to one side, a coloured ground.
const Environment& sunny() {
  static const Environment sky(map_of([](const Direction& d) {
    const Colour even = d.y > 0 ? Colour(0.3, 0.5, 0.9) * (1.2F + 0.5F * float(d.x)) : Colour(0.2, 0.15, 0.1);
    return glm::dot(d, glm::normalize(Direction(1, 1, 2))) > 0.995 ? Colour(200, 180, 150) : even;
  }));
  return sky;
}
// What is rough is sampled.
const Environment& sampled() {
  static const Environment sky = [] {
    Environment made(sunny().map.clone());
    made.light.sampled = sampled_levels(made.map);
    return made;
  }();
  return sky;
}
struct Named {
  const char* name;
  const Environment& (*sky)();
  // GL filters textures with weights of 8 bits, which shows in the roughness that a sun is blurred by.
  double tolerance;
};
const Named skies[] = {{"White", white, 5e-4},
                       {"Half", half, 4e-3},
                       {"Sunny", sunny, 0.014},
                       {"Sampled", sampled, 0.03}};

FrameState shot_of(const SceneGraph& scene, const Environment& sky) {
  return {.scene = scene, .pose = pose(scene, 0), .environment = &sky};
}

Drawn drawn(const SceneGraph& scene, const Environment& sky, const Viewpoint& from,
            DrawMethod method = DrawMethod::exact) {
  drawing::context();
  Renderer renderer(scene, &sky);
  return draw(renderer, from, shot_of(scene, sky), method);
}

// The ball from the front, a little from above, in one face of a cube.
Viewpoint camera(Direction at = {0.4, 0.7, 2.2}) {
  return {.to = Projection::cube, .size = 96, .at = at, .which = 1U << 5};
}

// f(number of the texel, ray) for the texels of the face that is drawn.
void for_each_pixel(const Viewpoint& from, auto&& f) {
  const auto texels = std::size_t(from.size) * std::size_t(from.size);
  rooms::for_each_texel(from.to, from.size, [&](std::size_t k, const Direction& ray) {
    if ((from.which >> (k / texels) & 1) != 0) f(k, from.axes * ray);
  });
}

double difference(const Colour& a, const Colour& b) {
  const Flux off = glm::abs(Flux(a) - Flux(b)) / glm::max(Flux(1), Flux(b));
  return std::max(off.x, std::max(off.y, off.z));
}

// ---- against rays ---------------------------------------------------------------------------------------------------

// All materials in one process: a sky's levels for rough materials are made once.
class Materials : public ::testing::TestWithParam<Named> {};
INSTANTIATE_TEST_SUITE_P(Under, Materials, ::testing::ValuesIn(skies),
                         [](const auto& p) { return std::string(p.param.name); });

// A card interpolates textures with 8 bits of fraction.
double of_textures(const Material& m) {
  const bool textured = std::max({m.base_colour_texture, m.emissive_texture, m.coat_texture, m.sheen_texture}) >= 0;
  return textured && !drawing::context().on_processor() ? 0.02 : 0;
}

// In every pixel; of those whose rays graze an outline a few see something else.
void expect_as_rays(const SceneGraph& scene, const Environment& sky, double tolerance) {
  const Viewpoint from = camera();
  const Drawn map = drawn(scene, sky, from), truth = raycast(shot_of(scene, sky), from);
  int others = 0, on_ball = 0;
  double worst = 0;
  for_each_pixel(from, [&](std::size_t k, const Direction&) {
    on_ball += truth.surfaces[k] != 0;
    if (map.surfaces[k] != truth.surfaces[k])
      ++others;
    else
      worst = std::max(worst, difference(rooms::colour_at(map, k), rooms::colour_at(truth, k)));
  });
  EXPECT_LE(others, drawing::context().on_processor() ? 4 : 6);
  EXPECT_GT(on_ball, 1000);
  EXPECT_LT(worst, tolerance);
}

TEST_P(Materials, AreDrawnAsRaysSeeThem) {
  for (const Lit& lit : materials) {
    SCOPED_TRACE(lit.name);
    expect_as_rays(scene_of(lit.material), GetParam().sky(), GetParam().tolerance + of_textures(lit.material));
  }
}

// With levels at the roughnesses of their scene: one, or the steps of a texture.
TEST(OwnLevels, AreMixedAsRaysMixThem) {
  std::map<std::vector<float>, Environment> environments;  // Two of the materials have the same levels.
  for (const Lit& lit : materials)
    for (const char* name : {"Metal35", "TexturedMetal", "Lacquer", "MirrorMetal"}) {
      if (std::string_view(lit.name) != name) continue;
      SCOPED_TRACE(name);
      const SceneGraph scene = scene_of(lit.material);
      const std::vector<float> own = glossy_roughnesses(scene);
      EXPECT_EQ(own.size(), std::string_view(name) == "Lacquer" ? 2U : std::string_view(name) == "Metal35" ? 1U : 9U);
      if (!environments.contains(own)) environments.try_emplace(own, sunny().map.clone(), 64, Progress(), own);
      expect_as_rays(scene, environments.at(own), 0.014);
    }
}

TEST(OwnLevels, FitWhateverTheScene) {
  SceneGraph scene = scene_of({.roughness = 0.5F, .metallic_roughness_texture = 1});
  for (int k = 0; k < 40; ++k) {
    scene.materials.push_back({.roughness = 0.02F * float(k)});
    scene.meshes.push_back(scene.meshes[0]);
    scene.meshes.back().material = k + 1;
    scene.nodes[0].meshes.push_back(k + 1);
    const std::vector<float> all = glossy_roughnesses(scene);
    EXPECT_LE(int(all.size()), max_glossy_levels);
    EXPECT_GT(all.front(), 0);
    EXPECT_EQ(all.back(), 1);
    EXPECT_EQ(std::ranges::adjacent_find(all, std::greater_equal<>()), all.end());
  }
}

// ---- against closed forms -------------------------------------------------------------------------------------------

// The furnace: what reflects all light cannot be told from a white environment, whatever draws it.
TEST(WhiteMaterials, AreNotSeenInWhite) {
  for (const Lit& lit : materials) {
    if (!lit.white) continue;
    SCOPED_TRACE(lit.name);
    const SceneGraph scene = scene_of(lit.material);
    for (const Projection to : all_projections)
      for (const DrawMethod method : {DrawMethod::exact, DrawMethod::resample, DrawMethod::raycast}) {
        if (!can_draw(method, to)) continue;
        const Viewpoint from{.to = to, .size = 32, .at = {0.4, 0.7, 2.2}};
        const Drawn map = method == DrawMethod::raycast ? raycast(shot_of(scene, white()), from)
                                                        : drawn(scene, white(), from, method);
        int on_ball = 0;
        double worst = 0;
        rooms::for_each_texel(to, from.size, [&](std::size_t k, const Direction&) {
          on_ball += map.surfaces[k] != 0;
          worst = std::max(worst, difference(rooms::colour_at(map, k), Colour(1)));
        });
        EXPECT_GT(on_ball, 20);
        EXPECT_LT(worst, 5e-3) << name(to);
      }
  }
}

// Half a sphere of sky gives E = pi (1 + n.y) / 2 (Lambert 1760); without an interface all of that is diffused.
TEST(HalfSky, LightsADiffuseBall) {
  const SceneGraph scene = scene_of({.roughness = 1, .ior = 1});
  const Viewpoint from = camera();
  for (const Drawn& map : {drawn(scene, half(), from), raycast(shot_of(scene, half()), from)}) {
    double worst = 0;
    for_each_pixel(from, [&](std::size_t k, const Direction& ray) {
      if (map.surfaces[k] == 0) return;
      const Direction normal = glm::normalize(from.at + double(map.distances[k]) * ray);
      worst = std::max(worst, std::abs(rooms::colour_at(map, k).y - 0.5 * (1 + normal.y)));
    });
    EXPECT_LT(worst, 0.015);  // Schlick's Fresnel reflects a little at the rim even so.
  }
}

// Any white ball is as bright as the sky where it is seen from straight above, black from straight below; half of what
// a level view of its middle diffuses comes from the sky, and half of what it reflects roughly.
TEST(HalfSky, LightsTopMiddleAndBottom) {
  for (const Lit& lit : materials) {
    if (!lit.white || lit.material.transmission > 0 || lit.material.alpha_cutoff > 0) continue;
    const SceneGraph scene = scene_of(lit.material);
    const auto middle = [&](const Direction& at, unsigned face) {
      const Viewpoint from{.to = Projection::cube, .size = 33, .at = at, .which = 1U << face};
      return rooms::colour_at(drawn(scene, half(), from), face * 33 * 33 + 16 * 33 + 16).y;
    };
    EXPECT_NEAR(middle({0, 3, 0}, 3), 1, 0.02) << lit.name;
    EXPECT_NEAR(middle({0, -3, 0}, 2), 0, 0.02) << lit.name;
    if (lit.material.roughness >= 0.35F) {
      EXPECT_NEAR(middle({0, 0, 3}, 5), 0.5, 0.02) << lit.name;
    }
  }
}

TEST(ClosedForms, AMirrorShowsTheSkyInTheReflectedDirection) {
  const SceneGraph scene = scene_of({.metallic = 1, .roughness = 0});
  const Viewpoint from = camera();
  const Drawn map = drawn(scene, half(), from);
  for_each_pixel(from, [&](std::size_t k, const Direction& ray) {
    if (map.surfaces[k] == 0) return;
    const Direction place = from.at + double(map.distances[k]) * ray;
    const Direction mirrored = glm::reflect(ray, glm::normalize(place));
    if (std::abs(mirrored.y) > 0.05) {  // Beside the horizon the map's texels mix both.
      EXPECT_NEAR(rooms::colour_at(map, k).y, mirrored.y > 0 ? 1 : 0, 1e-3);
    }
  });
}

// What KHR_materials_unlit is read as.
TEST(ClosedForms, WhatIsUnlitShowsItsColourUnderAnyLight) {
  const Colour seen(0.25F, 0.5F, 0.75F);
  const SceneGraph scene = scene_of({.base_colour = {0, 0, 0, 1}, .roughness = 1, .emissive = seen, .ior = 1});
  const Viewpoint from = camera();
  const Drawn map = drawn(scene, half(), from);
  for_each_pixel(from, [&](std::size_t k, const Direction&) {
    if (map.surfaces[k] == 0) return;
    EXPECT_LT(difference(rooms::colour_at(map, k), seen), 1e-5);
  });
}

// Of half a sky by its occlusion map: 1 + strength (red - 1), of what is diffused and of what is reflected.
TEST(ClosedForms, OcclusionKeepsThatMuchOfAnEvenLight) {
  SceneGraph scene = scene_of({.roughness = 0.6F, .occlusion_texture = 0, .occlusion_strength = 0.5F});
  scene.textures = {{.width = 1, .height = 1, .texels = {{51, 255, 255, 255}}, .srgb = false}};
  const Viewpoint from = camera();
  for (const Drawn& map : {drawn(scene, white(), from), raycast(shot_of(scene, white()), from)})
    for_each_pixel(from, [&](std::size_t k, const Direction&) {
      if (map.surfaces[k] == 0) return;
      EXPECT_LT(difference(rooms::colour_at(map, k), Colour(1 + 0.5F * (0.2F - 1))), 2e-3);
    });
}

// A clear coat on black that has no interface, on a lamp: Schlick's part of white, and what it leaves of the lamp, at
// every angle, whatever its roughness (KHR_materials_clearcoat: Fresnel's term is that of the view).
// At the ball's middle 0.04.
TEST(ClosedForms, CoatsReflectByFresnelAndDarkenWhatTheyCover) {
  for (const float roughness : {0.0F, 0.7F})
    for (const float glow : {0.0F, 2.0F}) {
      const SceneGraph scene = scene_of({.base_colour = {0, 0, 0, 1},
                                         .emissive = Colour(glow),
                                         .ior = 1,
                                         .coat = 0.75F,
                                         .coat_roughness = roughness});
      const Viewpoint from = camera();
      for (const Drawn& map : {drawn(scene, white(), from), raycast(shot_of(scene, white()), from)})
        for_each_pixel(from, [&](std::size_t k, const Direction& ray) {
          if (map.surfaces[k] == 0) return;
          const Direction normal = glm::normalize(from.at + double(map.distances[k]) * ray);
          const double cosine = -glm::dot(normal, ray), part = 0.75 * (0.04 + 0.96 * std::pow(1 - cosine, 5));
          if (cosine < 0.2) return;  // The ball has corners.
          EXPECT_NEAR(rooms::colour_at(map, k).y, part + (1 - part) * glow, 3e-3);
        });
    }
}

// Of white light sheen on black reflects its albedo, here summed over directions of light by another rule than the
// table's.
TEST(ClosedForms, SheenOnBlackReflectsItsAlbedo) {
  for (const float roughness : {0.3F, 0.7F, 1.0F}) {
    const SceneGraph scene =
        scene_of({.base_colour = {0, 0, 0, 1}, .ior = 1, .sheen = Colour(0.8F), .sheen_roughness = roughness});
    const Viewpoint from = camera();
    const Drawn map = drawn(scene, white(), from);
    for (const double wanted : {0.3, 0.6, 0.95}) {
      double sum = 0, found = 0, nearest = 1;
      for (double nl = 0.5 / 400; nl < 1; nl += 1.0 / 400)
        for (double turn = pi / 800; turn < pi; turn += pi / 400) {
          const Direction l(std::sqrt(1 - nl * nl) * std::cos(turn), std::sqrt(1 - nl * nl) * std::sin(turn), nl);
          const Direction h = glm::normalize(l + Direction(std::sqrt(1 - wanted * wanted), 0, wanted));
          sum += 2 * nl * sheen(h.z, wanted, nl, roughness) * pi / 400 / 400;
        }
      for_each_pixel(from, [&](std::size_t k, const Direction& ray) {
        if (map.surfaces[k] == 0) return;
        const double cosine = -glm::dot(glm::normalize(from.at + double(map.distances[k]) * ray), ray);
        if (std::abs(cosine - wanted) >= nearest) return;
        nearest = std::abs(cosine - wanted), found = rooms::colour_at(map, k).y;
      });
      EXPECT_NEAR(found, 0.8 * sum, 4e-3) << roughness << ' ' << wanted;
    }
  }
}

// Colours of vertices are interpolated: in white, what has no interface shows them.
TEST(ClosedForms, PaintedVerticesShowTheirColours) {
  const SceneGraph scene = scene_of({.name = "painted", .roughness = 1, .ior = 1});
  const Viewpoint from = camera();
  for (const Drawn& map : {drawn(scene, white(), from), raycast(shot_of(scene, white()), from)})
    for_each_pixel(from, [&](std::size_t k, const Direction& ray) {
      if (map.surfaces[k] == 0) return;
      const Direction place = from.at + double(map.distances[k]) * ray;
      EXPECT_LT(difference(rooms::colour_at(map, k), Colour(0.5 * (place + 1.0))), 0.02);
    });
}

TEST(ClosedForms, WhatShinesInTheDarkShowsItsEmission) {
  static const Environment black(map_of([](const Direction&) { return Colour(0); }));
  const SceneGraph scene = scene_of({.roughness = 1, .emissive = Colour(3, 2, 1)});
  const Viewpoint from = camera();
  const Drawn map = drawn(scene, black, from);
  for_each_pixel(from, [&](std::size_t k, const Direction&) {
    EXPECT_LT(difference(rooms::colour_at(map, k), map.surfaces[k] == 0 ? Colour(0) : Colour(3, 2, 1)), 1e-5);
  });
}

}  // namespace
}  // namespace materials_test

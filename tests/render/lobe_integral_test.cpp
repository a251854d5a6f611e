// Integrals of lobes over an environment, against dense sums over the sphere with the formulae of glTF 2.0's appendix
// B.
#include "envmap/scenes/render/rays/lobe_integral.h"

#include <gtest/gtest.h>

#include <cmath>

#include "envmap/operate/generate.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/render/shading/shading.h"
#include "envmap/scenes/render/shading/sheen_brdf.h"

namespace lobe_integral_test {
namespace {

using namespace envmap;

constexpr int samples = 4096;

Direction tilted(double angle) { return {std::sin(angle), 0, std::cos(angle)}; }

// The sum of radiance x f(direction) x solid angle over a latlong grid.
Flux over_sphere(const EnvironmentLookup& lookup, auto&& f) {
  constexpr int rows = 1024;
  Flux sum(0);
  for (int j = 0; j < rows; ++j) {
    const double polar = pi * (j + 0.5) / rows, solid_angle = std::sin(polar) * (pi / rows) * (pi / rows);
    for (int i = 0; i < 2 * rows; ++i) {
      const double azimuth = pi * (i + 0.5) / rows;
      const Direction l(std::sin(polar) * std::sin(azimuth), std::cos(polar), std::sin(polar) * std::cos(azimuth));
      if (const Flux part = f(l); part != Flux(0)) sum += solid_angle * Flux(lookup(l)) * part;
    }
  }
  return sum;
}

Flux gltf_specular(const Direction& n, const Direction& v, const Direction& l, double alpha, const Flux& f0,
                   double f90) {
  const double nl = glm::dot(n, l), nv = glm::dot(n, v), a2 = alpha * alpha;
  if (nl <= 0) return Flux(0);
  const Direction h = glm::normalize(v + l);
  const double nh = glm::dot(n, h), d = a2 / (pi * std::pow(nh * nh * (a2 - 1) + 1, 2));
  const auto lambda = [&](double c) { return 0.5 * (std::sqrt(1 + a2 * (1 - c * c) / (c * c)) - 1); };
  const double g = 1 / (1 + lambda(nl) + lambda(nv));
  const Flux fresnel = f0 + (f90 - f0) * std::pow(1 - glm::dot(v, h), 5);
  return fresnel * d * g / (4 * nv);
}

struct Light {
  EnvironmentMap map;
  EnvironmentLookup lookup{map};
  LobeIntegral integral{map, lookup, samples};
};

// A sky, and a sun of 5 degrees over it, on the other side of the normal than the view.
const Light& sky() {
  static const Light light{generate(Sky{}, Projection::latlong, 256)};
  return light;
}
const Light& sun() {
  static const Light light{generate(Sun{.towards = {-std::sin(1.047), 0, std::cos(1.047)}, .radius_degrees = 2.5},
                                    Projection::latlong, 512)};
  return light;
}

// Within 1% of each channel, or of a ten-thousandth of the whole light where a channel is darker than that.
void expect_near(const Flux& found, const Flux& wanted, double least) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], wanted[k], 0.01 * std::max(wanted[k], least)) << k;
}

TEST(LobeIntegral, MetalsAndDielectricsReflectTheirIntegrals) {
  const Direction n = glm::normalize(Direction(0.1, 0.2, 1));
  for (const Light* light : {&sky(), &sun()})
    for (const double roughness : {0.2, 0.4, 1.0})
      for (const double angle : {0.0, 0.7, 1.3})
        for (const auto& [f0, f90] : {std::pair(Flux(0.9, 0.6, 0.3), 1.0), std::pair(Flux(0.04), 1.0)}) {
          SCOPED_TRACE(testing::Message()
                       << (light == &sun() ? "sun " : "sky ") << roughness << ' ' << angle << ' ' << f0.x);
          const Direction v = tilted(angle);
          const double alpha = roughness * roughness;
          const Flux wanted =
              over_sphere(light->lookup, [&](const Direction& l) { return gltf_specular(n, v, l, alpha, f0, f90); });
          expect_near(light->integral.ggx(n, v, alpha, f0, f90), wanted, 1e-4);
        }
}

TEST(LobeIntegral, DiffuseAndClothReflectTheirs) {
  const Direction n = glm::normalize(Direction(0.3, 0.4, 1));
  for (const Light* light : {&sky(), &sun()}) {
    const Flux irradiance =
        over_sphere(light->lookup, [&](const Direction& l) { return Flux(std::max(0.0, glm::dot(n, l))); });
    expect_near(light->integral.diffuse(n), irradiance / pi, 1e-4);
    for (const double roughness : {0.3, 0.8})
      for (const double angle : {0.0, 1.1}) {
        SCOPED_TRACE(testing::Message() << roughness << ' ' << angle);
        const Direction v = tilted(angle);
        const Flux wanted = over_sphere(light->lookup, [&](const Direction& l) {
          const double nl = glm::dot(n, l);
          return nl > 0 ? Flux(nl * sheen(glm::dot(n, glm::normalize(l + v)), glm::dot(n, v), nl, roughness)) : Flux(0);
        });
        expect_near(light->integral.charlie(n, v, roughness), wanted, 1e-4);
      }
  }
}

TEST(LobeIntegral, ABlackMapGivesNothing) {
  const Light dark{generate(Constant{Direction(0)}, Projection::cube, 4)};
  EXPECT_EQ(dark.integral.diffuse({0, 0, 1}), Flux(0));
  EXPECT_EQ(dark.integral.ggx({0, 0, 1}, tilted(0.5), 0.1, Flux(1), 1), Flux(0));
}

// All layers at once: what is not reflected is diffused, so a white surface of any kind in white light is white. At
// roughness 1 the table of the split sum, whose last row is .98, is off by 2%.
TEST(LobeIntegral, WhiteSurfacesInAWhiteRoomStayWhite) {
  const Environment room(generate(Constant{Direction(1)}, Projection::latlong, 64), 6);
  const LobeIntegral integral(room.map, room.lookup, samples);
  const Lighting light{.lights = {}, .environment = &room, .integral = &integral};
  for (const float metallic : {0.0F, 1.0F})
    for (const float roughness : {0.1F, 0.3F, 1.0F})
      for (const double angle : {0.0, 0.7, 1.4}) {
        const ShadingPoint s{.metallic = metallic, .roughness = roughness, .coat = 0.5F, .coat_roughness = 0.2F};
        EXPECT_NEAR(shade(s, tilted(angle), light).x, 1, 0.02) << metallic << ' ' << roughness << ' ' << angle;
      }
}

// A metal plate under a sun of 5 degrees. Even levels mix roughness .2 and .4 for .3, and show it half as bright again;
// those of the scene have a level for it.
TEST(LobeIntegral, PicturesOfRoughMetalAreRight) {
  const EnvironmentMap map = generate(Sun{.towards = {0, 0, 1},
                                          .radius_degrees = 2.5,
                                          .radiance = Rgb<double>{500},
                                          .sky = {Rgb<double>{0}, Rgb<double>{0}}},
                                      Projection::latlong, 512);
  SceneGraph scene;
  scene.materials = {{.base_colour = {1, 1, 1, 1}, .metallic = 1}};
  scene.meshes = {{.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}},
                   .normals = {4, {0, 0, 1}},
                   .coordinates = std::vector<glm::vec2>(4),
                   .indices = {0, 1, 2, 0, 2, 3}}};
  scene.nodes = {{.name = "plate", .meshes = {0}}};
  const Viewpoint from{.size = 1, .at = {0, 0, 3}, .lens = Lens{1, {1e-3, 1e-3}, 0}};
  const auto seen = [&](const Environment& sky, int lobe_samples) {
    return raycast_picture({.scene = scene, .pose = pose(scene, 0), .environment = &sky}, from,
                           {.lobe_samples = lobe_samples})
        .front()
        .x;
  };
  const Direction n(0, 0, 1);
  const EnvironmentLookup lookup(map);
  for (const float roughness : {0.1F, 0.3F}) {
    scene.materials[0].roughness = roughness;
    const double alpha = double(roughness) * roughness;
    const double once =
        over_sphere(lookup, [&](const Direction& l) { return gltf_specular(n, n, l, alpha, Flux(1), 1); }).x;
    const std::vector<float> own = glossy_roughnesses(scene);
    EXPECT_EQ(own, std::vector{roughness});
    const Environment sky(map.clone(), glossy_size, {}, own);
    EXPECT_NEAR(seen(sky, samples) / once, 1, 0.02) << roughness;  // And a little that bounces between microfacets.
    EXPECT_NEAR(seen(sky, 0) / once, 1, 0.05) << roughness;
    if (roughness == 0.3F) {
      EXPECT_GT(seen(Environment(map.clone()), 0) / once, 1.3);
    }
  }
}

}  // namespace
}  // namespace lobe_integral_test

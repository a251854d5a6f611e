// Surfaces under light, against integrals of their own and white rooms.
#include "envmap/scenes/render/shading/shading.h"

#include <gtest/gtest.h>

#include <cmath>

#include "envmap/operate/generate.h"
#include "envmap/operate/lookup.h"
#include "envmap/scenes/render/shading/sheen_brdf.h"

namespace shading_test {
namespace {

using namespace envmap;

Direction tilted(double angle) { return {std::sin(angle), 0, std::cos(angle)}; }

struct Room {
  Environment environment;
  explicit Room(const Pattern& pattern, int size = 6) : environment(generate(pattern, Projection::latlong, 64), size) {}
  [[nodiscard]] Lighting lighting() const { return {{}, &environment, Colour(0)}; }
};

TEST(Shading, WhiteSurfacesInAWhiteRoomStayWhite) {
  const Room room(Constant{Direction(1)});
  Lighting ambient;
  ambient.ambient = Colour(1);
  for (const Lighting& l : {room.lighting(), ambient})
    for (const float metallic : {0.0F, 0.5F, 1.0F})
      for (const float transmission : {0.0F, 1.0F})
        for (const float roughness : {0.0F, 0.05F, 0.3F, 0.7F, 1.0F})
          for (const double angle : {0.0, 0.5, 1.0, 1.4, 1.55}) {
            const ShadingPoint s{.metallic = metallic, .roughness = roughness, .transmission = transmission};
            const Colour c = shade(s, tilted(angle), l);
            for (int k = 0; k < 3; ++k) EXPECT_NEAR(c[k], 1, 3e-3) << metallic << ' ' << roughness << ' ' << angle;
          }
}

// What a punctual light gives, from the definitions of glTF 2.0's appendix B, written as they stand there.
// Of a dielectric where there is a diffuse colour, else of a metal.
double appendix_b(const ShadingPoint& s, const Direction& v, const Direction& l, double f0, double diffuse) {
  const Direction &n = s.normal, h = glm::normalize(v + l);
  const double a = s.roughness * s.roughness, nh = glm::dot(n, h), nl = glm::dot(n, l), nv = glm::dot(n, v);
  const double d = a * a / (pi * std::pow(nh * nh * (a * a - 1) + 1, 2));
  const auto g1 = [&](double c) { return 2 * c / (c + std::sqrt(a * a + (1 - a * a) * c * c)); };
  // Height-correlated: 1 / (1 + L(l) + L(v)), where G1 = 1 / (1 + L).
  const double g = 1 / (1 / g1(nl) + 1 / g1(nv) - 1);
  const double f = f0 + (1 - f0) * std::pow(1 - glm::dot(v, h), 5);
  return ((1 - f) * diffuse / pi + f * d * g / (4 * nl * nv)) * nl;
}

TEST(Shading, LightsFollowAppendixB) {
  const ShadingPoint s{.position = {1, 2, 3},
                       .base_colour = glm::vec4(0.5F, 0.25F, 0.75F, 1),
                       .metallic = 0.25F,
                       .roughness = 0.4F};
  for (const double angle : {0.1, 0.6, 1.2})
    for (const double other : {-1.3, -0.5, 0.3}) {
      const Direction v = tilted(angle), l = tilted(other);
      Lighting lit;
      lit.lights = {{PunctualLight::Kind::point, s.position + 2.0 * l, {0, 0, -1}, Colour(8), 0, 1, 0}};
      const Colour c = shade(s, v, lit);
      for (int k = 0; k < 3; ++k) {
        const double base = s.base_colour[k];
        const double mixed = 0.75 * appendix_b(s, v, l, 0.04, base) + 0.25 * appendix_b(s, v, l, base, 0);
        EXPECT_NEAR(c[k], 2 * mixed, 1e-5);  // 8 candela at 2 m.
      }
    }
}

// KHR_materials_clearcoat: mix(base, D V of the coat, coat x Fresnel of the view), the coat with a normal of its own.
TEST(Shading, CoatsFollowTheirExtension) {
  ShadingPoint s{.base_colour = glm::vec4(0.5F), .roughness = 0.6F, .coat = 0.8F, .coat_roughness = 0.3F};
  s.coat_normal = tilted(0.2);
  for (const double angle : {0.1, 0.6, 1.2})
    for (const double other : {-1.3, -0.5, 0.3}) {
      const Direction v = tilted(angle), l = tilted(other);
      Lighting lit;
      lit.lights = {{PunctualLight::Kind::point, 2.0 * l, {0, 0, -1}, Colour(8), 0, 1, 0}};
      ShadingPoint over = s;
      over.normal = s.coat_normal, over.roughness = s.coat_roughness;
      const double part = 0.8 * (0.04 + 0.96 * std::pow(1 - glm::dot(over.normal, v), 5));
      const double mixed = (1 - part) * appendix_b(s, v, l, 0.04, 0.5) +
                           (glm::dot(over.normal, l) > 0 ? part * appendix_b(over, v, l, 1, 0) : 0);
      EXPECT_NEAR(shade(s, v, lit).x, 2 * mixed, 1e-5) << angle << ' ' << other;
    }
}

// KHR_materials_sheen as it stands there: Estevez and Kulla's distribution and visibility; the base scaled by the
// lesser of what is left by the view and by the light.
TEST(Shading, SheenFollowsItsExtension) {
  const auto f_sheen = [](double nh, double nv, double nl, double roughness) {
    const double alpha = roughness * roughness, d = (2 + 1 / alpha) * std::pow(1 - nh * nh, 1 / alpha / 2) / (2 * pi);
    const auto l = [&](double x) {
      const double t = (1 - alpha) * (1 - alpha);
      const auto mix = [&](double a, double b) { return a * (1 - t) + b * t; };
      return mix(21.5473, 25.3245) / (1 + mix(3.82987, 3.32435) * std::pow(x, mix(0.19823, 0.16801))) +
             mix(-1.97760, -1.27393) * x + mix(-4.32054, -4.85967);
    };
    const auto lambda = [&](double c) { return c < 0.5 ? std::exp(l(c)) : std::exp(2 * l(0.5) - l(1 - c)); };
    return d / ((1 + lambda(nv) + lambda(nl)) * 4 * nv * nl);
  };
  ShadingPoint s{.base_colour = glm::vec4(0.5F),
                 .roughness = 0.6F,
                 .sheen = Colour(0.9F, 0.5F, 0.1F),
                 .sheen_roughness = 0.6F};
  for (const double angle : {0.1, 0.6, 1.2})
    for (const double other : {-1.3, -0.5, 0.3}) {
      const Direction v = tilted(angle), l = tilted(other);
      Lighting lit;
      lit.lights = {{PunctualLight::Kind::point, 2.0 * l, {0, 0, -1}, Colour(8), 0, 1, 0}};
      const double left = 1 - 0.9 * std::max(sheen_albedo(v.z, 0.6), sheen_albedo(l.z, 0.6));
      const double base = left * appendix_b(s, v, l, 0.04, 0.5);
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(shade(s, v, lit)[k],
                    2 * (base + s.sheen[k] * l.z * f_sheen(glm::normalize(v + l).z, v.z, l.z, 0.6)), 1e-5);
    }
}

TEST(Shading, RangeConeAndSun) {
  const ShadingPoint s{.metallic = 1, .roughness = 1};
  const auto from = [&](const PlacedLight& light) {
    Lighting lit;
    lit.lights = {light};
    return shade(s, {0, 0, 1}, lit).x;
  };
  const PlacedLight sun{PunctualLight::Kind::directional, {}, {0, 0, -1}, Colour(1), 0, 1, 0};
  const float one = from(sun);
  EXPECT_GT(one, 0);
  PlacedLight point{PunctualLight::Kind::point, {0, 0, 2}, {0, 0, -1}, Colour(4), 0, 1, 0};
  EXPECT_NEAR(from(point), one, 1e-6);
  point.range = 4;  // 1 - (2/4)^4.
  EXPECT_NEAR(from(point), one * (1 - 1.0 / 16), 1e-6);
  point.range = 2;
  EXPECT_EQ(from(point), 0);
  PlacedLight spot{PunctualLight::Kind::spot, {0, 0, 2}, tilted(pi - 0.3), Colour(4), 0, std::cos(0.2), std::cos(0.4)};
  const double part = (std::cos(0.3) - std::cos(0.4)) / (std::cos(0.2) - std::cos(0.4));
  EXPECT_NEAR(from(spot), one * part * part, 1e-6);
  spot.direction = {0, 0, 1};
  EXPECT_EQ(from(spot), 0);
}

// A diffuse floor under the CIE overcast sky: E = 7 pi / 9 of the zenith (generate.h).
// Of a gradient harmonics are exact.
TEST(Shading, DiffuseLightOfTheEnvironment) {
  ShadingPoint floor{.normal = {0, 1, 0}, .roughness = 1, .ior = 1};  // No interface: all is diffuse.
  const Room sky(Sky{Rgb<double>(1), Rgb<double>(0)});
  EXPECT_NEAR(shade(floor, {0, 1, 0}, sky.lighting()).x, 7.0 / 9, 0.03);
  const Room gradient(Gradient{Direction(0), Direction(1)});
  // L = (1 + y) / 2: E / pi = 1/2 + y / 3.
  for (const double y : {-1.0, 0.0, 0.6, 1.0}) {
    floor.normal = {std::sqrt(1 - y * y), y, 0};
    EXPECT_NEAR(shade(floor, floor.normal, gradient.lighting()).x, 0.5 + y / 3, 2e-3) << y;
  }
}

TEST(Shading, AMirrorShowsTheEnvironmentAndGlassLetsItThrough) {
  const Room room(Directions{});
  const auto coded = [](const Direction& d) { return Flux((d + 1.0) * 0.5); };
  for (const double angle : {0.0, 0.7, 1.3}) {
    const Direction v = tilted(angle);
    ShadingPoint s{.metallic = 1, .roughness = 0};
    EXPECT_LT(glm::length(Flux(shade(s, v, room.lighting())) - coded({-v.x, v.y, v.z})), 3e-3) << angle;
    // Ice that reflects next to nothing, away from the edge: what is seen is refracted by Snell's law.
    if (angle > 1) continue;
    s = {.metallic = 0, .roughness = 0, .transmission = 1, .ior = 1.001F};
    const double inside = std::asin(std::sin(angle) / 1.001);
    EXPECT_LT(glm::length(Flux(shade(s, v, room.lighting())) - coded({-std::sin(inside), 0, -std::cos(inside)})), 2e-2)
        << angle;
  }
}

TEST(Shading, RoughMetalBlursAsGgxDoes) {
  const Room room(Gradient{Direction(0), Direction(1)}, 16);
  // In a linear environment the prefiltered value is 1/2 + y c / 2, c the mean cosine of the lobe,
  // found by its own integral.
  for (const float roughness : {0.3F, 0.6F, 1.0F}) {
    const double a = std::pow(roughness, 2);
    double sum = 0, weight = 0;
    for (int k = 0; k < 20000; ++k) {  // Half vectors over theta; l at twice the angle, weighted by cos(n,l).
      const double t = (k + 0.5) / 20000 * pi / 4, c = std::cos(t), nl = std::cos(2 * t);
      const double d = a * a / (pi * std::pow(c * c * (a * a - 1) + 1, 2));
      const double w = d * nl * std::sin(2 * t);
      sum += w * nl, weight += w;
    }
    const ShadingPoint s{.normal = {0, 1, 0}, .metallic = 1, .roughness = roughness};
    const Colour c = shade(s, {0, 1, 0}, room.lighting());
    // What bounces more than once comes diffused: 1/2 + 1/3.
    const double once = c.x, sharp = 0.5 + 0.5 * sum / weight;
    EXPECT_LE(once, sharp + 5e-3) << roughness;
    EXPECT_GE(once, 0.5 + 1.0 / 3 - 5e-3) << roughness;
    if (roughness < 0.5F) {
      EXPECT_NEAR(once, sharp, 1e-2);
    }
  }
}

}  // namespace
}  // namespace shading_test

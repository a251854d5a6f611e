// Reflections by samples of the lobe, against sums over suns and half vectors with the formulae of glTF 2.0's appendix
// B.
#include "envmap/scenes/render/shading/sampled_reflection.h"

#include <gtest/gtest.h>

#include <cmath>

#include "envmap/operate/generate.h"
#include "envmap/scenes/render/shading/shading.h"

namespace sampled_reflection_test {
namespace {

using namespace envmap;

const double roughnesses[] = {0.1, 0.3, 0.5, 0.8}, views[] = {0, 45, 75};

double radians(double degrees) { return degrees * pi / 180; }

// GGX with Smith's height-correlated masking, times the cosine. @param f0, f90 of Schlick.
double reflected(const Direction& n, const Direction& v, const Direction& l, double alpha, double f0, double f90) {
  const double nl = glm::dot(n, l), nv = glm::dot(n, v), a2 = alpha * alpha;
  if (nl <= 0) return 0;
  const Direction h = glm::normalize(v + l), side = glm::cross(n, h);
  const double nh = glm::dot(n, h), q = a2 * nh * nh + glm::dot(side, side);
  const auto lambda = [&](double c) { return 0.5 * (std::sqrt(1 + a2 * std::max(0.0, 1 / (c * c) - 1)) - 1); };
  const double fresnel = f0 + (f90 - f0) * std::pow(1 - glm::dot(v, h), 5);
  return fresnel * a2 / (pi * q * q) / (1 + lambda(nl) + lambda(nv)) / (4 * nv);
}

// The integral over a disc of the sky.
double of_sun(const Direction& n, const Direction& v, const Direction& sun, double radius, double alpha) {
  const Rotation frame = upright_about(sun);
  const int rings = radius > 0.1 && alpha < 0.05 ? 300 : 60, turns = 2 * rings;
  double sum = 0;
  for (int i = 0; i < rings; ++i) {
    const double polar = radius * (i + 0.5) / rings, c = std::cos(polar), across = std::sin(polar);
    for (int j = 0; j < turns; ++j) {
      const double turn = 2 * pi * (j + 0.5) / turns;
      const Direction l = frame * Direction(across * std::cos(turn), across * std::sin(turn), c);
      sum += across * reflected(n, v, l, alpha, 1, 1);
    }
  }
  return 2 * pi * radius * sum / (rings * turns);
}

Flux reflection(const Environment& sky, const ShadingPoint& s, const Direction& v) {
  const Lighting light{.lights = {}, .environment = &sky};
  return reflected_light(s, v, light, scatter(s, v, light));
}

Environment sampled(EnvironmentMap map) {
  Environment sky(std::move(map), glossy_size, {}, {1});
  sky.light.sampled = sampled_levels(sky.map);
  return sky;
}

// ---- the furnace ----------------------------------------------------------------------------------------------------

// Directional albedo by a grid over directions of light.
double albedo(double view, double alpha, double f0, double f90) {
  const Direction n(0, 0, 1), v(std::sin(view), 0, std::cos(view));
  constexpr int rows = 900;
  double sum = 0;
  for (int i = 0; i < rows; ++i) {
    const double polar = pi / 2 * (i + 0.5) / rows;
    for (int j = 0; j < rows; ++j) {
      const double turn = pi * (j + 0.5) / rows;
      const Direction l(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar));
      sum += std::sin(polar) * reflected(n, v, l, alpha, f0, f90);
    }
  }
  return sum * pi * pi / (rows * double(rows));
}

TEST(SampledReflection, InAWhiteRoomIsTheDirectionalAlbedo) {
  const Environment room = sampled(generate(Constant{Direction(1)}, Projection::latlong, 16));
  for (const double roughness : roughnesses)
    for (const double view : views) {
      SCOPED_TRACE(testing::Message() << roughness << ' ' << view);
      const Direction v(std::sin(radians(view)), 0, std::cos(radians(view)));
      const double alpha = roughness * roughness;
      const ShadingPoint copper{.base_colour = {0.9F, 0.6F, 0, 1}, .metallic = 1, .roughness = float(roughness)};
      const Flux of_metal = reflection(room, copper, v);
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(of_metal[k], albedo(radians(view), alpha, double(copper.base_colour[k]), 1), 6e-3) << k;
      const ShadingPoint plastic{.metallic = 0, .roughness = float(roughness)};
      EXPECT_NEAR(reflection(room, plastic, v).x, albedo(radians(view), alpha, 0.04, 1), 3e-3);
    }
}

// ---- suns -----------------------------------------------------------------------------------------------------------

// Of a metal under a sun: the rms of what is off over that of the truth, in views whose mirrored direction passes the
// sun's middle by up to twice the lobe's width or the sun's, along the plane of view and across it, on seven bearings.
struct Errors {
  double split_sum, samples;
};
Errors errors_of(const Environment& by_levels, const Environment& by_samples, const Direction& sun, double radius,
                 double roughness, double view) {
  const ShadingPoint metal{.metallic = 1, .roughness = float(roughness)};
  const double alpha = roughness * roughness, step = std::max(0.75 * alpha, radius / 2);
  const Rotation frame = upright_about(sun);
  double of_levels = 0, of_samples = 0, all = 0;
  for (int k = 0; k < 7 * 9 * 2; ++k) {
    const double bearing = 0.9 * (k % 7), off = step * (k / 7 % 9 - 4);
    const Direction side = std::cos(bearing) * frame[0] + std::sin(bearing) * frame[1], up = glm::cross(sun, side);
    const Direction mirrored = std::cos(off) * sun + std::sin(off) * (k < 63 ? side : up);
    const Direction tilt = k < 63 ? glm::cross(up, mirrored) : side;
    ShadingPoint s = metal;
    s.normal = std::cos(view) * mirrored + std::sin(view) * tilt;
    const Direction v = 2 * glm::dot(s.normal, mirrored) * s.normal - mirrored;
    const double truth = of_sun(s.normal, v, sun, radius, alpha);
    of_levels += std::pow(reflection(by_levels, s, v).x - truth, 2);
    of_samples += std::pow(reflection(by_samples, s, v).x - truth, 2);
    all += truth * truth;
  }
  return {std::sqrt(of_levels / all), std::sqrt(of_samples / all)};
}

TEST(SampledReflection, SunsInMetalAreRightAtEveryAngle) {
  const Direction sun = glm::normalize(Direction(0.5, 0.3, 1));
  double split_sum = 0, samples = 0;
  for (const double diameter : {1.0, 5.0, 20.0}) {
    const double radius = radians(diameter / 2);
    const EnvironmentMap map = generate(Sun{.towards = sun,
                                            .radius_degrees = diameter / 2,
                                            .radiance = Rgb<double>{1},
                                            .sky = {Rgb<double>{0}, Rgb<double>{0}}},
                                        Projection::latlong, 1024);
    const std::vector<float> own(std::begin(roughnesses), std::end(roughnesses));
    const Environment by_levels(map.clone(), glossy_size, {}, own), by_samples = sampled(map.clone());
    for (const double roughness : roughnesses)
      for (const double view : views) {
        SCOPED_TRACE(testing::Message() << diameter << ' ' << roughness << ' ' << view);
        const Errors e = errors_of(by_levels, by_samples, sun, radius, roughness, radians(view));
        EXPECT_LT(e.samples, 0.1);
        split_sum += e.split_sum / 36, samples += e.samples / 36;
      }
  }
  EXPECT_LT(samples, 0.04);
  EXPECT_GT(split_sum, 0.2);
}

// A sun 20 degrees from the mirrored direction, nearer to the normal: the bent lobe of a grazing view still shows it.
TEST(SampledReflection, AGrazingViewShowsASunBesideItsMirroredDirection) {
  const Direction n(0, 0, 1), v(std::sin(radians(75)), 0, std::cos(radians(75)));
  const Direction sun(-std::sin(radians(55)), 0, std::cos(radians(55)));
  const Environment sky = sampled(generate(Sun{.towards = sun,
                                               .radius_degrees = 2.5,
                                               .radiance = Rgb<double>{1000},
                                               .sky = {Rgb<double>{0}, Rgb<double>{0}}},
                                           Projection::latlong, 512));
  const Environment levels(sky.map.clone(), glossy_size, {}, {0.5F});
  const ShadingPoint metal{.metallic = 1, .roughness = 0.5F};
  const double truth = 1000 * of_sun(n, v, sun, radians(2.5), 0.25);
  EXPECT_NEAR(reflection(sky, metal, v).x / truth, 1, 0.1);
  EXPECT_LT(reflection(levels, metal, v).x / truth, 0.5);
}

}  // namespace
}  // namespace sampled_reflection_test

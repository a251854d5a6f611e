// Suns of known direction, radius and light, painted here by samples of their texels.
#include "envmap/light/lights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/light/light_error.h"
#include "envmap/operate/generate.h"
#include "envmap/operate/measure.h"
#include "envmap/prefilter/prefilter.h"
#include "numeric/landscape.h"
#include "numeric/painted_discs.h"

namespace envmap::lights_test {
namespace {

using namespace numeric_tests;

EnvironmentMap even(Projection p, int size, double radiance = 1) { return generate(Constant{Flux(radiance)}, p, size); }

double off_by(const DiscLight& light, const Direction& towards) {
  return angle_between(light.towards, towards) / degree;
}

void expect_flux_is_kept(const EnvironmentMap& map, const FoundLights& found) {
  EnvironmentMap remainder = map.clone();
  take_out(remainder, found);
  Flux sum = flux(remainder.base());
  for (const DiscLight& light : found.lights) sum += light.flux;
  const Flux whole = flux(map.base());
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c] / whole[c], 1, 1e-6);
}

// The promise: .02 degrees and .1% for a disc as large as the sun, where texels are no larger than it is.
void expect_sun(Projection p, int size, const Direction& towards) {
  SCOPED_TRACE(std::string(name(p)) + " " + std::to_string(size) + " towards " + std::to_string(towards.x) + " " +
               std::to_string(towards.y) + " " + std::to_string(towards.z));
  const EnvironmentMap sky = even(p, size);
  EnvironmentMap map = sky.clone();
  paint_disc(map, towards, sun_radius_degrees, Flux(1e5, 9e4, 7e4));
  const Flux painted = added(map, sky);
  EXPECT_NEAR(painted.x / (cap(sun_radius_degrees) * 1e5), 1, 0.03);
  const FoundLights found = find_lights(map);
  ASSERT_EQ(found.lights.size(), 1);
  const DiscLight& sun = found.lights.front();
  EXPECT_LT(off_by(sun, towards), 0.02);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(sun.flux[c] / painted[c], 1, 1e-3);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(sun.irradiance[c] / sun.flux[c], 1, 1e-4);  // (1 + cos r) / 2.
  if (!sun.radius_is_bound) {
    EXPECT_NEAR(sun.radius_degrees, sun_radius_degrees, sun.radius_within_degrees + 0.02);
  }
  expect_flux_is_kept(map, found);
}

TEST(Lights, FindSunsOfLatlongMaps) {
  for (const int size : {512, 1024})
    for (const Direction& d : {Direction(0, 1, 0), Direction(0.002, 1, 0.001), Direction(0, 0, -1),
                               Direction(0.001, -0.3, -1), Direction(0.3, 0.5, 0.7)})
      expect_sun(Projection::latlong, size, d);
}

// Middle, edge and corner of faces.
TEST(Lights, FindSunsOfCubes) {
  for (const int size : {256, 512})
    for (const Direction& d : {Direction(0, 1, 0), Direction(1, 1, 0), Direction(1, 1, 1), Direction(-1, 0.3, 0.998),
                               Direction(0.3, 0.5, 0.7)})
      expect_sun(Projection::cube, size, d);
}

TEST(Lights, FindSunsAtRimsAndCreases) {
  for (const Direction& d : {Direction(1, 1, 0), Direction(1, 0.2, 0.003), Direction(0.3, 0.5, 0.7)})
    expect_sun(Projection::paraboloid, 1024, d);
  for (const Direction& d : {Direction(0, 0, -1), Direction(0.02, 0.01, -1), Direction(0.3, 0.5, 0.7)})
    expect_sun(Projection::angular, 1024, d);
  for (const Projection p : {Projection::octahedral, Projection::equal_area})
    for (const Direction& d :
         {Direction(0, -1, 0), Direction(1, 0, 0), Direction(0.6, 0.001, 0.8), Direction(0.3, 0.5, 0.7)})
      expect_sun(p, 1024, d);
  for (const Direction& d : {Direction(0, 0, 1), Direction(0.3, 0.5, 0.7), Direction(1, 0.1, 0)})
    expect_sun(Projection::sphere, 1024, d);
}

// Other axes at the centre turn the result with them.
TEST(Lights, LieInTheWorld) {
  EnvironmentMap map = generate(Constant{}, {Projection::latlong, Forward::plus_x}, 512);
  const Direction towards(0.3, 0.5, 0.7);
  paint_disc(map, towards, 1, Flux(1e4));
  const FoundLights found = find_lights(map);
  ASSERT_EQ(found.lights.size(), 1);
  EXPECT_LT(off_by(found.lights[0], towards), 0.02);
}

TEST(Lights, NoiseRoundASunChangesLittle) {
  EnvironmentMap map = numeric_tests::landscape(Projection::latlong, 512, 1);
  const Direction towards(0.3, 0.5, 0.7);
  paint_disc(map, towards, sun_radius_degrees, Flux(1e5));
  const FoundLights found = find_lights(map);
  ASSERT_EQ(found.lights.size(), 1);
  EXPECT_LT(off_by(found.lights[0], towards), 0.02);
  EXPECT_NEAR(found.lights[0].flux.y / (cap(sun_radius_degrees) * 1e5), 1, 1e-3);
  expect_flux_is_kept(map, found);
}

// Its radius is at most that of the texel, and what is said of the direction is true.
TEST(Lights, ADiscBelowATexelHasABoundOfItsRadius) {
  for (const Direction& d : {Direction(0.3, 0.5, 0.7), Direction(0.5, 0.1, -0.5), Direction(0.004, 0.3, 1)}) {
    const EnvironmentMap sky = even(Projection::cube, 64);
    EnvironmentMap map = sky.clone();
    paint_disc(map, d, 0.1, Flux(1e6));
    const FoundLights found = find_lights(map);
    ASSERT_EQ(found.lights.size(), 1);
    const DiscLight& light = found.lights[0];
    EXPECT_TRUE(light.radius_is_bound);
    EXPECT_GE(light.radius_degrees, 0.1);
    EXPECT_LE(light.radius_degrees, 2);
    EXPECT_LE(off_by(light, d), light.within_degrees);
    EXPECT_NEAR(light.flux.x / added(map, sky).x, 1, 1e-3);
  }
}

TEST(Lights, LargeDiscsHaveTheirRadius) {
  for (const double radius : {0.5, 1.5, 4.0}) {
    EnvironmentMap map = even(Projection::latlong, 512);
    const Direction towards(0.3, 0.5, 0.7);
    paint_disc(map, towards, radius, Flux(1000));
    const FoundLights found = find_lights(map);
    ASSERT_EQ(found.lights.size(), 1);
    EXPECT_NEAR(found.lights[0].radius_degrees, radius, 0.01);
    EXPECT_LT(off_by(found.lights[0], towards), 0.01);
    EXPECT_NEAR(found.lights[0].radiance.x, 999, 5);
  }
}

TEST(Lights, TwoSunsThatTouchAreTwo) {
  for (const double second : {1e5, 3e4}) {
    EnvironmentMap map = even(Projection::latlong, 1024);
    const Direction a(0.3, 0.5, 0.7);
    const Direction beside = glm::normalize(glm::cross(a, Direction(0.2, 1, 0.1)));
    const Direction b = std::cos(0.6 * degree) * glm::normalize(a) + std::sin(0.6 * degree) * beside;
    paint_disc(map, a, 0.3, Flux(1e5));
    paint_disc(map, b, 0.3, Flux(second));
    const FoundLights found = find_lights(map);
    ASSERT_EQ(found.lights.size(), 2) << second;
    const bool swapped = off_by(found.lights[0], a) > 0.3;
    const DiscLight &first = found.lights[swapped], &other = found.lights[!swapped];
    EXPECT_LT(off_by(first, a), 0.02);
    EXPECT_LT(off_by(other, b), 0.02);
    EXPECT_NEAR(first.flux.y / (cap(0.3) * 1e5), 1, 0.01);
    EXPECT_NEAR(other.flux.y / (cap(0.3) * second), 1, 0.01);
    expect_flux_is_kept(map, found);
  }
}

// A disc of more light than the sun, so near that the sun lies in what surrounds it.
TEST(Lights, ASunBesideALargerLampIsWhole) {
  const EnvironmentMap dark = even(Projection::latlong, 512, 0.01);
  const Direction towards(0.3, 0.5, 0.7);
  const Direction beside = glm::normalize(glm::cross(towards, Direction(0.2, 1, 0.1)));
  EnvironmentMap lamp = dark.clone();
  paint_disc(lamp, std::cos(7 * degree) * glm::normalize(towards) + std::sin(7 * degree) * beside, 2.6, Flux(100));
  EnvironmentMap map = lamp.clone();
  paint_disc(map, towards, sun_radius_degrees, Flux(8000));
  const FoundLights found = find_lights(map);
  ASSERT_EQ(found.lights.size(), 2);
  EXPECT_NEAR(found.lights[0].radius_degrees, 2.6, 0.02);
  EXPECT_NEAR(found.lights[0].flux.y / added(lamp, dark).y, 1, 2e-3);
  EXPECT_LT(off_by(found.lights[1], towards), 0.02);
  EXPECT_NEAR(found.lights[1].flux.y / added(map, lamp).y, 1, 1e-3);
}

TEST(Lights, ASunBehindThinCloudIsFoundInItsGlow) {
  EnvironmentMap map = even(Projection::latlong, 512);
  const Direction towards(0.3, 0.5, 0.7);
  for (double radius = 8; radius > 0.5; radius *= 0.7) paint_disc(map, towards, radius, Flux(3));
  const EnvironmentMap glow = map.clone();
  paint_disc(map, towards, sun_radius_degrees, Flux(20000));
  const FoundLights found = find_lights(map);
  ASSERT_EQ(found.lights.size(), 1);
  EXPECT_LT(off_by(found.lights[0], towards), 0.02);
  EXPECT_NEAR(found.lights[0].flux.y / added(map, glow).y, 1, 1e-3);
}

// A glow that rises to the middle of the disc, in a peak or smoothly, stays in the map: its light is not the sun's.
TEST(Lights, AGlowGoesOnBehindTheDisc) {
  const Direction towards = glm::normalize(Direction(0.3, 0.5, 0.7));
  for (const bool peaked : {true, false}) {
    EnvironmentMap map = even(Projection::latlong, 512);
    Level& level = map.base();
    for (const Texel& t : texels_of(level)) {
      const Direction d = direction_at(Projection::latlong, t.face, {(t.i + 0.5) / 1024, (t.j + 0.5) / 512});
      const double off = angle_between(d, towards) / degree;
      *level.texel(t.face, t.i, t.j) += Colour(float(40 * (peaked ? std::exp(-off / 2) : std::exp(-off * off / 8))));
    }
    const EnvironmentMap glow = map.clone();
    paint_disc(map, towards, sun_radius_degrees, Flux(20000));
    const FoundLights found = find_lights(map);
    ASSERT_EQ(found.lights.size(), 1);
    EXPECT_LT(off_by(found.lights[0], towards), 0.02);
    EXPECT_NEAR(found.lights[0].flux.y / added(map, glow).y, 1, peaked ? 1e-3 : 5e-4);
    EnvironmentMap remainder = map.clone();
    take_out(remainder, found);
    const Measures m = measure(remainder);
    EXPECT_LT(m.brightest, 60);
    EXPECT_GT(m.brightest, 30);
  }
}

// A window and a disc of the same solid angle.
TEST(Lights, ASquareWindowStaysInTheMap) {
  const Direction z(0, 0, 1);
  EnvironmentMap window = even(Projection::latlong, 512), disc = window.clone();
  const double half = 3 * degree;
  paint(window, z, 5, Flux(300), [&](const Direction& d) { return std::abs(d.x) < half && std::abs(d.y) < half; });
  paint_disc(disc, z, 3 * 2 / std::sqrt(pi), Flux(300));
  EXPECT_TRUE(find_lights(window).lights.empty());
  EXPECT_EQ(find_lights(disc).lights.size(), 1);
}

TEST(Lights, OfHostileMapsAreNoneOrRight) {
  EXPECT_TRUE(find_lights(even(Projection::latlong, 32, 0)).lights.empty());
  EXPECT_TRUE(find_lights(even(Projection::cube, 1)).lights.empty());
  EXPECT_TRUE(find_lights(even(Projection::sphere, 1)).lights.empty());
  EXPECT_TRUE(find_lights(numeric_tests::landscape(Projection::cube, 128, 1)).lights.empty());
  for (const int squares : {8, 90, 720})
    EXPECT_TRUE(find_lights(generate(Checker{.squares = squares}, Projection::latlong, 256)).lights.empty());
  for (const Projection p : all_projections)
    for (const int size : {1, 2, 3, 16, 64}) {
      EnvironmentMap map = even(p, size);
      *map.base().texel(0, map.base().width() / 2, size / 2) = Colour(1e9F);
      const FoundLights found = find_lights(map);
      if (size == 64) {
        EXPECT_EQ(found.lights.size(), 1) << name(p);
      }
      expect_flux_is_kept(map, found);
      for (const DiscLight& light : found.lights) EXPECT_TRUE(std::isfinite(light.radiance.x));
    }
  EnvironmentMap lamps = even(Projection::latlong, 512);
  std::mt19937 random(5);
  for (int k = 0; k < 3000; ++k) *lamps.base().texel(0, int(random() % 1024), 100 + int(random() % 300)) = Colour(1000);
  EXPECT_TRUE(find_lights(lamps).lights.empty());  // Each has a three thousandth of the light.
  const FoundLights some = find_lights(lamps, {.min_share = 1e-5, .most = 20});
  EXPECT_EQ(some.lights.size(), 20);
  expect_flux_is_kept(lamps, some);
}

TEST(Lights, RefuseWhatMakesNoSense) {
  EnvironmentMap map = even(Projection::cube, 8);
  EXPECT_THROW((void)find_lights(map, {.min_share = 0}), UsageError);
  EXPECT_THROW((void)find_lights(map, {.max_radius_degrees = 90}), UsageError);
  EXPECT_THROW((void)find_lights(map, {.contrast = NAN}), UsageError);
  EXPECT_THROW((void)light_error(map, {}, 0), UsageError);
  *map.base().texel(0, 1, 1) = Colour(NAN);
  EXPECT_THROW((void)find_lights(map), InputError);
}

// The bound against maps that prefiltering makes, whose own error is a hundredth of it.
TEST(Lights, ErrorsAreBelowTheirBound) {
  EnvironmentMap map = even(Projection::latlong, 256);
  const Direction towards(0.3, 0.5, 0.7);
  paint_disc(map, towards, 2, Flux(3000, 2000, 1000));
  const FoundLights found = find_lights(map);
  ASSERT_EQ(found.lights.size(), 1);
  EnvironmentMap remainder = map.clone();
  take_out(remainder, found);
  constexpr double roughness = 0.4;
  const LightError bound = light_error(map, found, roughness);
  const Ggx ggx(roughness);
  const Prefilterer whole(map), rest(remainder);
  for (const bool diffuse : {true, false}) {
    PrefilterOptions wanted{.lobe = diffuse ? Lobe::diffuse() : Lobe::ggx(roughness),
                            .to = Projection::cube,
                            .size = 24,
                            .max_error = 1e-4};
    const EnvironmentMap a = whole.make(wanted).map, b = rest.make(wanted).map;
    double worst = 0, largest = 0;
    for (const Texel& t : texels_of(a.base())) {
      const Direction n = direction_at(Projection::cube, t.face, {(t.i + 0.5) / 24, (t.j + 0.5) / 24});
      const double cosine = glm::dot(n, found.lights[0].towards);
      const double lobe = diffuse ? std::max(0.0, cosine) / pi : ggx.value(1 - cosine);
      const double lit = b.base().texel(t.face, t.i, t.j)->x + found.lights[0].flux.x * lobe;
      worst = std::max(worst, std::abs(lit - a.base().texel(t.face, t.i, t.j)->x));
      largest = std::max(largest, double(a.base().texel(t.face, t.i, t.j)->x));
    }
    const double stated = diffuse ? bound.irradiance : bound.ggx;
    EXPECT_LT(worst / largest, 1.02 * stated);  // The grid may miss the largest value.
    EXPECT_GT(worst / largest, 0.02 * stated);  // The bound says something.
    EXPECT_LT(stated, diffuse ? 0.05 : 0.2);
  }
}

}  // namespace
}  // namespace envmap::lights_test

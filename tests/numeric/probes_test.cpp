// Real probes, where there are some beside the repository.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "envmap/io/read.h"
#include "envmap/light/lights.h"
#include "envmap/operate/convert.h"
#include "envmap/operate/levels.h"
#include "envmap/operate/measure.h"
#include "numeric/painted_discs.h"

namespace envmap::probes_test {
namespace {

using namespace numeric_tests;

TEST(Probes, FluxThroughEveryProjection) {
  const std::filesystem::path folder = ENVMAP_PROBES;
  if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << "no probes";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    Source source = read(entry.path().string(), {});
    const double flux = mean_radiance(source.map.base());
    for (const Projection p : all_projections) {
      const ConvertOptions area{.to = p, .size = 40, .filter = Filter::area};
      EXPECT_NEAR(mean_radiance(convert(source.map, area).base()) / flux, 1, 1e-4) << entry << name(p);
      EXPECT_NEAR(mean_radiance(convert(source.map, {.to = p, .filter = Filter::bilinear}).base()) / flux, 1, 2e-3)
          << entry << name(p);
    }
  }
}

TEST(Probes, FluxOfEveryLevel) {
  const std::filesystem::path folder = ENVMAP_PROBES;
  if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << "no probes";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    Source source = read(entry.path().string(), {});
    for (const Projection p : all_projections) {
      EnvironmentMap map = convert(source.map, {.to = p, .size = 200, .filter = Filter::bilinear});
      add_levels(map.levels);
      for (const Level& level : map.levels) {
        const Flux off = flux_difference(level, map.base());
        EXPECT_LT(std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)}), 1e-6)
            << entry << name(p) << ": " << level.height();
      }
    }
  }
}

// A sun as large as the real one, with half of the light, painted where projections are at their worst. Sphere maps are
// left out near their singularity, where a disc is a ring.
TEST(Probes, SunsThatArePaintedIntoThemAreFound) {
  const std::filesystem::path folder = ENVMAP_PROBES;
  if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << "no probes";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const Source source = read(entry.path().string(), {});
    for (const Projection p : all_projections) {
      const EnvironmentMap sky =
          convert(source.map, {.to = p, .size = p == Projection::cube ? 512 : 1024, .filter = Filter::bilinear});
      for (const Direction& towards : {Direction(0.003, 1, 0.002), {0.001, -0.3, -1}, {1, 1, 0}, {0.6, 0.001, 0.8}}) {
        if (p == Projection::sphere && towards.z < -0.9) continue;
        EnvironmentMap map = sky.clone();
        paint_disc(map, towards, sun_radius_degrees, flux(sky.base()) / cap(sun_radius_degrees));
        const FoundLights found = find_lights(map);
        const Direction axis = glm::normalize(towards);
        const auto sun = std::ranges::min_element(found.lights, {}, [&](const DiscLight& light) {
          return angle_between(light.towards, axis);
        });
        ASSERT_NE(sun, found.lights.end());
        SCOPED_TRACE(entry.path().string() + ", " + name(p));
        EXPECT_LT(angle_between(sun->towards, axis) / degree, std::max(0.02, sun->within_degrees));
        const Flux painted = added(map, sky);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(sun->flux[c] / painted[c], 1, 1e-3);
      }
    }
  }
}

}  // namespace
}  // namespace envmap::probes_test

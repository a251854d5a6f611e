// Real probes, where there are some beside the repository.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "envmap/io/read.h"
#include "envmap/operate/convert.h"
#include "envmap/operate/levels.h"
#include "envmap/operate/measure.h"

namespace envmap::probes_test {
namespace {

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

}  // namespace
}  // namespace envmap::probes_test

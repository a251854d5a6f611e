// Real probes, where there are some beside the repository.
#include <gtest/gtest.h>

#include <filesystem>

#include "envmap/io/read.h"
#include "envmap/operate/convert.h"
#include "envmap/operate/measure.h"

namespace envmap {
namespace {

TEST(Probes, FluxThroughEveryProjection) {
  const std::filesystem::path folder = ENVMAP_PROBES;
  if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << "no probes";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    Source source = read(entry.path().string(), {});
    const double flux = mean_radiance(source.map.base());
    for (const Projection p : all_projections) {
      const Conversion area{.to = p, .size = 40, .filter = Filter::area};
      EXPECT_NEAR(mean_radiance(convert(source.map, area).base()) / flux, 1, 1e-4) << entry << name(p);
      EXPECT_NEAR(mean_radiance(convert(source.map, {.to = p, .filter = Filter::bilinear}).base()) / flux, 1, 2e-3)
          << entry << name(p);
    }
  }
}

}  // namespace
}  // namespace envmap

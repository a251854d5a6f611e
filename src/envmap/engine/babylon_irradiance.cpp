#include "envmap/engine/babylon_irradiance.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "envmap/io/formats/babylon_env.h"
#include "envmap/io/texels/api_orientation.h"
#include "envmap/io/texels/rgbd.h"
#include "envmap/map/atlas.h"
#include "envmap/map/layout.h"
#include "envmap/maths/luminance.h"
#include "envmap/prefilter/shader_sh.h"

namespace envmap {
namespace {

// The mean of the directions of the light, weighted with its luminance: 1 long where all comes from one. Degree 1 of
// irradiance over pi is M / 2 pi and degree 0 the flux / 4 pi, where M is the sum of directions x light.
Direction mean_direction(const Harmonics& radiance) {
  const ShaderSh p = shader_sh(radiance, ShBasis::filament);
  const double mean = luminance_of(p[0]);
  if (!(mean > 0)) return Direction(0);
  return Direction(luminance_of(p[3]), luminance_of(p[1]), luminance_of(p[2])) / (2 * mean);
}

}  // namespace

std::map<std::string, std::string> babylon_irradiance(const Prefilterer& source, const Harmonics& radiance) {
  constexpr int size = 64;
  const Prefiltered irradiance = source.make({.to = Projection::cube, .size = size, .max_error = 1e-3});
  const Rows rows = in_api_orientation(rows_of(irradiance.map.base(), Forward::plus_z));
  const Atlas atlas{rows, grid(Layout::api)};
  nlohmann::ordered_json about{{"size", size}, {"lengths", nlohmann::json::array()}};
  std::string digits;
  const std::vector<RgbdFaces> levels = rgbd_faces({&atlas, 1}, {});
  for (const std::vector<char>& face : levels.front()) {
    about["lengths"].push_back(face.size());
    // Parts of a sharded map carry pairs as text, so bytes are hexadecimal digits.
    for (const char byte : face) digits += fmt::format("{:02x}", static_cast<unsigned char>(byte));
  }
  // Shaders divide by its length. Light from all sides has no direction.
  constexpr double least = 1e-3;
  if (const Direction d = mean_direction(radiance); glm::length(d) > least)
    about["dominantDirection"] = {-d.x, d.y, d.z};  // Babylon.js' world is left-handed.
  return {{"irradianceTexture", about.dump()}, {"irradianceFaces", digits}};
}

}  // namespace envmap

// Diffuse light as Babylon.js 8 and newer take it in .env files: a cube of irradiance, and where the light comes from.
#pragma once

#include <map>
#include <string>

#include "envmap/prefilter/harmonics.h"
#include "envmap/prefilter/prefilter.h"

namespace envmap {

/// The pairs of WriteOptions that write_env() makes the cube of: irradiance over pi, within 1e-3 before bytes round it.
/// @param radiance the source's harmonics, without a window.
std::map<std::string, std::string> babylon_irradiance(const Prefilterer& source, const Harmonics& radiance);

}  // namespace envmap

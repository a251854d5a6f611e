// Diffuse light as Babylon.js 8 and newer take it in .env files: a cube of irradiance, and where the light comes from.
#pragma once

#include <map>
#include <string>

#include "envmap/map/environment_map.h"

namespace envmap {

/// The pairs of WriteOptions that write_env() makes the cube of: irradiance over pi, within 1e-3 before bytes round it.
std::map<std::string, std::string> babylon_irradiance(const EnvironmentMap& source);

}  // namespace envmap

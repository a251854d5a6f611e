/// @file
/// What is prefiltered: a cube or a latlong map, radiance constant over each texel.
#pragma once

#include <optional>

#include "envmap/map/environment_map.h"

namespace envmap::prefiltering {

/// The cube that is prefiltered in the place of a map of another projection: what convert() makes of it by the area filter
/// at its own density, matching_size(). Nothing for a cube and a latlong map, which are sources themselves.
std::optional<EnvironmentMap> source_cube(const EnvironmentMap& map);

}  // namespace envmap::prefiltering

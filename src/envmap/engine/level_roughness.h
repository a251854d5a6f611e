/// @file
/// The roughness of each mip level that an engine looks for.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "envmap/engine/engines.h"

namespace ENVMAP_EXPORT envmap {

/// The roughness that the engine's shader looks for in each level of a chain.
/// @param map has a chain. @param size height of a face of the first level. @param levels absent: as many as the engine
/// takes. @param size_name names `size` in the error. @throws UsageError where the size does not have so many levels.
std::vector<double> level_roughnesses(const EngineMap& map, int size, std::optional<int> levels = {},
                                      std::string_view size_name = "size");

}  // namespace envmap

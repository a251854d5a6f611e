// The background as a JPEG file with a gain map, in the place of an engine's own file.
#pragma once

#include <optional>
#include <string_view>

#include "envmap/engine/engines.h"

namespace envmap {

/// A row whose first map is background.jpg, a panorama. Nothing where the engine has no known loader of gain maps.
std::optional<Engine> with_jpeg_background(const Engine& engine);

/// Returns true for the name of a JPEG file, which holds light above white by a gain map.
bool is_jpeg(std::string_view file);

}  // namespace envmap

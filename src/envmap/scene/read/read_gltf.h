/// @file
/// glTF 2.0. Source: Khronos, "glTF 2.0 Specification" 2.0.1, and the extensions named in read_scene.h.
#pragma once

#include <string>

#include "envmap/scene/scene.h"

namespace envmap {

/// @throws InputError without the name of the file.
Scene read_gltf(const std::string& path);

}  // namespace envmap

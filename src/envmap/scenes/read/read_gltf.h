/// @file
/// glTF 2.0. Source: Khronos, "glTF 2.0 Specification" 2.0.1, and the extensions named in read_scene.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "envmap/io/files/scene_folder.h"
#include "envmap/scenes/scene/scene_graph.h"

namespace envmap {

/// @throws InputError without the name of the file.
SceneGraph read_gltf(std::span<const std::byte> file, const SceneFolder& folder, std::uint64_t max_pixels,
                     bool allow_missing = false);

}  // namespace envmap

/// @file
/// Meshes compressed by Draco, as KHR_draco_mesh_compression has them.
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "envmap/scenes/scene/scene_graph.h"

namespace envmap {

/// The attributes by Draco's own numbers.
struct DracoAttributes {
  unsigned position = 0;
  std::optional<unsigned> normal = {}, coordinate = {};
};

/// @throws InputError where the bytes are not such a mesh.
Mesh decode_draco(std::span<const std::byte> bytes, const DracoAttributes& attributes);

}  // namespace envmap

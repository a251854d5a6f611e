/// @file
/// What holds of every scene that was read.
#pragma once

#include <cstdlib>

#include "envmap/scene/scene.h"

/// Ends the process where an index leads nowhere.
inline void expect_sound(const envmap::Scene& scene) {
  for (const envmap::Node& node : scene.nodes)
    for (const int mesh : node.meshes)
      if (mesh < 0 || mesh >= static_cast<int>(scene.meshes.size())) std::abort();
  for (const envmap::Mesh& mesh : scene.meshes)
    for (const std::uint32_t corner : mesh.indices)
      if (corner >= mesh.positions.size()) std::abort();
}

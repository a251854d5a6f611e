/// @file
/// Scenes of any bytes: the file, and what holds of every one that was read.
#pragma once

#include <cstdlib>
#include <string>

#include "envmap/scenes/scene/scene_graph.h"
#include "targets.h"

/// As a file where the process runs. The first byte tells GLB and glTF from OBJ; with 'n', as in newmtl, they are the
/// materials of an OBJ file. @return the scene's name.
std::string write_scene(Bytes bytes);

/// Ends the process where an index leads nowhere.
inline void expect_sound(const envmap::SceneGraph& scene) {
  for (const envmap::Node& node : scene.nodes)
    for (const int mesh : node.meshes)
      if (mesh < 0 || mesh >= int(scene.meshes.size())) std::abort();
  for (const envmap::Mesh& mesh : scene.meshes)
    for (const std::uint32_t corner : mesh.indices)
      if (corner >= mesh.positions.size()) std::abort();
}

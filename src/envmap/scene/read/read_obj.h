/// @file
/// Wavefront OBJ with its MTL files. Source: Alias/Wavefront, "Advanced Visualizer Manual", appendix B1 (object files).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "envmap/io/scene_folder.h"
#include "envmap/scene/scene.h"

namespace envmap {

/// Polygons, as triangles; a node for each name of `o` and `g`. Where a face has no normals they are made: smooth
/// within a smoothing group, weighted by the angles at a corner (Thuermer and Wuethrich 1998), else those of the face.
/// Materials as read_mtl() says; white where a file has none, or its .mtl is missing, which Scene::remarks says.
/// @throws InputError without the name of the file.
Scene read_obj(std::span<const std::byte> file, const SceneFolder& folder, std::uint64_t max_pixels,
               bool allow_missing = false);

}  // namespace envmap

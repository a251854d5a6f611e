/// @file
/// Making meshes that come from files fit to be drawn.
#pragma once

#include <string>
#include <vector>

#include "envmap/scenes/scene/scene_graph.h"

namespace envmap {

/// Normals where there are none: those of the triangles, so corners are not shared then (glTF 2.0, 3.7.2.1). All are
/// made unit vectors; those of length 0 become that of a triangle. Texture coordinates 0 where there are none.
void complete(Mesh& mesh);

/// Makes the normal of each corner that of its triangle. Vertices are not shared.
void make_normals_flat(Mesh& mesh);

/// More corners of triangles and vertices no scene is read with.
inline constexpr std::size_t max_corners = std::size_t{1} << 27;

/// Adds to a list, such as SceneGraph::unsupported, what is not in it.
void note_once(std::vector<std::string>& list, const std::string& what);

}  // namespace envmap

/// @file
/// Wavefront OBJ with its MTL files. Source: Alias/Wavefront, "Advanced Visualizer Manual", appendix B1 (object files).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "envmap/io/files/scene_folder.h"
#include "envmap/maths/vector.h"
#include "envmap/scenes/scene/scene_graph.h"

namespace envmap {

// What the text of an OBJ file says, before it becomes a scene.

/// Faces and what they refer to. Every index is checked: into the vector of its kind, -1 where there is none.
struct ObjDocument {
  struct Corner {
    int position = 0, coordinate = -1, normal = -1;
    bool operator==(const Corner&) const = default;
  };
  struct Face {
    std::size_t first = 0;          ///< Of corners.
    int count = 0;                  ///< Three or more.
    int line = 0;                   ///< Of the text, for messages.
    int smoothing = 0;              ///< The group; 0: none.
    int group = -1, material = -1;  ///< Indices; -1: before any was named.
  };
  std::vector<Direction> positions, normals;
  std::vector<Vec2<float>> coordinates;  ///< As in the file: up from the lower edge.
  std::vector<Corner> corners;
  std::vector<Face> faces;
  std::vector<std::string> groups, materials;  ///< Names, each once.
  std::vector<std::string> libraries;          ///< What mtllib names, a line each.
  std::vector<std::string> unsupported;        ///< As SceneGraph::unsupported.
};

/// @throws InputError("line N: ...") where the text is no sound OBJ file.
ObjDocument read_obj_text(std::string_view text);

/// Polygons, as triangles; a node for each name of `o` and `g`. Where a face has no normals they are made: smooth
/// within a smoothing group, weighted by the angles at a corner (Thuermer and Wuethrich 1998), else those of the face.
/// Materials as read_mtl() says; white where a file has none, or its .mtl is missing, which SceneGraph::remarks says.
/// @throws InputError without the name of the file.
SceneGraph read_obj(std::span<const std::byte> file, const SceneFolder& folder, std::uint64_t max_pixels,
                    bool allow_missing = false);

}  // namespace envmap

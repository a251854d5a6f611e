/// @file
/// Where the nodes of a glTF file are and how they move.
#pragma once

#include <span>

#include "envmap/scene/read/gltf_document.h"
#include "envmap/scene/scene.h"

namespace envmap {

/// What a node's matrix is made of; a node that moves has no other.
struct NodeTransform {
  Direction translation{0}, scale{1};
  Quaternion rotation{1, 0, 0, 0};
};
NodeTransform node_transform(const Field& node);

/// All animations into scene.motions. @param placed where in scene.nodes each node of the document is; -1:
/// not in the scene.
void read_motions(const GltfDocument& document, std::span<const int> placed, Scene& scene);

}  // namespace envmap

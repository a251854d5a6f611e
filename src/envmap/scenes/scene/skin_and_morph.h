/// @file
/// Meshes that change their shape: morph targets, then skins (linear blend skinning), as glTF 2.0 has them (3.7.2.2,
/// 3.7.3).
/// Source: Magnenat-Thalmann, Laperriere and Thalmann 1988, "Joint-dependent local deformations for hand animation and
/// object grasping".
#pragma once

#include "envmap/scenes/scene/scene_graph.h"

namespace envmap {

/// Puts the vertices of scene.deformations where they are at a time. They are as many, and joined, as before.
/// @param pose of that time. @return the meshes of which one has moved: for Renderer::update().
std::vector<int> deform(SceneGraph& scene, const Pose& pose, double time);

}  // namespace envmap

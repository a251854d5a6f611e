/// @file
/// Which nodes of a scene are drawn as mirrors.
#pragma once

#include <vector>

#include "envmap/scenes/render/mirrors.h"
#include "envmap/scenes/view.h"

namespace envmap {

/// Those that their material makes one, but for the wishes. @param maps of those whose projection is not wished for.
/// @throws UsageError where a node is not there or has no triangles.
std::vector<Mirror> choose_mirrors(const SceneGraph& scene, const std::vector<MirrorWish>& wishes, Projection maps);

}  // namespace envmap

/// @file
/// How a map is turned towards what it is to look at.
#pragma once

#include <optional>
#include <string>

#include "envmap/maths/vector.h"
#include "envmap/scene/scene.h"

namespace envmap {

/// From a place of the world to the centre of a node, or to the scene's first camera where the name is "camera";
/// nothing where there is none of that name. Not of unit length.
std::optional<Direction> direction_to(const Scene& scene, const Pose& pose, const Direction& from,
                                      const std::string& name);

/// Viewpoint::axes that look there: Z along it, X level. @param along any length but 0. @throws UsageError
Rotation turned_to(const Direction& along);

}  // namespace envmap

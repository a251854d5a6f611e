#include "envmap/render/turn.h"

#include <cmath>

#include "envmap/base/error.h"
#include "envmap/render/draw.h"

namespace envmap {

std::optional<Direction> direction_to(const Scene& scene, const Pose& pose, const Direction& from,
                                      const std::string& name) {
  if (name == "camera") {
    if (scene.cameras.empty()) return std::nullopt;
    return Direction(pose[std::size_t(scene.cameras.front().node)][3]) - from;
  }
  if (const auto node = find_node(scene, name)) return centre_of(scene, pose, *node) - from;
  return std::nullopt;
}

Rotation turned_to(const Direction& along) {
  if (!(glm::length(along) > 0)) throw UsageError("a map cannot look at the place that it is drawn from");
  const Direction z = glm::normalize(along);
  const Direction up = std::abs(z.y) < 1 - 1e-9 ? Direction(0, 1, 0) : Direction(0, 0, 1);
  const Direction x = glm::normalize(glm::cross(up, z));
  return {x, glm::cross(z, x), z};
}

}  // namespace envmap

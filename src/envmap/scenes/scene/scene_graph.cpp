#include "envmap/scenes/scene/scene_graph.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

#include "envmap/base/error.h"
#include "envmap/scenes/scene/keyframes.h"

namespace envmap {
namespace {

Matrix local_at(const Animation& motion, double time) {
  Matrix local = glm::mat4_cast(glm::normalize(value_at(motion.rotations, time, Quaternion(1, 0, 0, 0))));
  const Direction size = value_at(motion.scales, time, Direction(1));
  for (int axis = 0; axis < 3; ++axis) local[axis] *= size[axis];
  local[3] = {value_at(motion.translations, time, Direction(0)), 1};
  return local;
}

}  // namespace

Pose pose(const SceneGraph& scene, double time) {
  Pose world(scene.nodes.size());
  for (std::size_t i = 0; i < world.size(); ++i) world[i] = scene.nodes[i].local;
  for (const Animation& motion : scene.animations) world[motion.node] = local_at(motion, time);
  for (std::size_t i = 0; i < world.size(); ++i)
    if (const int parent = scene.nodes[i].parent; parent >= 0) world[i] = world[parent] * world[i];
  return world;
}

bool is_bounded(const Pose& pose) {
  for (const Matrix& world : pose)
    for (int k = 0; k < 16; ++k)
      if (!(std::abs(world[k / 4][k % 4]) < 1e30)) return false;
  return true;
}

std::optional<int> find_node(const SceneGraph& scene, const std::string& name) {
  const auto found = std::ranges::find(scene.nodes, name, &Node::name);
  if (found == scene.nodes.end()) return std::nullopt;
  if (const auto count = std::ranges::count(scene.nodes, name, &Node::name); count > 1)
    throw UsageError(
        fmt::format("{} nodes of the scene are named '{}': give a point, or each node its own name", count, name));
  return int(found - scene.nodes.begin());
}

std::string list_nodes(const SceneGraph& scene) {
  constexpr std::size_t most = 8;
  std::set<std::string_view> names;
  std::string list;
  for (const Node& node : scene.nodes)
    if (!node.name.empty() && names.insert(node.name).second && names.size() <= most)
      list += (list.empty() ? "" : ", ") + node.name;
  if (list.empty()) return "the scene's nodes have no names";
  if (names.size() > most) list += " and " + std::to_string(names.size() - most) + " more";
  return "the scene's nodes are " + list;
}

bool has_light(const SceneGraph& scene) {
  const auto glows = [](const Material& m) { return m.emissive != Colour(0); };
  return !scene.lights.empty() || std::ranges::any_of(scene.materials, glows);
}

Rotation cofactors(const Rotation& m) {
  return {glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])};
}

bool lies_under(const SceneGraph& scene, int node, int ancestor) {
  for (; node >= 0; node = scene.nodes[node].parent)
    if (node == ancestor) return true;
  return false;
}

}  // namespace envmap

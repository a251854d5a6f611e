#include "envmap/scenes/render/draw.h"

#include <cmath>
#include <limits>

#include "envmap/base/error.h"
#include "envmap/maths/check_direction.h"
#include "envmap/projection/visit.h"

namespace envmap {

std::vector<Instance> instances(const SceneGraph& scene) {
  std::vector<Instance> all;
  for (std::size_t node = 0; node < scene.nodes.size(); ++node)
    for (const int mesh : scene.nodes[node].meshes) all.push_back({int(node), mesh});
  return all;
}

std::size_t triangles(const SceneGraph& scene) {
  std::size_t count = 0;
  for (const Instance& i : instances(scene)) count += scene.meshes[i.mesh].indices.size() / 3;
  return count;
}

bool is_smooth(const Material& m) {
  // Glass is seldom given a roughness of 0, and shows little of a small one.
  constexpr float metal = 0.001F;
  return m.roughness < (m.transmission > 0 ? smooth_glass : metal);
}

bool casts_shadow(const Material& m) { return m.transmission == 0; }

Vec2<double> sample_offset(int sample, int samples) {
  // Korobov's lattice with the golden ratio; its first point moved to the middle of its cell.
  const double along = (sample + 0.5) / samples, across = (sample + 0.5) * 0.6180339887498949;
  if (samples == 1) return Vec2<double>(0);
  return {along - 0.5, across - std::floor(across) - 0.5};
}

void sample_directions(Projection p, int size, int face, int row, const Vec2<double>& offset,
                       std::span<Direction> out) {
  const int first = columns(p, size, row).first;
  if (offset == Vec2<double>(0)) return texel_directions(p, size, face, row, first, out);
  const bool stop_at_rim = visit(p, [](auto q) { return decltype(q)::on_disc && !decltype(q)::filled; });
  std::vector<Vec2<double>> points(out.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    Vec2<double>& at = points[k];
    at = {(first + double(k) + 0.5 + offset.x) / (size * aspect(p)), (row + 0.5 + offset.y) / size};
    if (const double r = glm::length(2.0 * at - 1.0); stop_at_rim && r > 1) at = 0.5 + (at - 0.5) / r;
  }
  directions(p, face, points, out);
}

namespace {

// Nothing is in it while low is above high.
struct Box {
  Direction low = Direction(std::numeric_limits<double>::infinity()), high = -low;

  void add(const Box& other) { low = glm::min(low, other.low), high = glm::max(high, other.high); }
  [[nodiscard]] Direction centre_or(const Direction& otherwise) const {
    return low.x > high.x ? otherwise : 0.5 * (low + high);
  }
};

Box box_of(const Mesh& mesh, const Matrix& world) {
  Box box;
  for (const glm::vec3& p : mesh.positions) {
    const Direction place(world * glm::vec<4, double, glm::highp>(p, 1));
    box.add({place, place});
  }
  return box;
}

}  // namespace

Direction centre_of(const SceneGraph& scene, const Pose& pose, int node) {
  Box box;
  for (const Instance& i : instances(scene))
    if (lies_under(scene, i.node, node)) box.add(box_of(scene.meshes[i.mesh], pose[i.node]));
  return box.centre_or(Direction(pose[node][3]));
}

std::vector<Direction> centres_of_nodes(const SceneGraph& scene, const Pose& pose) {
  std::vector<Box> boxes(scene.nodes.size());
  for (const Instance& i : instances(scene)) {
    const Box box = box_of(scene.meshes[i.mesh], pose[i.node]);
    for (int node = i.node; node >= 0; node = scene.nodes[node].parent) boxes[node].add(box);
  }
  std::vector<Direction> centres;
  for (std::size_t k = 0; k < boxes.size(); ++k) centres.push_back(boxes[k].centre_or(Direction(pose[k][3])));
  return centres;
}

std::optional<Direction> direction_to(const SceneGraph& scene, const Pose& pose, const Direction& from,
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
  // The squares of very long directions are infinite.
  const Direction z = glm::normalize(std::isfinite(glm::length(along)) ? along : checked_direction("towards", along));
  const Direction up = std::abs(z.y) < 1 - 1e-9 ? Direction(0, 1, 0) : Direction(0, 0, 1);
  const Direction x = glm::normalize(glm::cross(up, z));
  return {x, glm::cross(z, x), z};
}

}  // namespace envmap

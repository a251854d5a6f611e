#include "envmap/scenes/scene.h"

#include <utility>

#include "envmap/operate/check_options.h"
#include "envmap/scenes/read/read_scene.h"
#include "envmap/scenes/scene/camera.h"
#include "envmap/scenes/scene_state.h"

namespace envmap {
namespace {

// Skins and morph targets stand as they do at time 0, whatever is drawn first.
LitScene at_rest(SceneGraph scene) {
  LitScene lit{.scene = std::move(scene)};
  lit.move_to(0);
  return lit;
}

}  // namespace

Scene::Scene(std::unique_ptr<State> state) : state_(std::move(state)) {}
Scene::~Scene() = default;
Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;

Scene Scene::read(const std::string& path, const SceneReadOptions& o) {
  if (!o.folder.empty()) throw UsageError("folder is for a scene in memory: a file names what lies in its own");
  return Scene(std::make_unique<State>(path, at_rest(read_scene(path, o.max_pixels, o.allow_missing))));
}

Scene Scene::read(std::span<const std::byte> file, const SceneReadOptions& o) {
  return Scene(
      std::make_unique<State>(scene_in_memory, at_rest(read_scene(file, o.folder, o.max_pixels, o.allow_missing))));
}

std::vector<std::string> Scene::nodes() const {
  std::vector<std::string> names;
  for (const Node& node : state_->lit.scene.nodes) names.push_back(node.name);
  return names;
}

std::vector<std::string> Scene::remarks() const { return remarks_on(state_->lit.scene); }

SceneBox Scene::box(double time_seconds) const {
  check_range({"time_seconds", -1e6, 1e6}, time_seconds);
  const auto turn = wait_for_turn(state_->in_use, {});
  for (const int mesh : state_->lit.move_to(time_seconds)) state_->moved.insert(mesh);
  const Extent all = extent(state_->lit.scene, pose(state_->lit.scene, time_seconds));
  return {all.low, all.high};
}

}  // namespace envmap

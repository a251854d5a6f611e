#include "envmap/scenes/viewpoints.h"

#include <fmt/ranges.h>

#include <algorithm>

#include "envmap/base/error.h"

namespace envmap {
namespace {

constexpr double default_field = 40;  // Degrees.

const Camera& camera_named(const std::string& name, const SceneGraph& scene, const std::string& path) {
  for (const Camera& camera : scene.cameras)
    if (camera.name == name || scene.nodes[std::size_t(camera.node)].name == name) return camera;
  std::vector<std::string> names;
  for (const Camera& camera : scene.cameras) names.push_back(camera.name);
  throw UsageError(fmt::format("camera '{}' is neither a point X,Y,Z nor a camera of {}, which has {}", name, path,
                               scene.cameras.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
}

}  // namespace

Viewpoints::Viewpoints(const ViewpointOptions& options, double aspect, const SceneGraph& scene, const std::string& path,
                       const Pose& first)
    : look_at_(options.look_at),
      scene_(scene),
      path_(path),
      orbit_(options.orbit_degrees),
      ball_(bounds(scene, first)) {
  const auto to_radians = [](double degrees) { return degrees * pi / 180; };
  const auto& field = options.vertical_field_degrees;
  const auto* const point = options.camera ? std::get_if<Direction>(&*options.camera) : nullptr;
  if (point != nullptr || (!options.camera && scene.cameras.empty())) {
    still_ = framing(ball_, to_radians(field.value_or(default_field)), aspect);
    if (point == nullptr) return;
    still_->at = *point;
    if (!look_at_) look_at_ = ball_.centre;
    return;
  }
  camera_ = options.camera ? camera_named(std::get<std::string>(*options.camera), scene, path) : scene.cameras.front();
  if (field) camera_.vertical_field = to_radians(*field), camera_.half_height = 0;
}

View Viewpoints::camera_view(const Pose& pose) const {
  try {
    return view_of(camera_, pose);
  } catch (const InputError& e) {
    throw InputError(path_, e.what());
  }
}

View Viewpoints::view(const Pose& pose, double part) const {
  View view = still_ ? *still_ : camera_view(pose);
  if (look_at_) view = looking_at(view, *look_at_);
  view = carried_round(view, look_at_.value_or(ball_.centre), part * orbit_);
  if (view.half_height > 0) {
    const Ball ball = bounds(scene_, pose);
    const double end = glm::dot(view.at - ball.centre, view.axes[2]) + 1.001 * ball.radius;
    view.far = std::clamp(end, 2 * view.near, std::max(view.far, 2 * view.near));
  }
  return view;
}

}  // namespace envmap

// Where pictures of a scene are taken from.
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "envmap/scenes/scene/camera.h"
#include "envmap/scenes/scene/scene_graph.h"

namespace envmap {

struct ViewpointOptions {
  /// A point, or the name of a camera or its node. Absent: the scene's first camera, or all of the scene in sight.
  std::optional<std::variant<Direction, std::string>> camera = {};
  std::optional<Direction> look_at = {};
  std::optional<double> vertical_field_degrees = {};
  double orbit_degrees = 0;  ///< During the whole sequence.
};

// A point, a camera of the scene, or, where there is none, all of it in sight.
class Viewpoints {
 public:
  // @param aspect width over height. @param path of the scene's file. @param first where things are at the start.
  Viewpoints(const ViewpointOptions& options, double aspect, const SceneGraph& scene, const std::string& path,
             const Pose& first);

  // Whether the scene has no camera, and none was given.
  [[nodiscard]] bool is_framed() const { return still_ && !look_at_; }

  // Of an orthographic camera the far plane is no further than it must be, so that nearness has its digits.
  // @param part of the orbit, from 0 to 1. @throws InputError where the camera has no axes.
  [[nodiscard]] View view(const Pose& pose, double part) const;

 private:
  [[nodiscard]] View camera_view(const Pose& pose) const;

  std::optional<Direction> look_at_;
  const SceneGraph& scene_;
  std::string path_;
  double orbit_;
  Ball ball_;
  std::optional<View> still_;  // Or the scene's camera, which may move.
  Camera camera_;
};

}  // namespace envmap

// Where pictures of a scene are taken from.
#pragma once

#include <optional>
#include <string>

#include "envmap/scene/camera.h"
#include "envmap/scene/scene.h"

namespace tools {

struct ViewpointOptions {
  std::string camera;  // X,Y,Z or a camera's name; empty: the scene's first, or all of it in sight.
  std::optional<envmap::Direction> look_at;
  std::optional<double> fov;  // Degrees.
  double orbit = 0;           // Degrees, of the whole sequence.
};

// A point, a camera of the scene, or, where there is none, all of it in sight.
class Viewpoints {
 public:
  // @param aspect width over height. @param path of the scene's file. @param first where things are at the start.
  Viewpoints(const ViewpointOptions& options, double aspect, const envmap::Scene& scene, const std::string& path,
             const envmap::Pose& first);

  // Whether the scene has no camera, and none was given.
  [[nodiscard]] bool is_framed() const { return still_ && !look_at_; }

  // Of an orthographic camera the far plane is no further than it must be, so that nearness has its digits.
  // @param part of the orbit, from 0 to 1.
  [[nodiscard]] envmap::View view(const envmap::Pose& pose, double part) const;

 private:
  std::optional<envmap::Direction> look_at_;
  const envmap::Scene& scene_;
  double orbit_;
  envmap::Ball ball_;
  std::optional<envmap::View> still_;  // Or the scene's camera, which may move.
  envmap::Camera camera_;
};

}  // namespace tools

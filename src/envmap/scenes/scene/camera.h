/// @file
/// Where a picture of a scene is taken from: a camera of its own, a point, or wherever all of it is in sight.
#pragma once

#include "envmap/maths/vector.h"
#include "envmap/scenes/scene/scene_graph.h"

namespace envmap {

/// A pinhole or an orthographic camera in the world.
struct View {
  Direction at{0};
  Rotation axes{1};             ///< Columns: right, up, and against the line of sight.
  double vertical_field = 0.8;  ///< Whole angle in radians.
  double half_height = 0;       ///< Camera::half_height.
  double near = 0.01, far = 1000;
};

/// @throws InputError, without the name of the file, where the camera has no axes: a scale is 0.
View view_of(const Camera& camera, const Pose& pose);

struct Ball {
  Direction centre{0};
  double radius = 0;
};
/// Round all that is drawn: the middle of the box along the axes, and the farthest vertex.
/// Of nothing a ball of radius 0.
Ball bounds(const SceneGraph& scene, const Pose& pose);

/// The corners of that box. Of nothing the origin.
struct Extent {
  Direction low{0}, high{0};
};
Extent extent(const SceneGraph& scene, const Pose& pose);

/// Turns a view to a point, +Y up; where it looks straight up or down, +Z or -Z is up in the picture. @throws
/// UsageError where the point is the eye's own.
View looking_at(View view, const Direction& point);

/// Carries a view round the vertical line through a point, to the east as seen from above the front. @param degrees
View carried_round(View view, const Direction& point, double degrees);

/// All of a ball in sight, from its front (+Z, where models of glTF look), a little to the right and from above.
/// @param vertical_field radians. @param aspect width over height of the picture.
View framing(const Ball& ball, double vertical_field, double aspect);

}  // namespace envmap

#include "envmap/scenes/scene/camera.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "envmap/base/error.h"

namespace envmap {
namespace {

constexpr double degree = pi / 180;

template <class F>
void for_vertices(const SceneGraph& scene, const Pose& pose, F&& f) {
  for (std::size_t n = 0; n < scene.nodes.size(); ++n)
    for (const int mesh : scene.nodes[n].meshes)
      for (const glm::vec3& p : scene.meshes[std::size_t(mesh)].positions)
        f(Direction(pose[n] * glm::vec<4, double, glm::highp>(p, 1)));
}

}  // namespace

View view_of(const Camera& camera, const Pose& pose) {
  const Matrix& world = pose[std::size_t(camera.node)];
  // The scale of a camera's node does not count (glTF 2.0, "View Matrix"), and parents may shear it.
  const Direction back = unit(Direction(world[2])), right = unit(glm::cross(unit(Direction(world[1])), back));
  if (right == Direction(0))
    throw InputError(fmt::format("camera '{}' has a scale of 0: give it another", camera.name));
  return {.at = Direction(world[3]),
          .axes = {right, glm::cross(back, right), back},
          .vertical_field = camera.vertical_field,
          .half_height = camera.half_height,
          .near = camera.near,
          .far = camera.far};
}

Extent extent(const SceneGraph& scene, const Pose& pose) {
  constexpr double far = std::numeric_limits<double>::max();
  Direction least(far), most(-far);
  for_vertices(scene, pose, [&](const Direction& p) { least = glm::min(least, p), most = glm::max(most, p); });
  if (least.x > most.x) return {};
  return {least, most};
}

Ball bounds(const SceneGraph& scene, const Pose& pose) {
  const Extent all = extent(scene, pose);
  Ball ball{0.5 * all.low + 0.5 * all.high, 0};
  for_vertices(scene, pose,
               [&](const Direction& p) { ball.radius = std::max(ball.radius, glm::length(p - ball.centre)); });
  return ball;
}

View looking_at(View view, const Direction& point) {
  const Direction back = view.at - point;
  if (!(glm::length(back) > 0)) throw UsageError("a camera cannot look at the point that it stands on");
  view.axes = upright_about(glm::normalize(back));
  return view;
}

View carried_round(View view, const Direction& point, double degrees) {
  const double c = std::cos(degrees * degree), s = std::sin(degrees * degree);
  const Rotation turn(Direction(c, 0, -s), Direction(0, 1, 0), Direction(s, 0, c));  // Of +Z towards +X.
  view.at = point + turn * (view.at - point);
  view.axes = turn * view.axes;
  return view;
}

View framing(const Ball& ball, double vertical_field, double aspect) {
  const double radius = ball.radius > 0 ? ball.radius : 1, up = 0.5 * vertical_field;
  const double distance = radius / std::sin(std::min(up, std::atan(std::tan(up) * aspect)));
  constexpr double azimuth = 30 * degree, elevation = 20 * degree;
  const Direction front(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                        std::cos(azimuth) * std::cos(elevation));
  return looking_at({.at = ball.centre + distance * front,
                     .vertical_field = vertical_field,
                     .near = 1e-3 * distance,
                     .far = 1e3 * distance},
                    ball.centre);
}

}  // namespace envmap

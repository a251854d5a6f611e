#include "envmap/scenes/stereo.h"

#include <algorithm>

#include "envmap/base/error.h"
#include "envmap/maths/portable.h"

namespace envmap {

Eye eye_of(const PictureSize& picture, const View& view, double aside, double still) {
  const Rotation& axes = view.axes;
  const bool parallel = view.half_height > 0;
  if (parallel && aside != 0)
    throw UsageError("the camera is orthographic, so both eyes of a stereo picture see the same");
  const double half = 0.5 * view.vertical_field;
  const double up = parallel ? view.half_height : portable::sin(half) / portable::cos(half),
               across = up * picture.width / picture.height;
  Eye eye;
  eye.from = {.size = picture.height,
              .at = view.at + aside * axes[0],
              .axes = axes,
              .near = std::max(view.near, 1e-6),
              .far = view.far,
              .samples = picture.samples,
              .cull = picture.cull,
              .lens = Lens{picture.width, {across, up}, aside == 0 ? 0 : aside / (still * across), parallel}};
  // The sides of the picture as planes through the eye, a little outside of them.
  const auto side = [&](const Direction& inwards, double beyond = 0) {
    const Direction normal = glm::normalize(axes * inwards);
    return Plane(normal, -glm::dot(normal, eye.from.at) + 1e-3 + beyond);
  };
  if (parallel) {
    const double distance = 1e4 * portable::hypot(across, up);  // As good as from infinity.
    eye.viewer = {.at = view.at + distance * axes[2],
                  .planes = {side({1, 0, 0}, across), side({-1, 0, 0}, across), side({0, 1, 0}, up),
                             side({0, -1, 0}, up), side({0, 0, -1})},
                  .pixel = 2 * up / picture.height / distance};
    return eye;
  }
  const double shift = eye.from.lens->shift;
  eye.viewer = {.at = eye.from.at,
                .planes = {side({1, 0, -across * (1 + shift)}), side({-1, 0, -across * (1 - shift)}), side({0, 1, -up}),
                           side({0, -1, -up}), side({0, 0, -1})},
                .pixel = 2 * up / picture.height};
  return eye;
}

}  // namespace envmap

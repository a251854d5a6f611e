// Cameras as the renderer takes them.
#pragma once

#include "envmap/scenes/render/draw.h"
#include "envmap/scenes/render/visible_directions.h"
#include "envmap/scenes/scene/camera.h"

namespace envmap {

// A picture of so many pixels.
struct PictureSize {
  int width, height, samples;
  bool cull = true;
};

struct Eye {
  Viewpoint from;
  Viewer viewer;
};

// What is seen from beside a view by `aside` metres; at `still` metres both eyes see the same.
// @throws UsageError where rays are parallel and both eyes would see the same.
Eye eye_of(const PictureSize& picture, const View& view, double aside = 0, double still = 1);

}  // namespace envmap

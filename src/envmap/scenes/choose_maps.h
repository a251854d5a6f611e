// How mirrors are best drawn through maps where a picture may be so far off.
#pragma once

#include <functional>
#include <vector>

#include "envmap/scenes/render/mirrors.h"
#include "envmap/scenes/stereo.h"

namespace envmap {

// A picture through maps that begin empty.
std::vector<Colour> picture_through_maps(Renderer& renderer, const FrameState& shot, const std::vector<Mirror>& mirrors,
                                         const Eye& eye, const MirrorOptions& drawing);

// A picture that is wanted.
struct Moment {
  FrameState shot;
  Eye eye;
  std::function<void()> arrive = [] {};  // Moves the vertices of the scene and of the renderer there.
};

struct MapChoice {
  bool rays = false;  // No maps are good enough.
  MirrorLookup lookup = MirrorLookup::distance;
  MirrorOptions drawing;
  double error = 0;  // Against rays, the largest of all moments.
};

// The cheapest maps whose pictures are off by `max_error` at most. The error is the rms of the difference over that of
// the picture by rays. Tries increasing map sizes with distance lookup until one is accurate enough, then tries fewer
// rounds and direction lookup.
// @param drawing near, far and method.
// @param lobe_samples of the picture by rays: 0 leaves the errors of rough reflections out.
MapChoice choose_maps(Renderer& renderer, const std::vector<Mirror>& mirrors, std::vector<Moment> moments,
                      const MirrorOptions& drawing, double max_error, int lobe_samples);

}  // namespace envmap

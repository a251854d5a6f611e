// How mirrors are best drawn through maps where a picture may be so far off.
#pragma once

#include <vector>

#include "envmap/render/mirrors.h"
#include "scenes/eyes.h"

namespace tools {

// A picture through maps that begin empty.
std::vector<envmap::Colour> picture_through_maps(envmap::Renderer& renderer, const envmap::Shot& shot,
                                                 const std::vector<envmap::Mirror>& mirrors, const Eye& eye,
                                                 const envmap::MirrorOptions& drawing);

// A picture that is wanted.
struct Moment {
  envmap::Shot shot;
  Eye eye;
};

struct MapChoice {
  bool rays = false;  // No maps are good enough.
  envmap::MirrorLookup lookup = envmap::MirrorLookup::distance;
  envmap::MirrorOptions drawing;
  double error = 0;  // Of the maps, the largest of all moments.
};

// The cheapest maps whose pictures are off by `max_error` at most. The error is the rms of the difference over that of
// the picture by rays. Tries increasing map sizes with distance lookup until one is accurate enough, then tries fewer
// rounds and direction lookup.
// @param drawing near, far and method.
MapChoice choose_maps(envmap::Renderer& renderer, const std::vector<envmap::Mirror>& mirrors,
                      std::vector<Moment> moments, const envmap::MirrorOptions& drawing, double max_error);

}  // namespace tools

/// @file
/// Which way of drawing is the cheapest that is right.
#pragma once

#include <cstddef>

#include "envmap/scenes/render/draw.h"
#include "envmap/scenes/render/drawing_method.h"

namespace envmap {

/// Whether a map can be drawn so, which says of a projection that is new whether it waits for shaders. resample and
/// raycast draw any.
bool can_draw(DrawMethod method, Projection to);

/// What a map takes its time for.
struct DrawLoad {
  std::size_t triangles = 0;
  std::size_t lights = 0;         ///< With shadows, those of the environment among them.
  std::size_t shadow_texels = 0;  ///< Of their shadow maps.
  std::size_t more_rays = 0;      ///< Beside one a light, where rays find the shadows of suns.
};

DrawLoad draw_load(const FrameState& shot);

/// Nanoseconds that a map takes, by a straight line through measurements (docs/explanation/dynamic-maps.md):
/// so much for each texel drawn and each of its shadows, for each texel of shadow maps, and for each triangle in each
/// face it is sent to. Ratios carry over to other machines, not the figures.
/// @param method exact, resample or raycast. @param card whether OpenGL draws on a graphics card.
double estimated_cost(DrawMethod method, Projection to, int size, const DrawLoad& load, bool card = false);

/// exact, resample or raycast, whichever costs least. @param rays whether raycast may be chosen.
DrawMethod cheapest(Projection to, int size, const DrawLoad& load, bool rays = true, bool card = false);

}  // namespace envmap

/// @file
/// Which way of drawing is the cheapest that is right.
#pragma once

#include <cstddef>

#include "envmap/render/method.h"

namespace envmap {

/// Nanoseconds that a map takes, by a straight line through measurements (docs/explanation/dynamic-maps.md):
/// so much for each texel drawn, and so much for each triangle in each face it is sent to. Ratios carry over to other
/// machines, not the figures.
/// @param method exact, resample or raycast. @param card whether OpenGL draws on a graphics card.
double estimated_cost(DrawMethod method, Projection to, int size, std::size_t triangles, bool card = false);

/// exact, resample or raycast, whichever costs least. @param rays whether raycast may be chosen.
DrawMethod cheapest(Projection to, int size, std::size_t triangles, bool rays = true, bool card = false);

}  // namespace envmap

/// @file
/// The reference among the ways of drawing: a ray for each sample of each texel, through Embree's tree of boxes.
#pragma once

#include "envmap/base/progress.h"
#include "envmap/render/draw.h"

namespace envmap {

/// Each texel shows what its own ray meets first between the spheres `near` and `far`, lit by shade(). Sides that a
/// material does not show let the ray through (glTF's doubleSided), as do holes of its alpha_cutoff.
///
/// Triangles are moved to the viewpoint in double and rounded to float32 there, and so are rays; what a ray meets in a
/// triangle is found in double. The tree is built anew for each map. The same bytes at any number of threads.
/// Source: Wald et al. 2014, "Embree: a kernel framework for efficient CPU ray tracing".
/// @param progress may be empty.
/// @throws UsageError where Embree runs out of memory.
Drawn raycast(const Shot& shot, const Viewpoint& from, const Progress& progress = {});

}  // namespace envmap

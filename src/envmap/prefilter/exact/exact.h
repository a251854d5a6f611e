/// @file
/// The reference method: every texel of the source is integrated in double, by Gauss points where the lobe is smooth
/// over it and round its border elsewhere (lobe_in_rectangle.h). Its error is at most 1e-7 of the largest part of a
/// result that one texel has, or 1e-13 of the source's mean.
#pragma once

#include <span>
#include <vector>

#include "envmap/base/run.h"
#include "envmap/map/environment_map.h"
#include "envmap/operate/measure.h"
#include "envmap/prefilter/lobe_formulas.h"
#include "envmap/sample/target_grid.h"

namespace envmap::prefiltering {

/// Returns the integrals of radiance x lobe over the sphere in some directions, in the image frame of the source.
std::vector<Flux> exact_prefilter(const Level& source, const LobeFormula& lobe, std::span<const Direction> directions,
                                  const Progress& progress = {});

/// Directions of texels of a target, in the image frame of the source.
std::vector<Direction> directions_of(const Target& target, std::span<const Texel> texels);

/// Sets some texels of a map. @param out of the projection and size of the target.
void exact_texels(const Level& source, const LobeFormula& lobe, const Target& target, std::span<const Texel> texels,
                  Level& out, const Progress& progress = {});

}  // namespace envmap::prefiltering

/// @file
/// The reference: every texel of the source, in float64.
#pragma once

#include <span>
#include <vector>

#include "envmap/base/run.h"
#include "envmap/map/environment_map.h"
#include "envmap/operate/measure.h"
#include "envmap/prefilter/lobe.h"
#include "envmap/sample/target_grid.h"

namespace envmap::prefiltering {

/// The integral of radiance x lobe over the sphere, radiance constant over each texel, in the directions given (image
/// frame of the source). To 1e-7 of the largest part of a result that one texel has, or 1e-13 of the source's mean.
///
/// A texel over which the lobe is smooth takes Gauss points. Where it is not, because the lobe is narrower than the
/// texel or its horizon crosses it, the area becomes a line: with S the lobe's share within an angle, the integral of
/// the lobe over a piece of the sphere is that of S / (2 pi) d(azimuth) round its border (Green's theorem), which no
/// width of the lobe makes hard, down to the mirror.
std::vector<Flux> exact_prefilter(const Level& source, const Lobe& lobe, std::span<const Direction> directions,
                                  const Progress& progress = {});

/// Where texels of a target look, image frame of the source.
std::vector<Direction> directions_of(const Target& target, std::span<const Texel> texels);

/// Sets some texels of a map. @param out of the projection and size of the target.
void exact_texels(const Level& source, const Lobe& lobe, const Target& target, std::span<const Texel> texels,
                  Level& out, const Progress& progress = {});

}  // namespace envmap::prefiltering

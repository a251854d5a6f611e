/// @file
/// The reference: every texel of the source, in float64.
#pragma once

#include <span>
#include <vector>

#include "envmap/map/environment_map.h"
#include "envmap/operate/progress.h"
#include "envmap/prefilter/lobe.h"

namespace envmap {

/// The integral of radiance x lobe over the sphere, radiance constant over each texel, in the directions given (image
/// frame of the source). To 1e-7 of the largest part of a result that one texel has.
///
/// A texel over which the lobe is smooth takes Gauss points. Where it is not, because the lobe is narrower than the texel or
/// its horizon crosses it, the area becomes a line: with S the lobe's share within an angle, the integral of the lobe over a
/// piece of the sphere is that of S / (2 pi) d(azimuth) round its border (Green's theorem), which no width of the lobe
/// makes hard, down to the mirror.
std::vector<Flux> exact_prefilter(const Level& source, const Lobe& lobe, std::span<const Direction> directions,
                                  const Progress& progress = {});

}  // namespace envmap

/// @file
/// The reference filter: the solid-angle mean of the bilinear reconstruction over each texel.
#pragma once

#include "envmap/sample/padded_level.h"
#include "envmap/sample/sampler.h"
#include "envmap/sample/target_grid.h"

namespace envmap {

/// The outline of each texel is followed through the direction map as a polygon (outline.h), over which the
/// reconstruction is integrated exactly (coverage.h). Neighbours have the same outlines: what one texel loses the other
/// gains, and the light of the source is kept. What is left is the bend of the outline between its points, which are
/// set as densely as the tolerance asks for.
///
/// Over the seam and the poles of a latlong map the outline goes on; at the edges of a cube and the creases of an
/// octahedral map it is cut. Texels whose outline meets the rim of a disc in the source, or that look towards -Z of a
/// sphere map, are left to adaptive_sampler(). Where the solid angle is not linear over a texel to the tolerance (at
/// 1e-4 in latlong maps of less than 140 rows), the texels are divided first, which changes nothing of the
/// reconstruction; where that would make a source of over 4096 x 4096 texels, adaptive_sampler() takes them all, as it
/// does of the photo of a ball by a camera near it.
/// @param source must outlive the sampler.
/// @param tolerance how far an outline may bend, in source texels, or over its own thickness where that is less. Texels
/// are right to that, relative to the larger of their value and `floor`, but where a sun is cut in two.
/// @param estimates also takes means that change by less than half the tolerance when sides get twice the pieces.
Sampler area_sampler(const PaddedLevel& source, const Target& target, double tolerance, double floor,
                     bool estimates = false);

}  // namespace envmap

/// @file
/// The area filter where straight sides are enough.
#pragma once

#include "envmap/sample/padded_level.h"
#include "envmap/sample/sampler.h"
#include "envmap/sample/target_grid.h"

namespace envmap {

/// Whether quad_sampler() takes a conversion: from maps without rims and creases, seen from infinitely far away.
bool quads_suit(const PaddedLevel& source, const Target& target);

/// The solid-angle mean of the bilinear reconstruction over the quadrilateral between a texel's corners, several texels
/// at a time. The quadrilateral is moved so that the curved sides lose as much as they gain, and the density of solid
/// angle is linear over it.
///
/// The area that is left between the quadrilateral and the curved sides, times the range of the texels below, bounds
/// the error. Where it is over the tolerance, the texel is divided into 2 x 2, 4 x 4 and 8 x 8 quadrilaterals. That
/// ends when the bound is within the tolerance, or within 8 times the tolerance while the mean changes by less than a
/// quarter of it. area_sampler() makes what 8 x 8 do not settle, and texels at edges, poles and rims.
/// @param source must outlive the sampler.
/// @param tolerance relative to the larger of the texel and `floor`.
/// @param estimates false: only bounds count, and area_sampler() estimates nothing.
Sampler quad_sampler(const PaddedLevel& source, const Target& target, double tolerance, double floor,
                     bool estimates = true);

}  // namespace envmap

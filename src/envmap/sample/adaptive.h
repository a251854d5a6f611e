/// @file
/// The area filter by sampling, for any footprint: the solid-angle mean of the bilinear reconstruction over each texel.
#pragma once

#include "envmap/sample/padded_level.h"
#include "envmap/sample/sampler.h"
#include "envmap/sample/target_grid.h"

namespace envmap {

/// Adaptive quadrature by 2 x 2 Gauss points over cells no larger than a source texel. The reconstruction is smooth but
/// for kinks where it passes from one patch of four texels to the next, and it never leaves the range of their values:
/// that range bounds the error of a cell, so that none is accepted because its samples happen to agree. Cells are
/// quartered until the bounds, added up as independent errors, are below the tolerance, or there are too many.
/// @param source must outlive the sampler.
/// @param tolerance of a texel, relative to the larger of its value and `floor`.
Sampler adaptive_sampler(const PaddedLevel& source, const Target& target, double tolerance, double floor);

/// The same of any rectangle of a face of the result, from (u,v) `low` to `high`. It may reach beyond the sides of a
/// cube's face, whose plane goes on.
Colour adaptive_mean(const PaddedLevel& source, const Target& target, double tolerance, double floor, int face,
                     const Point2& low, const Point2& high);

}  // namespace envmap

/// @file
/// Where a sphere map's bilinear reconstruction shows a direction.
#pragma once

#include <span>

#include "envmap/projection/projection.h"

namespace envmap {

/// Locations at which bilinear interpolation between the texels of a map shows the given directions.
///
/// For all projections but one that is locate(), within a few thousandths of a texel. Towards the rim of a sphere map
/// the direction goes with the square root of the distance from the rim, and a straight line between two texels misses
/// it by up to a quarter of their (large) distance. There the location is moved, by less than a texel, to where
/// interpolation of the texels' own directions gives the direction asked for: Newton's method on the bilinear patch.
/// @param size height of a face.
void locate_for_bilinear(Projection p, int size, std::span<const Direction> directions,
                         std::span<Location<double>> out);

/// The z of a direction below which locate_for_bilinear() is not locate().
double bilinear_bends_below(Projection p, int size);

}  // namespace envmap

/// @file
/// The gutter: what lies beyond the edges of a face, found through the projection.
#pragma once

#include "envmap/map/environment_map.h"

namespace envmap {

/// Fills every texel that a filter may read but that is no part of the image: the border of `Level::gutter` texels
/// around each face and, where a disc carries the weight, the texels whose centres lie up to that far outside it.
/// Each gets the bilinear value of the map in the direction that the projection continues to. After this, filters are
/// seamless over edges, corners, poles and rims with no special case of their own.
///
/// A gutter texel beside an edge is read from texels of which some are gutter themselves (with a weight of about half a
/// texel / size on a cube, more on a rim): the values are found by iteration, which contracts.
void fill_gutter(Level& level);

}  // namespace envmap

/// @file
/// The size of a map that resolves as much as a map of another projection.
#pragma once

#include "envmap/projection/projection.h"

namespace ENVMAP_EXPORT envmap {

/// Height of a face of `to` with the degrees per texel of a `from` face `size` high, along the height of each
/// (latlong 2N high, cube N, paraboloid and octahedral maps 2N, sphere and angular 4N); at least 1.
int matching_size(Projection from, int size, Projection to);

}  // namespace envmap

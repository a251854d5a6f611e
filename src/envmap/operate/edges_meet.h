/// @file
/// Whether an image that is taken for a map by its shape can be one.
#pragma once

#include "envmap/map/environment_map.h"

namespace envmap {

/// Whether the texels along the sides of faces go on where the projection says: at the next face of a cube, at the
/// other side of a latlong map and beyond its poles. Photos and faces in another order jump there. True of small maps,
/// which say too little, and of projections whose sides carry no weight.
bool edges_meet(const Level& level);

}  // namespace envmap

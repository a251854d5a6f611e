/// @file
/// The area filter from the source's side, for results much coarser than it: each texel of the source gives its light to
/// the texels of the result that it lies in.
#pragma once

#include "envmap/map/environment_map.h"
#include "envmap/sample/target.h"

namespace envmap {

/// The same means as area_sampler(), at a cost that grows with the source alone, and with the flux kept by construction:
/// first-order conservative remapping (Jones 1999, "First- and second-order conservative remapping schemes for grids in
/// spherical coordinates") with the bilinear reconstruction integrated exactly over every part.
///
/// A texel of the source whose four corners fall into one texel of the result counts there whole. The others are cut
/// along the borders of the result's texels, after quartering them where their light is too uneven, or the map between
/// the two images too bent, for the tolerance.
/// @param source its gutter filled. @param tolerance, floor as of area_sampler().
/// @return the result whole; texels in which nothing falls, such as the corners of a paraboloid map, come from
/// area_sampler().
Level conservative_area(const Level& source, const Target& target, double tolerance, double floor);

/// Whether conservative_area() serves: the result at least 1.25 times as coarse, the source not so small that its texels are
/// bent, and no sphere map, whose reconstruction is not plain bilinear (settle.h).
bool suits_conservative(const Level& source, const Target& target);

}  // namespace envmap

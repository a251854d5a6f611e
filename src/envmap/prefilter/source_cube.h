/// @file
/// The source of a prefilter: a cube or a latlong map, with constant radiance over each texel.
#pragma once

#include <optional>

#include "envmap/base/run.h"
#include "envmap/map/environment_map.h"
#include "envmap/maths/vector.h"

namespace envmap::prefiltering {

/// The cube that is prefiltered in the place of a map of another projection: what convert() makes of it by the area
/// filter at its own density, matching_size(). Nothing for a cube and a latlong map, which are sources themselves.
std::optional<EnvironmentMap> source_cube(const EnvironmentMap& map, const Progress& progress = {});

/// Rows of a map from pole to pole: those of two faces of a cube.
inline int rows_between_poles(const Level& level) {
  return (level.projection() == Projection::cube ? 2 : 1) * level.height();
}

/// The same radiance in texels of at most 1.4 degrees, or of another angle: each texel is cut into equal parts. The
/// methods gain nothing from few large texels, over which a lobe is seldom smooth.
/// @return nothing where the texels are small already.
std::optional<Level> refined(const Level& level, double texel = pi / 128);

/// The least radiance of each channel. It falls from everywhere, so its part of a result is known in closed form: the
/// methods leave it out of their sums, and white stays white to the last bit.
Colour min_radiance_of(const Level& source);

}  // namespace envmap::prefiltering

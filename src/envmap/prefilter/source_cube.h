/// @file
/// What is prefiltered: a cube or a latlong map, radiance constant over each texel.
#pragma once

#include <optional>

#include "envmap/map/environment_map.h"
#include "envmap/maths/vector.h"

namespace envmap::prefiltering {

/// The cube that is prefiltered in the place of a map of another projection: what convert() makes of it by the area
/// filter at its own density, matching_size(). Nothing for a cube and a latlong map, which are sources themselves.
std::optional<EnvironmentMap> source_cube(const EnvironmentMap& map, const Progress& progress = {});

/// Of a map from pole to pole: of a cube those of two faces.
inline int rows_between_poles(const Level& level) {
  return (level.projection() == Projection::cube ? 2 : 1) * level.height();
}

/// The same radiance in texels of 1.4 degrees, or of another angle, or less: those of a coarser cube or latlong map cut
/// into equal parts. A treecode is no quicker than the sum over few large texels, which a lobe is seldom smooth over.
/// Nothing where they are small already.
std::optional<Level> refined(const Level& level, double texel = pi / 128);

}  // namespace envmap::prefiltering

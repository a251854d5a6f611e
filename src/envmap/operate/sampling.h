/// @file
/// How evenly a projection samples the sphere.
#pragma once

#include <vector>

#include "envmap/projection/projection.h"

namespace envmap {

/// One texel on the way from the centre of a face to its worst place.
struct SamplingRow {
  int i, j;            ///< Texel.
  double angle;        ///< Degrees between its centre and the centre of the face.
  double solid_angle;  ///< Steradians, the part inside the disc.
  double relative;     ///< solid_angle / mean solid angle of all texels.
  double anisotropy;   ///< Longest over shortest direction change for one texel step, at its centre.
};

/// `steps` + 1 texels, evenly spaced, from the centre: latlong up to the pole, squares to the corner,
/// discs to the right rim.
std::vector<SamplingRow> sampling_table(Projection p, int size, int steps = 8);

}  // namespace envmap

/// @file
/// The reference filter: the solid-angle mean of the bilinear reconstruction over each texel's footprint.
#pragma once

#include <span>

#include "envmap/map/environment_map.h"

namespace envmap {

struct Area {
  const Level& source;  ///< Its gutter filled.
  Rotation to_source;   ///< From the image frame of the result to that of the source.
  Projection to;
  int size;          ///< Height of a face of the result.
  double tolerance;  ///< Stop refining a texel at this error, relative to the larger of its value and `floor`.
  double floor;      ///< 0.001 x the mean radiance of the source.
};

/// Texels [first, first + out.size()) of a row of the result.
///
/// Adaptive midpoint quadrature: cells no larger than a source texel are compared with their four quarters, those
/// that differ are quartered on. The error that is left is estimated from the differences (the rule is of second order,
/// so a quarter of each, adding up as independent errors do).
void sample_area(const Area& task, int face, int row, int first, std::span<Colour> out);

}  // namespace envmap

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
/// Adaptive quadrature by 2 x 2 Gauss points over cells no larger than a source texel. The reconstruction is smooth but
/// for kinks where it passes from one patch of four texels to the next, and it never leaves the range of their values:
/// that range bounds the error of a cell, so that none is accepted because its samples happen to agree. Cells are
/// quartered until the bounds, added up as independent errors, are below the tolerance, or at 65536 samples a texel.
void sample_area(const Area& task, int face, int row, int first, std::span<Colour> out);

}  // namespace envmap

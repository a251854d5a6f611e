/// @file
/// What a filter fills: the grid of a result, and how it is turned against the source.
#pragma once

#include "envmap/projection/projection.h"

namespace envmap {

struct Target {
  Projection to;
  int size;            ///< Height of a face.
  Rotation to_source;  ///< From the image frame of the result to that of the source.
};

}  // namespace envmap

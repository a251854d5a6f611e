/// @file
/// A place in an environment map.
#pragma once

#include "envmap/base/export.h"
#include "envmap/maths/quadrature.h"
#include "envmap/maths/vector.h"

namespace ENVMAP_EXPORT envmap {

enum class Projection { latlong, cube, sphere, paraboloid, angular };

/// A point of a face: u runs right and v down, both [0,1]; texel (i,j) of W x H has its centre at ((i+.5)/W, (j+.5)/H).
template <class T>
struct Location {
  int face;
  T u, v;
};

}  // namespace envmap

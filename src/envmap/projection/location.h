/// @file
/// A place in an environment map.
#pragma once

#include "envmap/maths/quadrature.h"
#include "envmap/maths/vector.h"

namespace envmap {

/// A point of a face: u runs right and v down, both [0,1]; texel (i,j) of W x H has its centre at ((i+.5)/W, (j+.5)/H).
///
/// Every projection is a type of pure functions over this:
///   name, faces, aspect (width / height of a face), span (degrees of arc along the height of a face),
///   on_disc (only the unit disc carries weight), filled (texels outside the disc are written all the same),
///   direction(face, u, v) -> unit vector, defined beyond the face as its smooth continuation: aprons hold it,
///   locate(direction) -> Location, for any unit vector,
///   density(u, v) -> solid angle per du dv, solid_angle(rect) -> steradians of the rectangle, its part inside the disc.
/// direction and locate take and give float or double and are evaluated in double: a float result is off by its own
/// rounding alone, 2^-23 rad for a direction and 2^-24 of the face for a location (tested).
template <class T>
struct Location {
  int face;
  T u, v;
};

}  // namespace envmap

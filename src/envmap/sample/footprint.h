/// @file
/// What a texel of the result covers in the source, from the derivatives of the two direction maps alone.
#pragma once

#include "envmap/sample/target_grid.h"

namespace envmap {

/// Source texels by which the place in the source moves when the place in the result moves by one texel along u or v.
struct Jacobian {
  Point2 du, dv;
};

/// How the direction of the result moves from texel to texel along u and v, at a point (u,v) of a face of `size` rows.
Derivative texel_derivative(Projection to, int size, int face, const Point2& at);

/// At a point (u,v) of a face of the result. The chain rule: the derivative of the result's direction, solved for the
/// source's in its tangent plane by the normal equations. Finite everywhere; close to singular at poles and rims.
Jacobian jacobian(const Target& target, Projection source, int source_size, int face, const Point2& at);

/// The ellipse that the Jacobian makes of a circle one texel across, by its singular values.
struct Ellipse {
  double major, minor;  ///< Diameters in source texels, major >= minor.
  Point2 along;   ///< Unit step in the result, in texels, that moves along the major axis in the source.
};

Ellipse ellipse(const Jacobian& j);

}  // namespace envmap

/// @file
/// What drawing has to know of a projection beyond its formulae: how triangles look in the image of a face.
#pragma once

#include "envmap/maths/vector.h"
#include "envmap/projection/visit.h"

namespace envmap {

/// plane: straight sides stay straight. disc: the radius grows with the angle from the axis in the middle of the face,
/// sides bend. band: of two angles across and down, cut open from pole to pole. other: none of these; no shader draws
/// triangles into it, but rays and resampling do not care.
enum class ImageShape { plane, disc, band, other };

/// For a new projection that is none of them this says `other` until somebody says otherwise; a disc needs
/// NAME_radius() in shaders/projection/NAME.glsl.
template <class P>
constexpr ImageShape shape_of() {
  if constexpr (std::is_same_v<P, Cube>) return ImageShape::plane;
  if constexpr (std::is_same_v<P, Latlong>) return ImageShape::band;
  return P::on_disc ? ImageShape::disc : ImageShape::other;
}
inline ImageShape image_shape(Projection p) {
  return visit(p, [](auto q) { return shape_of<decltype(q)>(); });
}

/// Whether the corners round a disc are part of the image, too.
inline bool filled_disc(Projection p) {
  return visit(p, [](auto q) { return decltype(q)::on_disc && decltype(q)::filled; });
}

/// The largest angle from the middle of a face of a disc map that is seen in it, radians.
double reach(Projection p);

/// Turns the frame of the map so that Z is the axis of a face (of a band: its pole), X where it shows azimuth 0, and so
/// that Y is up in planes and discs.
Rotation map_to_face(Projection p, int face);

}  // namespace envmap

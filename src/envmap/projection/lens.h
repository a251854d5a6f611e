/// @file
/// Round pictures: where in its photo a fisheye lens shows a direction.
#pragma once

#include "envmap/maths/vector.h"

namespace envmap {

/// In pixels from the left and upper edge of a picture; pixel (i,j) has its centre at (i + 0.5, j + 0.5).
struct Circle {
  double x, y, radius;
};

/// How the angle from the axis becomes a distance from the middle: in proportion to the angle, or to the sine of its
/// half, so that equal areas show equal solid angles.
enum class LensModel { equidistant, equisolid };

/// A lens that looks along +Z, with +X to its left and +Y up, as the middle of angular maps does.
struct Fisheye {
  LensModel model;
  double half;    ///< Radians from the axis to the circle; in (0, pi].
  Circle circle;  ///< Which `half` falls on. It may reach beyond the picture.
  int width, height;

  /// Pixels from the middle of the circle, for an angle from the axis in radians.
  [[nodiscard]] double radius(double angle) const;
  /// The most pixels for a radian, near the axis.
  [[nodiscard]] double pixels_per_radian() const;
  /// How deep in pixels a place lies in what the photo shows, which the circle and the picture's edges bound; below 0
  /// outside.
  [[nodiscard]] double depth(const Point2& place) const;
};

}  // namespace envmap

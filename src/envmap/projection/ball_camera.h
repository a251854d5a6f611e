/// @file
/// A mirror ball as a camera near it sees it, for photos; the sphere projection is the ball as seen from infinitely far
/// away.
#pragma once

#include "envmap/base/export.h"
#include "envmap/maths/vector.h"

namespace ENVMAP_EXPORT envmap {

/// A pinhole camera that looks at the centre of the ball along -Z, and whose photo is cropped to the ball's silhouette.
///
/// With distances in radii of the ball, a ray that leaves the camera at an angle a from its axis meets the ball where
/// sin i = distance sin a, i being the angle of incidence, and is reflected to the angle 2 i - a from +Z (the law of
/// sines in the triangle of centre, camera and point). Its place is tan a / tan A from the middle of the disc, A =
/// asin(1 / distance) being where the silhouette lies. Nothing is seen within A of -Z, behind the ball.
struct BallCamera {
  static constexpr double nearest = 1.02, farthest = 1e6;  ///< What the distance may be.

  double distance;  ///< From the camera to the ball's centre, in radii of the ball.

  /// @param degrees the angle at the camera that the ball fills from one side to the other: 2 A.
  /// @throws UsageError, here and below, where the distance is not `nearest` to `farthest`.
  static BallCamera of_field_of_view(double degrees);

  [[nodiscard]] double blind_angle() const;  ///< A in radians.
  [[nodiscard]] double blind_part() const;   ///< Of all directions, how many are not seen: (1 - cos A) / 2.

  /// What the sphere projection shows at the place where the photo shows a direction. On the axis
  /// that is the direction itself; what the photo does not show is at its rim, on the same side.
  [[nodiscard]] Direction seen_from_afar(const Direction& d) const;
};

}  // namespace envmap

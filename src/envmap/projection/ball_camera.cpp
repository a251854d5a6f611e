#include "envmap/projection/ball_camera.h"

#include <algorithm>
#include <cmath>

#include "envmap/base/bounds.h"
#include "envmap/maths/check_direction.h"
#include "envmap/maths/portable.h"

namespace envmap {
namespace {

// Of the silhouette, sqrt(distance^2 - 1): how far it is from the camera in radii, and the cotangent of A.
double cotangent(double distance) { return std::sqrt((distance - 1) * (distance + 1)); }

// tan(a / 2) for the direction at an angle with this sine and cosine of its half: Alhazen's problem for a light at
// infinity. The angle of incidence is i = (angle + a) / 2, and distance sin a = sin i; with t = tan(a / 2),
// S and C the sine and cosine
//     f(t) = 2 distance t - (S + C t) sqrt(1 + t^2) = 0.
// f is concave and not positive at 0: Newton's method, begun there, climbs to the first root and never passes it. Seven
// steps leave 1e-13 at the nearest distance that there is (tested).
double half_tangent(double distance, double sine, double cosine) {
  double t = 0;
  for (int step = 0; step < 7; ++step) {
    const double root = std::sqrt(1 + t * t), rest = sine + cosine * t;
    t -= (2 * distance * t - rest * root) / (2 * distance - cosine * root - rest * t / root);
  }
  return t;
}

void check_distance(double distance) { check_range({"distance", BallCamera::nearest, BallCamera::farthest}, distance); }

}  // namespace

BallCamera BallCamera::of_field_of_view(double degrees) {
  check_range({"degrees", 0, 180}, degrees);
  const BallCamera camera{1 / portable::sin(degrees * (pi / 360))};
  check_distance(camera.distance);
  return camera;
}

double BallCamera::blind_angle() const {
  check_distance(distance);
  return portable::atan2(1, cotangent(distance));
}

double BallCamera::blind_part() const {
  const double sine = portable::sin(0.5 * blind_angle());
  return sine * sine;
}

Direction BallCamera::seen_from_afar(const Direction& towards) const {
  check_distance(distance);
  const Direction d = checked_direction("d", towards);
  const double last = -cotangent(distance) / distance;  // The z at which directions cease to be seen.
  const double across = std::sqrt(d.x * d.x + d.y * d.y), seen_across = d.z < last ? 1 / distance : across;
  const double z = std::max(d.z, last);
  // Sine and cosine of half the angle: the larger from z, the other without cancellation.
  const double larger = std::sqrt(0.5 * (1 + std::abs(z))), smaller = 0.5 * seen_across / larger;
  const double t = z > 0 ? half_tangent(distance, smaller, larger) : half_tangent(distance, larger, smaller);
  // At the rim itself all directions are -Z; just inside of it sides can still be told.
  constexpr double rim = 1 - 0x1p-40;
  const double r = std::min(rim, 2 * t / (1 - t * t) * cotangent(distance));
  const double out = 2 * r * std::sqrt(1 - r * r), down = 1 - 2 * r * r;
  return across > 0 ? Direction(d.x / across * out, d.y / across * out, down) : Direction(d.z > 0 ? 0 : out, 0, down);
}

}  // namespace envmap

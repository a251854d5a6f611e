/// @file
/// Vectors and turns. Frame: right-handed, +Y up, +Z at the centre of latlong and angular images.
#pragma once

#include <glm/glm.hpp>
#include <numbers>
#include <span>

#include "envmap/base/export.h"

namespace ENVMAP_EXPORT envmap {

template <class T>
using Vec2 = glm::vec<2, T, glm::highp>;
template <class T>
using Vec3 = glm::vec<3, T, glm::highp>;

using Point2 = Vec2<double>;  ///< A place in an image; its units are said where it is used.
/// World or image frame as said where it is used. Functions bring it to length 1; those that return one return a unit
/// vector.
using Direction = Vec3<double>;

/// Linear RGB. GLM's qualifier makes it another type than a direction, which the compiler then keeps apart from it; the
/// arithmetic is the same.
template <class T>
using Rgb = glm::vec<3, T, glm::mediump>;
using Colour = Rgb<float>;  ///< Radiance of a texel.
using Flux = Rgb<double>;   ///< Sum of radiance x solid angle.
using Rotation = glm::mat<3, 3, double, glm::highp>;

inline constexpr double pi = std::numbers::pi;

/// Turn about +Y (+Z towards +X), then +X (+Y towards +Z), then +Z (+X towards +Y), right-handed, applied roll first.
/// @return Ry(yaw) Rx(pitch) Rz(roll).
Rotation rotation(double yaw_degrees, double pitch_degrees, double roll_degrees);

/// Columns x, y, z, right-handed: z along the direction that is given, and y as near to +Y as can be; where z is +Y or
/// -Y, y is -Z or +Z. @throws UsageError where z is 0, NaN or infinite.
Rotation upright_about(const Direction& z);

/// Turns many directions in place: each as turn * direction, to the last bit.
void rotate(const Rotation& turn, std::span<Direction> directions);

/// v at length 1, or something else where it has no direction: no length, or none that is finite.
Direction unit(const Direction& v, const Direction& otherwise = Direction(0));

/// Angle between two directions of any length in radians, accurate for tiny and for nearly opposite angles
/// (Kahan 2006, "How futile are mindless assessments of roundoff", section 12).
/// @throws UsageError where one is 0, NaN or infinite.
double angle_between(const Direction& a, const Direction& b);

}  // namespace envmap

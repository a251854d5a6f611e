/// @file
/// How rays move from one pixel to the next: what a lookup along them has to cover. Source: Igehy 1999, "Tracing ray
/// differentials".
#pragma once

#include <array>

#include "envmap/maths/vector.h"

namespace envmap {

/// Derivatives of a ray by the pixel's column and row. Of zeros the ray is a line, and covers a point of what it meets.
struct RayDifferential {
  std::array<Direction, 2> origin{Direction(0), Direction(0)};
  std::array<Direction, 2> along{Direction(0), Direction(0)};

  [[nodiscard]] bool is_zero() const {
    return origin[0] == Direction(0) && origin[1] == Direction(0) && along[0] == Direction(0) &&
           along[1] == Direction(0);
  }
  /// Part of a pixel: of several rays through it, each covers its own.
  [[nodiscard]] RayDifferential scaled(double part) const;
  /// In axes that a rotation turns this to.
  [[nodiscard]] RayDifferential turned(const Rotation& by) const;
  /// Where the ray meets a plane. @param along the ray's direction. @param normal of the plane, of any length.
  [[nodiscard]] RayDifferential moved(const Direction& along, double distance, const Direction& normal) const;
};

/// The derivative of v / |v|. @param by that of v.
Direction normalised_derivative(const Direction& v, const Direction& by);

/// What leaves a surface. @param arriving from moved(). @param normals derivatives of the unit normal, which is on the
/// side of the ray.
RayDifferential after_reflection(const RayDifferential& arriving, const Direction& along, const Direction& normal,
                                 const std::array<Direction, 2>& normals);
/// @param ratio of the refractive indices, as glm::refract() takes it. There is no total reflection.
RayDifferential after_refraction(const RayDifferential& arriving, const Direction& along, const Direction& normal,
                                 const std::array<Direction, 2>& normals, double ratio);

}  // namespace envmap

/// @file
/// Polygons as triangles.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "envmap/maths/vector.h"

namespace envmap {

/// More corners no polygon that is not convex may have: cutting it takes time with their square.
inline constexpr std::size_t max_concave_corners = 1 << 12;

/// n - 2 triangles, as places in the polygon, with its sense of rotation: a fan where it is convex, else by cutting
/// ears (Meisters, "Polygons have ears", 1975). A polygon need not be flat; one that crosses itself becomes some
/// triangles.
/// @param corners three or more. @throws InputError where it has over max_concave_corners and is not convex.
std::vector<std::array<std::uint32_t, 3>> triangulate(std::span<const Direction> corners);

/// Twice the area of a polygon along its normal (Newell's sum; Sutherland, Sproull and Schumacker 1974).
Direction area_vector(std::span<const Direction> corners);

}  // namespace envmap

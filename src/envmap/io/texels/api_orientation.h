/// @file
/// The orientation of cube faces in OpenGL, Vulkan and Direct3D, against that of a map in memory.
#pragma once

#include "envmap/map/rows.h"

namespace envmap {

/// Whether a face is +Y or -Y, which the APIs mirror top to bottom; the others are mirrored left to right.
inline bool is_y_face(int face) { return face == 2 || face == 3; }

/// The faces of a cube as the APIs store them (OpenGL 4.6 table 8.19, Vulkan 1.3 "Cube Map Face Selection", Direct3D):
/// seen from outside; right and down are +X (-Z,-Y), -X (+Z,-Y), +Y (+X,+Z), -Y (+X,-Z), +Z (+X,-Y), -Z (-X,-Y). That
/// is ours with X and Z faces mirrored left to right and Y faces top to bottom. A lookup with world direction d then
/// returns the radiance from d.
Rows in_api_orientation(const Rows& rows);

}  // namespace envmap

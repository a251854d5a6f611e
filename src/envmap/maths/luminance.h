/// @file
/// Luminance of linear Rec. 709 colours.
#pragma once

#include "envmap/maths/vector.h"

namespace envmap {

inline double luminance_of(const Flux& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }
inline double luminance_of(const Colour& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }

}  // namespace envmap

/// @file
/// The border of an octahedral map in a texture: texels on every side that repeat what the square goes on with, so that
/// the interpolation of a graphics card, which knows no folds, has no seams.
#pragma once

#include "envmap/map/environment_map.h"

namespace envmap {

/// An octahedral map inside `border` more texels on every side.
Level with_border(const Level& map, int border);

/// The map inside; the border may be no half of the size.
Level without_border(const Level& texture, int border);

}  // namespace envmap

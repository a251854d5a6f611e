/// @file
/// Maps whose files are mirrored for an engine with a left-handed world or lookup.
#pragma once

#include <string_view>

#include "envmap/map/environment_map.h"
#include "envmap/map/rows.h"

namespace envmap {

/// The attribute envmap:mirrored of such a file: the axis that is negated, "x" or "z". read() turns the map back.
inline constexpr std::string_view mirrored_fact = "mirrored";

/// A map with X of its image negated, or a cube with Z negated. `none` leaves it as it is; Y is of no engine.
Rows mirrored_rows(const Rows& rows, MirroredAxis mirror);

}  // namespace envmap

/// @file
/// Rows of a chain's levels below one another in one image: how a part of a chain lies in its file.
#pragma once

#include <span>
#include <string_view>

#include "envmap/map/layout.h"
#include "envmap/map/rows.h"

namespace envmap {

/// What the attributes of a part that hold key/value pairs of the whole file begin with.
inline constexpr std::string_view pair_prefix = "pair:";

/// Rows of one image, of one face, as wide as the image of level 0. Shorter rows lie at its left, black beside them.
/// @param levels must outlive the result. @param places how faces lie in the image of each level.
/// @param ranges image rows of each level, level 0's first.
Rows stacked(std::span<const Rows> levels, const Grid& places, std::span<const RowRange> ranges);

}  // namespace envmap

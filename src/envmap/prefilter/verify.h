/// @file
/// What a prefiltered map is measured to be off.
#pragma once

#include <cstdint>
#include <span>

#include "envmap/prefilter/light_tree.h"
#include "envmap/prefilter/lobe.h"
#include "envmap/sample/target.h"

namespace envmap {

struct Verified {
  double error = 0;  ///< The largest, metric `max` of compare().
  std::int64_t directions = 0;
};

/// Compares at least 256 texels (all of smaller maps) with the exact integral: texels spread evenly, and those that are
/// hardest: the darkest, the brightest and the steepest. Their reference is the sum over the source with every part small
/// enough that a third of the bounds of all remainders, as independent errors, comes to half the error asked for, or to a
/// quarter where more than half of it is found (all of the bounds where the horizon bends the lobe, to a tenth where it
/// breaks off; parts of one texel as less independent); where that takes too many parts, the exact sum.
/// @param doubt how unsure the method itself is of each texel, by face, row and column: the least sure are looked at, too.
/// Or empty.
Verified verify(const LightTree& tree, const Lobe& lobe, const Target& target, const Level& result,
                std::span<const float> doubt, double max_error);

}  // namespace envmap

/// @file
/// Cubic interpolation of one level.
#pragma once

#include <span>

#include "envmap/sample/padded_level.h"

namespace envmap {

/// Catmull-Rom (Catmull and Rom 1974; Keys 1981 with a = -1/2): 4 x 4 texels, passes through them, exact for
/// quadratics. Its negative lobes would ring round a sun and go below 0: the value stays in the range of the 4 texels
/// around the place.
Colour bicubic(const PaddedLevel& level, const Location<double>& at);
void sample_bicubic(const PaddedLevel& level, std::span<const Location<double>> at, std::span<Colour> out);

}  // namespace envmap

/// @file
/// The cheapest filter that meets an error, measured on the map at hand.
#pragma once

#include <vector>

#include "envmap/operate/convert.h"
#include "envmap/sample/padded_level.h"
#include "envmap/sample/target_grid.h"

namespace envmap {

/// Tries filters from the cheapest to area until one is found to err by at most `max_error`.
///
/// The texels are spread over all faces and rows, joined by those where filters fail: in which bilinear samples and 2 x
/// 2 of them differ most, and which lie dark beside a light, whose edge samples may miss. The truth is the area filter
/// at a tenth of the error; the area filter as a choice runs at a quarter of it.
/// @param levels the source, down to one texel. @param floor 0.001 x the mean radiance of the source.
FilterChoice choose_filter(const std::vector<PaddedLevel>& levels, const Target& target, double max_error,
                           double floor);

}  // namespace envmap

/// @file
/// The cheapest filter that meets an error, measured on the map at hand.
#pragma once

#include <cstdint>
#include <vector>

#include "envmap/base/export.h"
#include "envmap/sample/filter.h"

namespace ENVMAP_EXPORT envmap {

/// What a filter was measured to do: metrics `rms` and `max` against the area filter in sampled texels, as compare() has
/// them, and the time it takes for each texel of the whole map, levels apart.
struct FilterTrial {
  Filter filter;
  int samples;
  double rms, maximum, seconds_per_texel;
};

struct FilterChoice {
  FilterOptions filter;             ///< The one chosen: the area filter where none reached the error.
  std::vector<FilterTrial> trials;  ///< All that were tried, cheapest first; the last is the one chosen.
  std::int64_t texels;              ///< In which they were measured.
  bool reached;                     ///< Whether rms and max are at most the error there.
};

/// Tries filters from the cheapest to area until one is found to err by at most `max_error`.
///
/// The texels are spread over all faces and rows, joined by those in which bilinear samples and 2 x 2 of them differ most:
/// where a filter fails, it fails there. The truth is the area filter at a tenth of the error; the area filter as a choice
/// runs at a quarter of it.
/// @param levels the source, down to one texel. @param floor 0.001 x the mean radiance of the source.
FilterChoice choose_filter(const std::vector<PaddedLevel>& levels, const Target& target, double max_error, double floor);

}  // namespace envmap

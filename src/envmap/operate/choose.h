/// @file
/// The cheapest filter that meets an error, measured on the map at hand.
#pragma once

#include <vector>

#include "envmap/operate/convert.h"

namespace envmap {

/// What a filter was measured to do: metrics `rms` and `max` against the area filter in sampled texels, as compare() has
/// them, and the time it takes for each texel of the whole map, levels apart.
struct Trial {
  Filter filter;
  int samples;
  double rms, maximum, seconds_per_texel;
};

struct Choice {
  Conversion conversion;      ///< `wanted` with its filter and samples settled.
  Trial best;                 ///< Of the filter chosen, or of the area filter where none reached the error.
  std::vector<Trial> trials;  ///< All that were tried, cheapest first.
  std::int64_t texels;        ///< In which they were measured.
  bool reached;               ///< Whether rms and max are at most the error.
};

/// Tries filters from the cheapest to area until one is found to err by at most `max_error`.
///
/// The texels are spread over all faces and rows, joined by those in which bilinear samples and 2 x 2 of them differ most:
/// where a filter fails, it fails there. The truth is the area filter at a tenth of the error; the area filter as a choice
/// runs at a quarter of it.
/// @param source gets its gutters filled and levels added.
Choice cheapest_filter(EnvironmentMap& source, const Conversion& wanted, double max_error);

}  // namespace envmap

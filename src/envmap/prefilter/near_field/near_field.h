/// @file
/// The near field of a lobe: the part that is narrower than any grid of multilevel sums, summed over the texels of the
/// source. Declarations that the files of this folder share; multilevel_kernels.h declares near_field_sum().
#pragma once

#include <cmath>
#include <span>

#include "envmap/map/environment_map.h"
#include "envmap/prefilter/near_field/gauss_points.h"

namespace envmap::prefiltering {

// Texels of one row of the source, in coordinates about an output.
struct RowOfTexels {
  std::span<const Colour> row;
  int first, count;  // Column of the first, which may lie beyond the row: rows of latlong maps wrap.
  Piece texel;       // The first.
};

// The light of a source less its least radiance, in a unit that keeps its sums within floats.
struct Light {
  const Level& source;
  const Colour& min_radiance;
  float scale, scale_again;  // Their product is 1 / unit, which may be beyond floats.
  Light(const Level& of, const Colour& least, double unit)
      : source(of), min_radiance(least), scale(float(1 / std::sqrt(unit))), scale_again(scale) {}
};

}  // namespace envmap::prefiltering

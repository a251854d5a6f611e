/// @file
/// Where the brightest light of a map is, clipped or not.
#pragma once

#include <cstdint>

#include "envmap/maths/luminance.h"
#include "envmap/operate/measure.h"

namespace envmap {

/// Texels of one luminance that touch each other.
struct Region {
  Texel texel;          ///< The one nearest to the middle.
  Direction direction;  ///< The middle, weighted by solid angle: in the frame of the image.
  std::int64_t texels;
};

/// The largest region of the brightest texels. Over four million of them count as one region, touching or not. Where
/// the middle is undefined, as of a constant map, `first` stands for it.
/// @param luminance of the brightest texels. @param count how many there are. @param first one of them.
Region brightest_region(const Level& level, double luminance, std::int64_t count, const Texel& first);

/// The texel at a step from another: on the face itself, or where the projection goes on beyond its side.
Texel texel_beside(const Level& level, const Texel& texel, int right, int down);

}  // namespace envmap

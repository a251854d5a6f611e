/// @file
/// Where a map may hold a light: regions that outshine what is beyond them.
#pragma once

#include <vector>

#include "envmap/light/texel_patch.h"

namespace envmap {

/// Texels over half of the brightest of them, which touch each other.
struct BrightRegion {
  std::vector<Texel> texels;  ///< The brightest first.
  double peak = 0;            ///< Luminance.
  double solid_angle = 0;
  double luminous_flux = 0;
};

/// The regions whose peak is over a luminance, the strongest first. Those of more than a solid angle are left out.
std::vector<BrightRegion> bright_regions(TexelGeometry& geometry, double luminance, double max_solid_angle);

}  // namespace envmap

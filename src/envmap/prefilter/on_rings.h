/// @file
/// Texels to rings: the first step of the spectral method for images that are not rings themselves.
#pragma once

#include "envmap/map/environment_map.h"
#include "envmap/base/progress.h"
#include "envmap/prefilter/spectral_kernels.h"

namespace envmap::prefiltering {

/// A source as point lights on the samples of rings, such that its harmonics up to `order` come out right: the
/// transpose of interpolation at the Gauss points of each texel. @param error of the results,
/// which says how many points a texel takes.
RingGrid on_rings(const Level& source, int order, int columns, double error, const Progress& progress = {});

/// How far a texel may reach to be one point, or four: Gauss points are off by (l h)^2 / 24 and (l h)^4 / 4320, which
/// the lobe damps at high degrees l; in the tail of a bright texel's lobe nothing hides it.
struct Reaches {
  double one, four;
};
Reaches reaches(int order, double error, bool bright);

}  // namespace envmap::prefiltering

/// @file
/// From any projection to any other.
#pragma once

#include "envmap/map/environment_map.h"
#include "envmap/map/rows.h"
#include "envmap/base/progress.h"
#include "envmap/sample/filter.h"

namespace envmap {

struct Conversion {
  Projection to = Projection::cube;
  int size = 0;                       ///< Height of a face; 0: matching_size() of the source.
  /// `automatic`: area where a texel covers over 1.25 of the source, else bilinear, with 2 samples or more down to 0.5.
  Filter filter = Filter::automatic;
  int samples = 1;                    ///< Along each side of a texel, for nearest, bilinear and bicubic.
  Forward forward = Forward::plus_z;  ///< Axis at the centre of the result, if it is latlong or angular.
  Rotation rotation{1};               ///< Turns the environment: radiance from d comes out from rotation x d.
  double gain = 1;                    ///< Factor on radiance.
  /// Of the area filter, relative to the texel (or 0.001 x the mean if larger). 0: 1e-4 if it was asked for, 1e-3 if the
  /// automatic filter chose it.
  double area_tolerance = 0;
};

/// Size and filter as they will be used on this source.
Conversion resolved(const Conversion& wanted, const EnvironmentMap& source);

/// Where the texels of the result look in the source. @param conversion resolved.
Target target_of(const Conversion& conversion, const EnvironmentMap& source);

/// The result row by row, the same bytes at any number of threads.
/// @param source must outlive the rows; its gutters are filled here, which is why it is not const.
Rows converted(EnvironmentMap& source, const Conversion& wanted);

/// The result whole, with one level. @param progress may be empty.
EnvironmentMap convert(EnvironmentMap& source, const Conversion& wanted, const Progress& progress = {});

}  // namespace envmap

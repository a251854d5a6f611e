/// @file
/// From any projection to any other.
#pragma once

#include <optional>

#include "envmap/base/export.h"
#include "envmap/map/environment_map.h"
#include "envmap/base/progress.h"
#include "envmap/sample/filter.h"

namespace ENVMAP_EXPORT envmap {

struct ConvertOptions {
  Frame to{Projection::cube};
  std::optional<int> size;            ///< Height of a face; absent: matching_size() of the source.
  /// Absent: area where a texel covers over 1.25 of the source, else bilinear, with 2 samples or more down to 0.5.
  std::optional<Filter> filter;
  int samples = 1;                    ///< Along each side of a texel, for nearest, bilinear and bicubic.
  /// Of the area filter, relative to the texel (or 0.001 x the mean if larger). Absent: 1e-4 if it was asked for, 1e-3 if
  /// it was chosen.
  std::optional<double> area_error;
  /// Take the cheapest filter that is found to err by no more (choose_filter.h); `filter` and `samples` are then ignored.
  std::optional<double> max_error;
  Rotation rotation{1};               ///< Turns the environment: radiance from d comes out from rotation x d.
  double gain = 1;                    ///< Factor on radiance.
};

/// The result whole, with one level; the same at any number of threads. Resampler (resampler.h) makes it row by row and
/// tells what filter it chose.
/// @param progress may be empty.
EnvironmentMap convert(const EnvironmentMap& source, const ConvertOptions& options, const Progress& progress = {});

}  // namespace envmap

/// @file
/// The hardest Phong lobes for the grids of multilevel sums, for tests and benchmarks.
#pragma once

#include <cmath>

#include "envmap/prefilter/multilevel/multilevel.h"

namespace envmap {

/// The largest exponent that a grid of so many rows serves. @param error as of the plan. @param max_rows of a grid.
inline double narrowest_phong(int rows, double error, int max_rows, Projection source) {
  double low = 100, high = 1e5;
  while (high > 1.001 * low) {
    const double middle = std::sqrt(low * high);
    const auto plan = prefiltering::multilevel_plan(Phong{middle}, error, max_rows, source);
    (!plan || plan->near_field || plan->finest() > rows ? high : low) = middle;
  }
  return low;
}

}  // namespace envmap

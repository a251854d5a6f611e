/// @file
/// The list of filters and the one dispatch.
#pragma once

#include <string_view>
#include <vector>

#include "envmap/map/environment_map.h"
#include "envmap/sample/target.h"

namespace envmap {

/// `automatic` is for operations to settle; no sampler is made of it.
enum class Filter { automatic, nearest, bilinear, bicubic, trilinear, sat, ewa, area };

inline constexpr std::string_view filter_names[] = {"auto",      "nearest", "bilinear", "bicubic",
                                                    "trilinear", "sat",     "ewa",      "area"};

struct FilterOptions {
  Filter filter;
  int samples = 1;               ///< Along each side of a texel, for nearest, bilinear and bicubic.
  double area_tolerance = 1e-4;  ///< Of the area filter: see area_sampler().
  double floor = 0;
};

/// Whether the filter reads mip levels beyond the base.
inline bool reads_levels(Filter f) { return f == Filter::trilinear || f == Filter::ewa; }

/// @param levels the source, gutters filled; must outlive the sampler. Those beyond the first are read where
/// reads_levels().
Sampler make_sampler(const std::vector<Level>& levels, const Target& target, const FilterOptions& options);

}  // namespace envmap

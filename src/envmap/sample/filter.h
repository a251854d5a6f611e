/// @file
/// The list of filters and the one dispatch.
#pragma once

#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "envmap/base/export.h"
#include "envmap/maths/vector.h"

namespace ENVMAP_EXPORT envmap {

class PaddedLevel;
struct Target;

enum class Filter { nearest, bilinear, bicubic, trilinear, sat, ewa, area };

struct FilterOptions {
  Filter filter = Filter::bilinear;
  int samples = 1;           ///< Along each side of a texel, for nearest, bilinear and bicubic.
  double area_error = 1e-4;  ///< Of the area filter: see area_sampler().
  double floor = 0;          ///< Of the area filter: radiance below which errors are absolute.
};

/// Fills texels [first, first + out.size()) of a row of a face of the result. Safe to call from many threads at once;
/// always gives the same.
using Sampler = std::function<void(int face, int row, int first, std::span<Colour> out)>;

/// A row of the table of filters. A new filter is a row of it, an enumerator and a file.
struct FilterInfo {
  Filter filter;
  std::string_view name;
  std::string_view summary;  ///< Continues "the filter ...", for people.
  bool reads_levels;         ///< Reads mip levels beyond the base.
  Sampler (*make)(const std::vector<PaddedLevel>& levels, const Target& target, const FilterOptions& options);
};

/// In the order of the enumerators.
std::span<const FilterInfo> filters();

inline std::string_view name(Filter f) { return filters()[static_cast<std::size_t>(f)].name; }
inline bool reads_levels(Filter f) { return filters()[static_cast<std::size_t>(f)].reads_levels; }

/// @param levels the source; must outlive the sampler. Those beyond the first are read where reads_levels().
Sampler make_sampler(const std::vector<PaddedLevel>& levels, const Target& target, const FilterOptions& options);

}  // namespace envmap

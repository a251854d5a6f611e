/// @file
/// The list of filters.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "envmap/base/enumerators.h"
#include "envmap/base/export.h"

namespace ENVMAP_EXPORT envmap {

enum class Filter { nearest, bilinear, bicubic, trilinear, sat, ewa, area, nearest_level };
template <>
inline constexpr std::size_t enumerators<Filter> = std::size_t(Filter::nearest_level) + 1;

/// What the area filter integrates over, where maps have no rims and creases (quad.h).
enum class AreaSides {
  outlines,       ///< The outline of each texel: what one texel loses its neighbour gains.
  bounded_quads,  ///< A quadrilateral, where the bound of its error is within the area error; else the outline.
  quads           ///< Also a quadrilateral, or an outline of few points, whose error is estimated.
};
template <>
inline constexpr std::size_t enumerators<AreaSides> = std::size_t(AreaSides::quads) + 1;

struct FilterOptions {
  Filter filter = Filter::bilinear;
  int samples = 1;           ///< Along each side of a texel, for nearest, bilinear and bicubic.
  double area_error = 1e-4;  ///< Of the area filter, relative to the texel or to `floor`.
  double floor = 0;          ///< Of the area filter: radiance below which errors are absolute.
  AreaSides sides = AreaSides::outlines;
};

/// A row of the table of filters. A new filter is a row of it, a maker beside it in filter.cpp, an enumerator and a
/// file.
struct FilterInfo {
  Filter filter;
  std::string_view name;
  std::string_view summary;  ///< Continues "the filter ...", for people.
  bool reads_levels;         ///< Reads mip levels beyond the base.
  bool of_points;            ///< Looks at points, of which FilterOptions::samples says how many.
};

/// In the order of the enumerators.
std::span<const FilterInfo> filters();

inline const FilterInfo& info(Filter f) { return filters()[number_of("filter", f)]; }
inline std::string_view name(Filter f) { return info(f).name; }
inline bool reads_levels(Filter f) { return info(f).reads_levels; }
inline bool of_points(Filter f) { return info(f).of_points; }

}  // namespace envmap

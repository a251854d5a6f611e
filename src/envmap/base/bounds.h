/// @file
/// The ranges of options: the library checks them, and the program's options are declared with them.
#pragma once

#include <string_view>

#include "envmap/base/export.h"

namespace ENVMAP_EXPORT envmap {

/// A field of options and its values, both ends included. NaN is outside of every range.
struct Bounds {
  std::string_view field;
  double least, most;

  [[nodiscard]] constexpr bool hold(double value) const { return value >= least && value <= most; }
};

namespace limits {

inline constexpr Bounds size{"size", 1, 65536};           ///< Height of a face of a map that is made.
inline constexpr Bounds level_height{"size", 1, 131072};  ///< Height of a face with a border.
inline constexpr Bounds level_width{"width", 1, 262144};
inline constexpr Bounds samples{"samples", 1, 64};  ///< Along each side of a texel.
inline constexpr Bounds area_error{"area_error", 1e-7, 1};
/// Less than the program takes, which halves it for a file's rounding.
inline constexpr Bounds max_error{"max_error", 1e-9, 10};
inline constexpr Bounds scale{"scale", 0, 1e30};
inline constexpr Bounds exponent{"exponent", 0, 1e9};  ///< Of lobes: phong and blinn-phong.
inline constexpr Bounds roughness{"roughness", 0, 1};  ///< Of lobes: ggx and charlie.
inline constexpr Bounds gain{"gain", 0, 1e300};
inline constexpr Bounds saturation{"saturation", 0, 100};
inline constexpr Bounds levels{"levels", 1, 32};
inline constexpr Bounds order{"order", 0, 200};  ///< Largest degree of spherical harmonics.
inline constexpr Bounds table_size{"size", 1, 1024};
inline constexpr Bounds cosine{"cosine", 1.0 / 2048, 1};
inline constexpr Bounds border{"border", 0, 1024};
inline constexpr Bounds level{"level", 0, 31};
inline constexpr Bounds headroom{"headroom", 0, 100};  ///< Stops.
inline constexpr Bounds chain_size{"chain_size", 1, 4096};
inline constexpr Bounds exposure{"exposure", -100, 100};
inline constexpr Bounds doublings{"quality", -8, 8};    ///< Of sizes: Quality::environment and Quality::chain.
inline constexpr Bounds kelvin{"kelvin", 1000, 25000};  ///< Of black bodies.
inline constexpr Bounds threads{"threads", 0, 1024};
inline constexpr Bounds picture_width{"width", 1, 65536};
inline constexpr Bounds picture_height{"height", 1, 65536};

}  // namespace limits

/// @throws UsageError with the field, its range and the value where the range does not hold it.
void check_range(const Bounds& range, double value);

}  // namespace envmap

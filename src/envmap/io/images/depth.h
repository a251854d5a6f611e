/// @file
/// What a file stores for each value.
#pragma once

#include <iterator>
#include <optional>
#include <string_view>

#include "envmap/base/enumerators.h"
#include "envmap/base/export.h"

namespace ENVMAP_EXPORT envmap {

/// In rising order of what they hold; rgbd (bytes of colour over a common divisor, up to 255), rgb9e5 (three 9-bit
/// values under one 5-bit exponent), bc6h and uastc_hdr (lossy blocks of 4x4 texels) are all in half.
enum class Depth { uint8, uint16, rgbd, bc6h, uastc_hdr, rgb9e5, half, single };

inline constexpr std::string_view depth_names[] = {"uint8",     "uint16", "rgbd", "bc6h",
                                                   "uastc-hdr", "rgb9e5", "half", "float"};
template <>
inline constexpr std::size_t enumerators<Depth> = std::size(depth_names);

inline std::string_view name(Depth d) { return depth_names[number_of("depth", d)]; }

/// Integers hold sRGB-encoded values from 0 to 1, floating point holds radiance.
inline bool is_integer(Depth d) { return d == Depth::uint8 || d == Depth::uint16; }

}  // namespace envmap

/// @file
/// Radiance of any size as a screen shows it.
#pragma once

#include <iterator>
#include <span>
#include <string_view>

#include "envmap/base/enumerators.h"
#include "envmap/base/export.h"
#include "envmap/maths/vector.h"

namespace ENVMAP_EXPORT envmap {

/// clip: as it is up to 1. reinhard: x / (1 + x) of each channel (Reinhard et al. 2002, "Photographic tone reproduction
/// for digital images", equation 3). neutral: colours as they are up to 0.76, brighter ones drawn in and towards white
/// (Khronos PBR Neutral Tone Mapper, 2024).
enum class Display { clip, reinhard, neutral };
inline constexpr std::string_view display_names[] = {"clip", "reinhard", "neutral"};
template <>
inline constexpr std::size_t enumerators<Display> = std::size(display_names);

/// @param pixels linear, at least 0; then from 0 to 1, still linear. @param exposure a factor on them before that.
void show(std::span<Colour> pixels, Display display, double exposure = 1);

}  // namespace envmap

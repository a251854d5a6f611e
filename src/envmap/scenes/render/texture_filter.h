/// @file
/// The filters of images on surfaces.
#pragma once

#include <cstddef>
#include <iterator>
#include <string_view>

#include "envmap/base/enumerators.h"

namespace envmap {

/// nearest: the texel at the place. bilinear: between the four round it. The others read mip levels by how far the
/// place moves from one pixel to the next. nearest_level: bilinear in the level that suits the longer side of the
/// pixel's footprint best, OpenGL's GL_LINEAR_MIPMAP_NEAREST. trilinear: between the two levels next to it,
/// GL_LINEAR_MIPMAP_LINEAR. ewa: the mean over the footprint, of trilinear lookups in levels that suit its shorter
/// side.
enum class TextureFilter { nearest, bilinear, nearest_level, trilinear, ewa };
inline constexpr std::string_view texture_filter_names[] = {"nearest", "bilinear", "nearest-level", "trilinear", "ewa"};
template <>
inline constexpr std::size_t enumerators<TextureFilter> = std::size(texture_filter_names);

inline bool reads_levels(TextureFilter filter) { return filter >= TextureFilter::nearest_level; }

}  // namespace envmap

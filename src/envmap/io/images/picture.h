/// @file
/// Pictures for people: plain images, not environment maps.
#pragma once

#include <iterator>
#include <span>
#include <string>
#include <string_view>

#include "envmap/base/enumerators.h"
#include "envmap/base/export.h"
#include "envmap/io/files/commit.h"
#include "envmap/io/images/depth.h"
#include "envmap/io/images/image_reader.h"
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

struct PictureOptions {
  /// A file name extension for `-` (png if empty) and names without one; else the name's decides.
  std::string format = {};
  Display display = Display::clip;  ///< Of write_picture() in files of 8 bits.
  CommitOptions commit = {};
};

/// Whether write_picture() knows the type.
bool is_picture(const std::string& path, const PictureOptions& options = {});
/// Whether that type holds radiance as it is.
bool is_linear_picture(const std::string& path, const PictureOptions& options = {});

/// @param path `-` for standard output. .png and .jpg hold 8 bits, sRGB encoded; .exr and .hdr linear floats.
/// @param pixels linear, rows from the top. @throws UsageError where they are no whole rows, or one is NaN or infinite,
/// OutputError where the file cannot be written; then nothing is left behind.
void write_picture(const std::string& path, int width, std::span<const Colour> pixels,
                   const PictureOptions& options = {});

/// Any image of pixels as they are to be stored: sRGB encoded for integers. @throws as write_picture().
void write_stored(const std::string& path, int width, std::span<const Colour> pixels, Depth depth,
                  const PictureOptions& options = {}, const Attributes& attributes = {});

}  // namespace envmap

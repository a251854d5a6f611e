/// @file
/// Pictures for people: plain images, not environment maps.
#pragma once

#include <span>
#include <string>

#include "envmap/base/export.h"
#include "envmap/io/commit.h"
#include "envmap/io/depth.h"
#include "envmap/io/display.h"
#include "envmap/io/image_reader.h"
#include "envmap/maths/vector.h"

namespace ENVMAP_EXPORT envmap {

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

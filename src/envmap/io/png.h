/// @file
/// PNG by libpng: images as they are written, and bytes of RGBA in memory. Colours of these are not multiplied by
/// alpha. OpenImageIO, which reads PNG images, would do that.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "envmap/io/image_writer.h"

namespace envmap {

/// For make_writer(): an image of uint8 or uint16. @throws OutputError without the file's name.
ImageWriter create_png(OutputFile& file, const ImagePlan& plan);

struct RgbaImage {
  int width, height;
  std::vector<std::byte> bytes;
};

/// @param rgba rows from the top. @throws OutputError without a file's name.
std::vector<char> png_of_rgba(std::span<const std::byte> rgba, int width, int height);

/// Any PNG image; one without alpha gets 255. @throws InputError without a file's name.
RgbaImage rgba_of_png(std::span<const std::byte> png);
/// Its header alone.
Size size_of_png(std::span<const std::byte> png);

}  // namespace envmap

/// @file
/// PNG images in memory, bytes of RGBA as they stand: colours are not multiplied by alpha. Images as such go through
/// OpenImageIO, which knows no alpha that is no alpha.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "envmap/io/image_writer.h"

namespace envmap {

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

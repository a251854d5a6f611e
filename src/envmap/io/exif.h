/// @file
/// EXIF, as JPEG carries it.
#pragma once

#include <cstddef>
#include <span>

#include "envmap/io/image_reader.h"

namespace envmap {

/// Sets the orientation of an image, and its description and copyright where it has none yet.
/// @param exif a TIFF header and its directories. What of it lies outside, or is of another type, is passed over.
void read_exif(std::span<const unsigned char> exif, ImageFacts& facts);

}  // namespace envmap

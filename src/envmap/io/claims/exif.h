/// @file
/// EXIF and XMP, as JPEG and TIFF carry them.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "envmap/io/images/image_reader.h"

namespace envmap {

/// Sets the orientation of an image, and its description and copyright where it has none yet.
/// @param exif a TIFF header and its directories. What of it lies outside, or is of another type, is passed over.
void read_exif(std::span<const unsigned char> exif, ImageFacts& facts);

/// Whether XMP names something that the facts of an image have: OpenImageIO has to read it. It goes by names, whatever
/// namespaces they are of.
bool tells_facts(std::string_view xmp);

}  // namespace envmap

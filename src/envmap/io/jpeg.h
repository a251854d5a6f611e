/// @file
/// JPEG by libjpeg, row by row.
#pragma once

#include <optional>

#include "envmap/io/image_reader.h"
#include "envmap/io/input_file.h"

namespace envmap {

/// Opens a JPEG image, whose file must outlive the reader. Of progressive images libjpeg holds all coefficients in
/// memory once a row is read. Any damage that libjpeg notices is an error.
/// @return nothing for images that OpenImageIO has to read: whose XMP or IPTC may tell an orientation, a description or
/// a copyright, with a gain map, or of colours that JFIF and Adobe do not define.
/// @throws InputError without the file's name.
std::optional<ImageReader> open_jpeg(const InputFile& file);

}  // namespace envmap

/// @file
/// TIFF by libtiff, row by row.
#pragma once

#include <optional>

#include "envmap/io/image_reader.h"
#include "envmap/io/input_file.h"

namespace envmap {

/// Opens the first image of a TIFF file, which must outlive the reader: grey, RGB or RGBA of associated alpha, as
/// unsigned integers of 8 and 16 bits, half or single, in strips, with or without lossless compression.
/// @return nothing for images that OpenImageIO has to read. They are rare (tiles, planes, other samples and colours,
/// straight alpha, a data window, mip levels), or have texts that only it reads, or it reads them faster: it
/// decompresses the strips of large ones on all processors.
/// @throws InputError without the file's name.
std::optional<ImageReader> open_tiff(const InputFile& file);

}  // namespace envmap

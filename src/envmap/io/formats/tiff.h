/// @file
/// TIFF by libtiff, read row by row. What throws, throws InputError without the file's name.
#pragma once

#include <optional>

#include "envmap/io/files/input_file.h"
#include "envmap/io/images/image_reader.h"

namespace envmap {

/// The first image of a file: grey, RGB or RGBA of associated alpha, as unsigned integers of 8 and 16 bits, half or
/// single, in strips, with or without lossless compression; doubles, compressed planes, LogLuv and LogL.
/// @param found its facts, also where nothing is returned. @return nothing for rare images (tiles, other samples and
/// colours, straight alpha, a data window, mip levels), for those with texts that only OpenImageIO reads, and for those
/// that it reads faster: it decompresses the strips of large ones on all processors.
std::optional<ImageReader> open_tiff(const InputFile& file, ImageFacts* found = nullptr);

}  // namespace envmap

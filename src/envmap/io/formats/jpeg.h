/// @file
/// JPEG by libjpeg, read row by row, with its ICC profile, its gain map and its Exif data. What throws, throws
/// InputError without the file's name.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "envmap/io/files/input_file.h"
#include "envmap/io/images/image_reader.h"

namespace envmap {

/// Opens a JPEG image. libjpeg holds all coefficients of a progressive image in memory once a row is read. Any damage
/// that libjpeg notices is an error.
/// @param headroom of a gain map, as ImageChoice has it. @param for_texture whether texels stay as stored: without a
/// gain map, or a profile. @return nothing for images without a gain map whose XMP or IPTC may tell an orientation, a
/// description or a copyright, or of colours that JFIF and Adobe do not define.
std::optional<ImageReader> open_jpeg(const InputFile& file, std::optional<double> headroom = {},
                                     bool for_texture = false);

/// All texels of an image of one or three channels in memory, as readers find them.
std::vector<unsigned char> decode_jpeg(const std::string& bytes);

}  // namespace envmap

/// @file
/// Where files hold XMP. Sources: ISO 16684-3:2021; the formats' own specifications.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "envmap/io/files/input_file.h"

namespace envmap {

/// The packets of a file, in their order; none where its format has no place for them: of JPEG segments APP1, of PNG
/// chunks iTXt, packed or not, of TIFF the tag 700 of the first image, of WebP chunks "XMP ". Of HEIF what lies in the
/// first or last megabyte.
/// @param format as ImageReader names it. @throws InputError without the file's name, where one is damaged.
std::vector<std::string> xmp_packets(const InputFile& file, std::string_view format);

}  // namespace envmap

/// @file
/// What the boxes of a HEIF or AVIF file say of its colours and range. Sources: ISO/IEC 14496-12 (colr), 23008-12
/// (HEIF), 21496-1 (tmap).
#pragma once

#include <optional>

#include "envmap/io/files/input_file.h"
#include "envmap/io/images/image_reader.h"

namespace envmap {

/// Sets colours, the profile and the claims. @param headroom as ImageChoice has it.
/// @throws InputError, which names the gain map or the code point, without the file's name.
void read_heif_colours(const InputFile& file, std::optional<double> headroom, ImageFacts& facts);

}  // namespace envmap

/// @file
/// KTX of 2010, the older texture container of Khronos (Filament lights with it). Source:
/// "KTX File Format Specification" 1.0.
#pragma once

#include <span>
#include <string_view>

#include "envmap/base/progress.h"
#include "envmap/io/key_values.h"
#include "envmap/io/output_file.h"
#include "envmap/io/texture.h"
#include "envmap/map/atlas.h"

namespace envmap {

inline constexpr std::string_view ktx1_mark{"\xabKTX 11\xbb\r\n\x1a\n", 12};

/// All levels, the largest first in the file, with KTXorientation "S=r,T=d" and KTXwriter.
/// @param cube whether the levels are columns of faces in the API's orientation. @param pairs go into the file besides.
/// @param progress may be empty.
void write_ktx1(OutputFile& file, std::span<const Atlas> levels, Texels texels, bool cube, const KeyValues& pairs,
                const Progress& progress);

/// The header of a file with ktx1_mark. @throws InputError, without the name of the file, where it is damaged or holds
/// what is not read: other texel formats, arrays, volumes, big-endian words.
TextureFile open_ktx1(const InputFile& file);

}  // namespace envmap

/// @file
/// KTX2, the texture container of Khronos. Source: "KTX File Format Specification" 2.0, document revision 4 (2025);
/// "Khronos Data Format Specification" 1.4 for the descriptor in it.
#pragma once

#include <span>
#include <string_view>

#include "envmap/base/progress.h"
#include "envmap/io/key_values.h"
#include "envmap/io/khr_colour.h"
#include "envmap/io/output_file.h"
#include "envmap/io/texture.h"
#include "envmap/map/atlas.h"

namespace envmap {

inline constexpr std::string_view ktx2_mark{"\xabKTX 20\xbb\r\n\x1a\n", 12};

struct Ktx2Options {
  Texels texels = Texels::rgba16f;
  bool cube = false;  ///< The levels are columns of faces in the API's orientation.
  bool zstd = false;
  KhrColour colour = {1, khr_linear};
};

/// All levels, the smallest first in the file, with KTXorientation "rd". @param pairs go into the file besides.
/// @param progress may be empty.
void write_ktx2(OutputFile& file, std::span<const Atlas> levels, const Ktx2Options& options, const KeyValues& pairs,
                const Progress& progress);

/// The header of a file with ktx2_mark. @throws InputError, without the name of the file, where it is damaged or holds
/// what is not read: other texel formats, arrays, volumes, supercompression other than Zstandard.
TextureFile open_ktx2(const InputFile& file);

}  // namespace envmap

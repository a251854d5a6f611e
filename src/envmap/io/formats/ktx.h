/// @file
/// KTX2 and KTX: textures of Khronos, with all levels of a map in one file.
/// Writers are called as FileFormat::write is. Readers throw InputError, without the name of the file, where it is
/// damaged or holds what is not read.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "envmap/base/run.h"
#include "envmap/io/files/output_file.h"
#include "envmap/io/formats/key_values.h"
#include "envmap/io/texels/texture_file.h"
#include "envmap/map/atlas.h"

namespace envmap {

struct TexturePlan;

// KTX2 of Khronos. Source: "KTX File Format Specification" 2.0, document revision 4 (2025); "Khronos Data Format
// Specification" 1.4 for the descriptor in it.

inline constexpr std::string_view ktx2_mark{"\xabKTX 20\xbb\r\n\x1a\n", 12};

/// The smallest level first in the file, with KTXorientation "rd".
void write_ktx2(OutputFile& file, std::span<const Atlas> levels, const TexturePlan& plan, const Progress& progress);

/// A volume of half RGBA texels: rows, one slice of them behind the other.
struct HalfVolume {
  int width, height, depth;
  std::span<const std::uint16_t> texels;  ///< Four numbers each.
};
void write_ktx2_volume(OutputFile& file, const HalfVolume& volume, const KeyValues& pairs);

/// Not read: other texel formats, arrays, volumes, supercompression other than Zstandard.
TextureFile open_ktx2(const InputFile& file);

// KTX of 2010 (Filament lights with it). Source: "KTX File Format Specification" 1.0.

inline constexpr std::string_view ktx1_mark{"\xabKTX 11\xbb\r\n\x1a\n", 12};

/// The largest level first in the file, with KTXorientation "S=r,T=d" and KTXwriter.
void write_ktx1(OutputFile& file, std::span<const Atlas> levels, const TexturePlan& plan, const Progress& progress);

/// Not read: other texel formats, arrays, volumes, big-endian words.
TextureFile open_ktx1(const InputFile& file);

}  // namespace envmap

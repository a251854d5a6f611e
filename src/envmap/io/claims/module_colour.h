/// @file
/// What files that OpenImageIO reads state of their colours, as its versions differ in what they tell. Sources:
/// Microsoft, "BITMAPV5HEADER structure"; Truevision, "TGA file format specification" 2.0, fields 8 to 30;
/// Google, "WebP container specification"; ISO/IEC 15444-1, annex I; ICC.1, annex B.
#pragma once

#include "envmap/io/files/input_file.h"
#include "envmap/io/images/image_reader.h"

namespace envmap {

/// Each sets colours, the profile and the claims of an image.
/// @throws InputError, which names the claim, without the file's name.
void read_bmp_colours(const InputFile& file, ImageFacts& facts);
void read_targa_colours(const InputFile& file, ImageFacts& facts);
void read_webp_colours(const InputFile& file, ImageFacts& facts);
void read_jpeg2000_colours(const InputFile& file, ImageFacts& facts);
void read_gif_colours(const InputFile& file, ImageFacts& facts);

/// Bytes [at, at + size) of a file, which are its ICC profile. @throws InputError where they lie outside of it.
std::string profile_at(const InputFile& file, std::uint64_t at, std::uint64_t size);

}  // namespace envmap

/// @file
/// What the chunks of a PNG say of its colours. Source: "Portable Network Graphics (PNG) Specification", third edition
/// (2025), sections 4.3 and 11.3.2.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "envmap/io/image_reader.h"

namespace envmap {

struct PngChunk {
  std::string type;  ///< "gAMA".
  std::span<const std::byte> data;
};

/// The chunks of colours, each name with the zero that ends it: for png_set_keep_unknown_chunks().
inline constexpr char png_colour_chunks[] = "cICP\0iCCP\0sRGB\0gAMA\0cHRM\0mDCV\0cLLI";

/// Sets colours, the profile and the claims of an image. The first of cICP, iCCP, sRGB, gAMA with cHRM counts.
/// @param bits of the samples in the file. @throws InputError, which names the chunk, without the file's name.
void read_png_colours(std::span<const PngChunk> chunks, int bits, ImageFacts& facts);

}  // namespace envmap

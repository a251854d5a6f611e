/// @file
/// PNG by libpng: images read and written row by row, and bytes of RGBA in memory. Colours of RGBA stay as stored, not
/// multiplied by alpha.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "envmap/io/files/input_file.h"
#include "envmap/io/images/image_reader.h"
#include "envmap/io/images/image_writer.h"

namespace envmap {

/// For make_writer(): an image of uint8 or uint16. @throws OutputError without the file's name.
ImageWriter create_png(OutputFile& file, const ImagePlan& plan);

/// Opens a PNG image, whose file must outlive the reader. Interlaced images are held in memory once a row is read.
/// @param straight_alpha whether colours stay as stored, not multiplied by alpha.
/// @param found its facts, also where nothing is returned.
/// @return nothing for images that OpenImageIO has to read: with XMP, or an offset.
/// @throws InputError without the file's name.
std::optional<ImageReader> open_png(const InputFile& file, bool straight_alpha, ImageFacts* found = nullptr);

struct RgbaImage {
  int width, height;
  std::vector<std::byte> bytes;
};

/// @param rgba rows from the top. @throws OutputError without a file's name.
std::vector<char> png_of_rgba(std::span<const std::byte> rgba, int width, int height);

/// Any PNG image; one without alpha gets 255. @throws InputError without a file's name.
RgbaImage rgba_of_png(std::span<const std::byte> png);
/// What a zlib stream in a chunk holds. @param type of the chunk, for messages.
/// @throws InputError without a file's name.
std::string inflated(std::string_view type, std::span<const std::byte> data);

/// Its header alone.
Size size_of_png(std::span<const std::byte> png);

}  // namespace envmap

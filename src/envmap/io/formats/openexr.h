/// @file
/// EXR files, by OpenEXR itself.
#pragma once

#include <string>
#include <string_view>

#include "envmap/io/files/input_file.h"
#include "envmap/io/images/image_reader.h"
#include "envmap/io/images/image_writer.h"

namespace envmap {

/// One part of a file: lines or tiles, with its levels if it has mip levels. Without a choice R, G and B are read, or
/// those of the only layer; Y with RY and BY becomes RGB (to half). Where the data window is not the display window,
/// texels are added (black) and left out to make it so, unless the choice is to crop.
/// The `envmap` attribute becomes the text `textureformat`, `comments` the description. @param file must outlive the
/// reader.
/// @throws InputError without the file's name.
ImageReader open_openexr(const InputFile& file, const ImageChoice& choice);

/// Whether the header's sizes can be true of a file of that length: OpenEXR takes memory before it finds out.
/// @throws InputError without the file's name.
void check_openexr(const InputFile& file);

/// For make_writer(): throws OutputError without the file's name.
ImageWriter create_openexr(OutputFile& file, const ImagePlan& plan);

/// Whether there is a compression of that name: none, rle, zips, zip, piz, pxr24, b44, b44a, dwaa or dwab.
bool is_compression(std::string_view name);

}  // namespace envmap

/// @file
/// Portable float map (Debevec, "The portable float map"), which OpenImageIO 2.4 reads but does not write.
#pragma once

#include <optional>

#include "envmap/io/image_reader.h"
#include "envmap/io/input_file.h"
#include "envmap/io/output_file.h"
#include "envmap/map/atlas.h"

namespace envmap {

/// Opens a map of either byte order, whose file must outlive the reader. Values are multiplied by the scale.
/// @return nothing where the header has comments or other line ends: OpenImageIO reads these files.
/// @throws InputError from read(), without the file's name.
std::optional<ImageReader> open_pfm(const InputFile& file);

/// Little-endian, bottom row first.
void write_pfm(OutputFile& file, const Atlas& atlas);

}  // namespace envmap

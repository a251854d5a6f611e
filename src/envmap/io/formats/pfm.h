/// @file
/// Portable float maps, read row by row and written by hand.
#pragma once

#include <span>

#include "envmap/base/run.h"
#include "envmap/io/files/input_file.h"
#include "envmap/io/files/output_file.h"
#include "envmap/io/images/image_reader.h"
#include "envmap/map/atlas.h"

namespace envmap {

struct TexturePlan;

/// A map (Debevec, "The portable float map") of either byte order. Values are multiplied by the scale.
ImageReader open_pfm(const InputFile& file);

/// What OpenImageIO 2.4 reads but does not write. Little-endian, bottom row first.
void write_pfm(OutputFile& file, std::span<const Atlas> levels, const TexturePlan& plan, const Progress& progress);

}  // namespace envmap

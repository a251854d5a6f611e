/// @file
/// Portable float map, which OpenImageIO 2.4 reads but does not write.
#pragma once

#include "envmap/io/output_file.h"
#include "envmap/map/atlas.h"

namespace envmap {

/// Little-endian, bottom row first (Debevec, "The portable float map").
void write_pfm(OutputFile& file, const Atlas& atlas);

}  // namespace envmap

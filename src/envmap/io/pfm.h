/// @file
/// Portable float map, which OpenImageIO 2.4 reads but does not write.
#pragma once

#include <functional>
#include <span>

#include "envmap/io/output_file.h"
#include "envmap/maths/vector.h"

namespace envmap {

/// Little-endian, bottom row first (Debevec, "The portable float map"). @param row fills row `y` from the top.
void write_pfm(OutputFile& file, int width, int height, const std::function<void(int y, std::span<Colour>)>& row);

}  // namespace envmap

/// @file
/// Reading images that are no maps.
#pragma once

#include "envmap/io/read.h"

namespace envmap {

/// Reads an image of any shape. The level of Source::map holds its pixels and stands for no sphere, whatever its
/// projection says. Colours, flaws and notes are those of read(). Levels, layouts and borders of the options do not
/// count.
Source read_photo(const std::string& path, const ReadOptions& options, const Run& run = {});

}  // namespace envmap

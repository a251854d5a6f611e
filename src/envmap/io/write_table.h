/// @file
/// Tables for renderers: square float images that are no environment maps.
#pragma once

#include <span>
#include <string>

#include "envmap/io/files/commit.h"
#include "envmap/maths/vector.h"

namespace envmap {

/// Says early what write_table() would say late. @throws UsageError or OutputError.
void check_table(const std::string& path);

/// Writes size x size texels as float EXR, HDR or TIFF, by the name's extension.
/// @param lobe whose table it is, for the metadata.
/// @throws OutputError where the file cannot be written.
void write_table(const std::string& path, std::span<const Colour> texels, int size, const std::string& lobe,
                 const CommitOptions& commit = {});

}  // namespace envmap

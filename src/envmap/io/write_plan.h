/// @file
/// What write() decides before it writes.
#pragma once

#include <string>

#include "envmap/io/claims/khr_colour.h"
#include "envmap/io/formats/file_format.h"
#include "envmap/io/formats/key_values.h"
#include "envmap/io/texels/texels.h"
#include "envmap/io/write.h"

namespace envmap {

/// What FileFormat::write is told.
struct TexturePlan {
  Texels texels;
  bool cube;  ///< Each level is a column of faces in the API's orientation.
  bool zstd;
  KhrColour colour;
  const Metadata& data;
  const KeyValues& pairs;  ///< The caller's.
};

/// The extension that names the format: WriteOptions::format, or that of the file name.
std::string extension(const std::string& path, const WriteOptions& options);

/// @throws UsageError where the name has a mark that stands for nothing, such as {fcae}: it would stay in the name.
void check_marks(const std::string& path);

/// The depth that was asked for, or the least that keeps what the source had, or the most that the format has.
/// @throws UsageError where the format does not hold what was asked for.
Depth choose_depth(const FileFormat& format, const WriteOptions& options);

/// @throws UsageError where other programs would take the values for linear, or the file cannot name the primaries.
void check_space(const std::string& path, const FileFormat& format, Depth depth, const WriteOptions& options);

/// @throws UsageError where the format, the file name or the projection has no such layout.
Layout choose_layout(const std::string& path, const FileFormat& format, const WriteOptions& options, Projection p);

/// @throws UsageError where there is no such compression, or the format has none.
void check_compression(const std::string& path, const FileFormat& format, const std::string& wanted);

}  // namespace envmap

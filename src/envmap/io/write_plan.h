/// @file
/// What write() decides before it writes. Making the plan is the check: whoever has one has an output that can be
/// written.
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

/// The files of a map.
struct OutputPlan {
  std::string extension;
  const FileFormat& format;
  Depth depth;
  Layout layout;
  FaceFiles faces;        ///< Of Layout::files.
  bool gain_map = false;  ///< A picture of integers beside gains; `depth` is that of the light.
};

/// @param levels whether there will be more than one. @throws UsageError or OutputError, as check_output() says.
OutputPlan plan_output(const std::string& path, const WriteOptions& options, Projection projection, bool levels);

/// The extension that names the format: WriteOptions::format, or that of the file name.
std::string extension(const std::string& path, const WriteOptions& options);

/// The depth that was asked for, or the least that keeps what the source had, or the most that the format has.
/// @throws UsageError where the format does not hold what was asked for.
Depth choose_depth(const FileFormat& format, const WriteOptions& options);

/// @throws UsageError where other programs would take the values for linear, or the file cannot name the primaries.
void check_space(const std::string& path, const FileFormat& format, Depth depth, const WriteOptions& options);

}  // namespace envmap

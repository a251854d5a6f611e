/// @file
/// What OpenImageIO does for us, opened when it is first asked for: with its 250 libraries it takes 0.25 s to load,
/// which is longer than many a command on EXR files runs.
#pragma once

#include <string>

#include "envmap/io/images/image_reader.h"
#include "envmap/io/images/image_writer.h"

namespace envmap {

struct Formats {
  /// @param format as OpenImageIO names it. @param bytes what is read; if empty the file of that name.
  /// @param straight_alpha whether colours stay as stored, not multiplied by alpha. @param crop as ImageChoice has it.
  /// @throws InputError without the file's name.
  ImageReader (*open)(const std::string& format, const std::string& path, std::span<const char> bytes,
                      bool straight_alpha, bool crop);
  /// For make_writer(), one level: throws OutputError without the file's name.
  ImageWriter (*create)(OutputFile& file, const std::string& extension, const ImagePlan& plan);
};

/// The module envmap-formats.so, beside the program or in ../lib/envmap. @throws InputError where it cannot be opened.
const Formats& formats();

}  // namespace envmap

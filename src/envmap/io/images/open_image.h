/// @file
/// A file opened for reading: an image, or a texture of KTX, KTX2 or DDS.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/io/files/input_file.h"
#include "envmap/io/formats/openexr.h"
#include "envmap/io/images/image_reader.h"
#include "envmap/io/texels/texture_file.h"

namespace envmap {

/// A file, or standard input held in memory (which must outlive the reader). Either `reader` or `texture` is set.
struct Image {
  std::string name;
  std::uintmax_t size = 0;  ///< Of the file in bytes; 0 if unknown.
  std::unique_ptr<InputFile> file;
  std::optional<ImageReader> reader;
  std::optional<TextureFile> texture;
  /// What our own reader saw of the colours of an image that OpenImageIO has to read.
  ImageFacts found = {};
  bool for_texture = false;  ///< Texels stay as stored: colours not multiplied by alpha, rows not turned upright.
  bool decode = true;        ///< Values become linear light where the file tells how; else they stay as they are.

  /// Rows, as ImageReader::read. @throws InputError, with the name of the file.
  void read(int level, int begin, int end, int first, int count, std::span<float> out) const;

  /// Throws InputError. Channel names and what a library quotes come from the file: no line breaks and no commands to
  /// the terminal remain.
  [[noreturn]] void fail(std::string why, Remedy remedy = Remedy::none) const;
};

/// @param path `-` for standard input. @param choice of an EXR file. @throws InputError where there is no such file or
/// no format reads it, UsageError where there is a choice and it is not EXR.
void open(Image& image, const std::string& path, const ImageChoice& choice = {});

/// The same of a file's bytes in memory. @param for_texture whether texels stay as stored: colours not multiplied by
/// alpha, rows not turned upright.
void open_bytes(Image& image, std::string name, std::span<const char> bytes, bool for_texture = false,
                const ImageChoice& choice = {});

}  // namespace envmap

/// @file
/// An image opened for reading: by OpenImageIO, or as a texture of KTX2 or DDS.
#pragma once

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "envmap/io/texture.h"

namespace envmap {

/// A file, or standard input held in memory (proxy and bytes must outlive the reader). Either `input` or `texture` is set.
struct Image {
  std::string name;
  std::uintmax_t size = 0;  ///< Of the file in bytes; 0 if unknown.
  std::vector<char> bytes;
  std::unique_ptr<OIIO::Filesystem::IOProxy> file;  ///< What a texture or standard input is read from.
  std::unique_ptr<OIIO::ImageInput> input;
  std::optional<TextureFile> texture;

  /// Throws InputError. Channel names and what a library quotes come from the file: no line breaks and no commands to the
  /// terminal remain.
  [[noreturn]] void fail(std::string why) const;
};

/// @param path `-` for standard input. @throws InputError where there is no such file or no format reads it.
void open(Image& image, const std::string& path);

/// The same of a file's bytes in memory. @param config of OpenImageIO.
void open_bytes(Image& image, std::string name, std::vector<char> bytes, OIIO::ImageSpec config = {});

/// What OpenImageIO complained of, as one line.
std::string first_line(std::string message);

/// libpng and libjpeg print to standard error what OpenImageIO then reports, too. An error is one line: ours.
class SilentLibraries {
 public:
  explicit SilentLibraries(bool silence);
  ~SilentLibraries();
  SilentLibraries(const SilentLibraries&) = delete;

 private:
  int kept_;
};

}  // namespace envmap

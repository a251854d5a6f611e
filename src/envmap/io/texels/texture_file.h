/// @file
/// What KTX, KTX2 and DDS files have in common: levels of one image each, or of six faces where they are a cube map.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "envmap/io/claims/khr_colour.h"
#include "envmap/io/files/input_file.h"
#include "envmap/io/images/detect_layout.h"
#include "envmap/io/metadata.h"
#include "envmap/io/texels/texels.h"
#include "envmap/map/atlas.h"
#include "envmap/map/rows.h"

namespace envmap {

class PartsOfProgress;

/// A texture in a file: its header, checked against the length of the file.
struct TextureFile {
  const char* container;  ///< ktx, ktx2 or dds.
  Texels texels;
  Packing packing = {};  ///< Of packed texels.
  /// Each level has half the sides of the one before, rounded down, at least 1.
  int width = 0, height = 0, levels = 1;
  bool cube = false;
  bool bottom_up = false;  ///< The first row of an image is its lowest.
  Metadata recorded = {};
  std::vector<Claim> claims = {};  ///< As ImageFacts::claims.
  KhrColour colour = {};           ///< Of KTX2.
  bool by_integers = false;  ///< Its values are sRGB encoded as integers of files are, though nothing in it says so.
  /// Of glTF: the light comes out times `gain`, turned by `rotation`.
  double gain = 1;
  Rotation rotation{1};
  std::vector<std::string> notes = {}, details = {};
  std::vector<std::string> files = {};  ///< That were read beside it.
  /// Bytes of a level: its rows (of texels or blocks) without padding, face after face +X -X +Y -Y +Z -Z. @throws
  /// InputError without file name.
  std::function<std::vector<std::byte>(const InputFile& file, int level)> bytes;

  [[nodiscard]] int level_width(int level) const { return std::max(1, width >> level); }
  [[nodiscard]] int level_height(int level) const { return std::max(1, height >> level); }
  [[nodiscard]] TexelFormat format() const {
    TexelFormat f = format_of(texels);
    if (packing.bytes > 0) f.bytes = packing.bytes;
    return f;
  }
  /// Bytes of one image of a level.
  [[nodiscard]] std::uint64_t image_bytes(int level) const {
    return format().image_bytes(level_width(level), level_height(level));
  }
};

/// Bytes [offset, offset + size) of a file. @throws InputError where it ends before.
std::vector<std::byte> read_bytes(const InputFile& file, std::uint64_t offset, std::uint64_t size);

/// The plain structure T that lies there. @throws InputError as read_bytes().
template <class T>
T read_as(const InputFile& file, std::uint64_t offset) {
  T value;
  const std::vector<std::byte> bytes = read_bytes(file, offset, sizeof(T));
  std::memcpy(&value, bytes.data(), sizeof(T));
  return value;
}

/// Rows of an image as the file holds them, made in parallel.
/// @param atlas one image. @param begin a multiple of a block's side;
/// it and `end` tell which rows of the image `from` is.
void encode_rows(const TexelFormat& format, const Atlas& atlas, int begin, int end, std::span<const Colour> from,
                 std::vector<std::byte>& to);

/// All rows of images, band by band. @param write takes the rows in their order.
void encode_images(const TexelFormat& format, std::span<const Atlas> images, PartsOfProgress& shares,
                   const std::function<void(std::span<const std::byte> rows)>& write);

/// The images of a level, one for each face of a cube or all in one.
std::vector<Atlas> images_of(const Atlas& atlas, bool cube);

/// Whether all levels there can be of these sides are there at most, and memory could hold them. @throws InputError.
void check_texture(const TextureFile& texture, std::uint64_t file_size);

/// A level out of a texture. @param stored its number in the file.
/// @param base what detect_layout() or the cube flag says of level 0.
/// @param number the level of `base` that it is. @param any_alpha whether an alpha other than 1 is left behind;
/// else it is an InputError. @param encoded whether values that TextureFile::by_integers is of become linear.
Level read_texture(const InputFile& file, const TextureFile& texture, int stored, const DetectedLayout& base,
                   int number, bool any_alpha, bool encoded = false);

/// What is read back of a level written as such texels. Of UASTC HDR each channel as it lies farther off: read as ASTC,
/// or as the BC6H that it is transcoded to.
Level read_back(const Level& level, Texels texels);

}  // namespace envmap

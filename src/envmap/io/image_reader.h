/// @file
/// An image opened for reading, whichever library reads it.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "envmap/io/depth.h"

namespace envmap {

/// Texts that a file carries, by name; its description under `description`.
using Attributes = std::map<std::string, std::string>;
inline constexpr const char* description = "ImageDescription";

/// What a file says of an image, or of one level of it.
struct ImageFacts {
  int width = 0, height = 0;
  int tile_width = 0, tile_height = 0;  ///< 0: the image is in lines, not in tiles.
  bool flat = true;                     ///< One sample for each pixel and channel: neither deep nor a volume.
  bool whole = true;                    ///< All of the picture: data and display window are the same.
  bool encoded = false;                 ///< Its values are sRGB encoded.
  bool names = true;                    ///< Channel names tell what channels are; else the first three are R, G and B.
  Depth depth = Depth::single;
  std::vector<std::string> channels = {};  ///< R, G and B, where they are there, follow each other.
  Attributes attributes = {};
};

struct ImageReader {
  std::string format;  ///< openexr, hdr, png, ...
  ImageFacts facts;    ///< Of the image and its first level.
  /// Of another level; nothing where there is none.
  std::function<std::optional<ImageFacts>(int level)> level;
  /// Rows [begin, end) of channels [first, first + count) of a level, interleaved; of tiles whole rows of them.
  /// @throws InputError without the file's name.
  std::function<void(int level, int begin, int end, int first, int count, std::span<float> out)> read;
};

}  // namespace envmap

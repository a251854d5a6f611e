/// @file
/// Gain maps: a picture for any screen, and beside it what makes the light of the scene out of it. Sources: ISO
/// 21496-1:2025; Adobe, "Gain map" 1.0 (XMP hdrgm); Android, "Ultra HDR Image Format" 1.1.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "envmap/io/claims/xmp.h"
#include "envmap/io/images/image_reader.h"

namespace envmap {

struct GainMap {
  /// Of red, green and blue. Gains are in stops.
  struct Channel {
    double least = 0, most = 0, gamma = 1, base_offset = 1.0 / 64, offset = 1.0 / 64;
  };
  std::string metadata;  ///< "hdrgm 1.0" or "ISO 21496-1".
  std::array<Channel, 3> of = {};
  double base_headroom = 0, headroom = 0;  ///< In stops above white: of the screens for which no and all gain is meant.
  bool of_base_colours = true;             ///< Else gains are those of colours of the gain map's own profile.
  int width = 0, height = 0, channels = 0;  ///< 1 or 3.
  std::vector<unsigned char> values = {};

  /// How much of the gain a screen of so many stops above white is given; 1 where nothing is said.
  [[nodiscard]] double weight(std::optional<double> stops) const;

  /// "0 to 16 stops in steps of 4.4%, 1024x512 texels of 1 channel".
  [[nodiscard]] std::string words() const;
};

/// Of the gain map's XMP; nothing where it has no hdrgm:GainMapMax. @throws InputError without the file's name.
std::optional<GainMap> gain_map_of_xmp(const std::vector<XmpNode>& xmp);

/// Whether XMP says that there is a gain map beside the picture.
bool announces_gain_map(const std::vector<XmpNode>& xmp);

/// Of the bytes behind the mark urn:iso:std:iso:ts:21496:-1; nothing where they tell a version alone, as a picture's
/// do. @throws as gain_map_of_xmp().
std::optional<GainMap> gain_map_of_iso(std::span<const unsigned char> bytes);

/// Row y of a picture: linear light of the base becomes that of the scene. @param weight of the gain, not 0.
void apply_gain(const GainMap& map, double weight, int y, int height, std::span<Colour> row);

}  // namespace envmap

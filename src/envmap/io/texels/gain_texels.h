/// @file
/// Light as a picture of 8 bits and the gains that make light of it again.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "envmap/io/claims/gain_map.h"
#include "envmap/io/images/picture.h"

namespace envmap {

/// Linear light of an image, at least 0. White is 1.
struct Light {
  int width, height;
  std::span<const Colour> texels;
};

/// The picture that screens without headroom show, three bytes a texel, sRGB encoded.
/// @param display nothing: highlights are rolled off from 3/4 of white on. @param keeps_hue the roll-off is that of a
/// texel's largest channel, so that one gain fits all three; else each channel has its own, as in photographs.
std::vector<unsigned char> picture_of(const Light& light, std::optional<Display> display, bool keeps_hue);

/// Stops between a picture and its light, a texel after another.
struct Gains {
  int width, height, channels;
  double offset;  ///< Of picture and light: darker values have gains that matter little.
  std::vector<float> stops;
};

/// A gain makes of `side` x `side` texels of the picture the light that there is in them.
/// @param picture as readers find it, of picture_of(). @param channels 1 or 3. @param side divides both sides of the
/// image.
Gains gains_between(std::span<const unsigned char> picture, const Light& light, int channels, int side, double offset);

/// Gains as bytes: 255 times their share of the range, to the power of gamma. All channels have one range: readers of
/// XMP know no other.
GainMap gain_map_of(const Gains& gains, double gamma);

/// How far light out of a file is off, over what it is or over a floor where it is darker.
struct Deviation {
  double maximum = 0, rms = 0;  ///< Of all channels.
  std::int64_t texels = 0;
};
struct GainMapError {
  Deviation above = {}, below = {};  ///< Texels with a channel above white, and all others.

  [[nodiscard]] double maximum() const;
  [[nodiscard]] double rms() const;
};

/// @param read_row fills a row of light as it is read back.
GainMapError deviation(const Light& light, double floor,
                       const std::function<void(int row, std::span<Colour> out)>& read_row);
/// Of a picture and gains as readers find them.
GainMapError deviation(const Light& light, double floor, std::span<const unsigned char> picture, const GainMap& map);

}  // namespace envmap

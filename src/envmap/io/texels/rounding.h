/// @file
/// What a file's depth makes of radiance: the part of an error that writing adds.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "envmap/io/write.h"

namespace envmap {

/// How a file rounds what is written to it.
struct Rounding {
  Depth depth;
  /// Of a texel's largest channel, half a step at most: 2^-11 of half, 2^-9 of rgb9e5, 2^-8 of Radiance's shared
  /// exponent; 0 of float. Darker channels under a shared exponent lose more of themselves, and so does what is below a
  /// depth's range. Nothing of bc6h, uastc_hdr and rgbd, which must be made to know.
  std::optional<double> largest = 0;
  /// What is read back of a level; empty where that is what was written. Of uastc_hdr, which cards read in two ways,
  /// each channel as it lies farther off.
  std::function<Level(const Level&)> read_back;
};

/// Whether every channel loses at most `largest` of itself, or of `floor` where it is smaller. Not so of shared
/// exponents, which take more of a texel's darker channels.
bool bounds_every_channel(const Rounding& rounding, double floor);

/// @return nothing where what is lost has no bound: integers, which end at 1, EXR compressions that lose, and samples
/// on the border, between texels (openexr_envmap).
/// @param path, options of which check_output() says nothing. @throws UsageError where the format does not hold the
/// depth.
std::optional<Rounding> rounding_of(const std::string& path, const WriteOptions& options);

/// What rounds: "half", "rgb9e5", "bc6h", "uastc-hdr", "rgbd", "float" or "a shared exponent".
std::string_view name(const Rounding& rounding);

/// What it takes from texels and channels, at most, over them or over `floor` where they are smaller.
double rounding_error(const Rounding& rounding, const Level& level, double floor);

}  // namespace envmap

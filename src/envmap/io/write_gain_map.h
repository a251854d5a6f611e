/// @file
/// Maps as JPEG files with a gain map (Ultra HDR, ISO 21496-1): a picture for any screen that is light for those that
/// know of it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "envmap/io/texels/gain_texels.h"
#include "envmap/io/write.h"

namespace envmap {

struct GainMapOptions {
  /// 3, or 1: a third of the bytes and one gain for red, green and blue, which the picture's highlights then suit.
  int channels = 3;
  /// Of the picture; nothing: highlights are rolled off, and what is darker stays as it is.
  std::optional<Display> display = {};
  /// The smallest file whose GainMapError is at most this in every texel and channel.
  std::optional<double> max_error = {};
  /// The file with the least rms error among those of so many bytes; with `max_error` the limit of the smallest.
  std::optional<std::uint64_t> max_bytes = {};
};

struct GainMapWritten {
  Written written;
  GainMap map = {};         ///< Range and size, without values.
  GainMapError error = {};  ///< Of light read back from the file, above and below white.
  double floor = 0;         ///< 0.001 of the map's mean radiance: darker channels are measured over it.
  int picture_quality = 0, gain_quality = 0;  ///< Of libjpeg.
  std::uint64_t bytes = 0;                    ///< Of the file.
};

/// Says early what write_gain_map() would say late. @throws as check_output(), UsageError where the name is not that of
/// one JPEG file.
void check_gain_map(const std::string& path, const GainMapOptions& how, const WriteOptions& options,
                    Projection projection);

/// Writes a map of one level as write() does, to a JPEG file with a gain map. Both JPEG qualities, the size of the gain
/// map and its curve are chosen for the limits; all light stays within its headroom. The image is held in memory.
/// @param options `depth` has no meaning; a space must be linear.
/// @throws as write(), and AccuracyError, which names no file, where a limit cannot be met: with the best that can.
GainMapWritten write_gain_map(const std::string& path, const Rows& rows, const GainMapOptions& how = {},
                              const WriteOptions& options = {}, const Run& run = {});

}  // namespace envmap

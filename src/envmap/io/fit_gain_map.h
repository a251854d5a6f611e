/// @file
/// The choice among JPEG files with a gain map: qualities, size and curve for an error or for a number of bytes.
#pragma once

#include <string>

#include "envmap/io/write_gain_map.h"

namespace envmap {

/// What the file says beside the light.
struct GainMapTexts {
  std::string icc_profile, comment, owner;
};

struct FittedGainMap {
  std::string bytes;
  GainMap map;  ///< Without its values.
  GainMapError error;
  int picture_quality = 0, gain_quality = 0;
};

/// @param floor as GainMapWritten has it. @throws AccuracyError without the file's name where a limit cannot be met,
/// OutputError likewise where JPEG cannot hold the image.
FittedGainMap fit_gain_map(const Light& light, double floor, const GainMapOptions& how, const GainMapTexts& texts);

}  // namespace envmap

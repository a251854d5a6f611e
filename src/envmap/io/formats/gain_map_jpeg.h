/// @file
/// A JPEG file of a picture and its gain map. Sources: ISO 21496-1:2025; Adobe, "Gain map" 1.0 (XMP hdrgm); Android,
/// "Ultra HDR Image Format" 1.1; CIPA DC-007 ("Multi-Picture Format").
#pragma once

#include <string>

#include "envmap/io/claims/gain_map.h"

namespace envmap {

/// Images of encode_jpeg(), and what the file says of them.
struct GainMapParts {
  const std::string& picture;
  const std::string& gains;
  const GainMap& map;        ///< Without its values; all channels alike.
  std::string icc_profile;   ///< Of the picture; empty: sRGB.
  std::string comment = {};  ///< In the comment segment.
  std::string owner = {};    ///< dc:rights.
};

/// The bytes of the file. Both images say what the gains are, by ISO 21496-1 and by XMP. XMP and the index of MPF tell
/// where the gain map is.
/// @throws OutputError where a text is too long for JPEG.
std::string gain_map_jpeg(const GainMapParts& parts);

}  // namespace envmap

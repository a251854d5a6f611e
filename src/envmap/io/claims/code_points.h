/// @file
/// Colours by code points: PNG's cICP, HEIF's nclx and an ICC profile's cicp tag. Sources: ITU-T H.273 (2021), tables 2
/// and 3; ITU-R BT.2100-2, tables 4 and 5; ITU-R BT.2408-7, section 2.
#pragma once

#include <optional>
#include <string>

#include "envmap/io/images/image_reader.h"

namespace envmap {

struct CodePoints {
  unsigned primaries = 2, transfer = 2;  ///< 2: not specified.
  bool full_range = true;                ///< Else black is 16 and white 235 of 255.
  int bits = 8;                          ///< Of the stored values, which tell where black and white are.

  [[nodiscard]] bool is_specified() const { return primaries != 2 || transfer != 2; }
};

/// Candelas per square metre of radiance 1 in what is made of PQ and HLG (BT.2408: the diffuse white of a picture).
inline constexpr float reference_white = 203;

/// "primaries 9 (BT.2020), transfer 16 (PQ)".
std::string words(const CodePoints& points);

/// PQ and HLG become the light of a display, HLG that of one of 1000 cd/m^2 as BT.2100 has it. What is not specified is
/// Rec.709 and sRGB. @throws InputError, which names the number, where there is none of that primaries or curve.
StatedColour colour_of(const CodePoints& points, const std::string& by);

}  // namespace envmap

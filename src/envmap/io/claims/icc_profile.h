/// @file
/// ICC profiles: those that files bring, and those that are written.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>

#include "envmap/io/claims/colour.h"
#include "envmap/io/images/image_reader.h"

namespace envmap {

/// Returns the bytes of a matrix profile. It holds no date and no name of a host.
/// @param name for people, in ASCII. @param curve linear or sRGB's.
std::string icc_profile(const std::string& name, const Primaries& primaries, Curve curve);

/// What a profile makes of the values of an image.
struct IccColours {
  std::string name;  ///< Its description.
  int channels = 3;  ///< 1: grey; 4: CMYK.
  /// Of grey and RGB. Curves alone go on beyond 1 where they are formulae; tables, and profiles of look-up tables,
  /// throw InputError there.
  StatedColour colour = {};
  /// Of CMYK: amounts of ink from 0 to 1, four a texel, become linear light of the primaries in `colour`.
  std::function<void(std::span<const float> inks, std::span<Colour> out)> from_inks = {};
};

/// White becomes white (relative colorimetric). Matrices with curves are worked out here; Little CMS does the rest in
/// floats. @throws InputError, which names the profile, without the file's name.
IccColours read_icc(std::span<const std::byte> profile);

/// Sets `facts.colour` by `facts.icc_profile`, and makes RGB out of a reader of inks.
/// @throws InputError where the profile is broken, or of another kind of image.
void honour_profile(ImageReader& reader);

}  // namespace envmap

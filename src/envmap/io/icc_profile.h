/// @file
/// ICC profiles: what PNG, JPEG and TIFF files say of their colours. Source: "Specification ICC.1:2010" (version 4.3).
#pragma once

#include <string>

#include "envmap/io/colour.h"

namespace envmap {

/// Returns the bytes of a matrix profile. It holds no date and no name of a host.
/// @param name for people, in ASCII. @param curve linear or sRGB's.
std::string icc_profile(const std::string& name, const Primaries& primaries, Curve curve);

}  // namespace envmap

/// @file
/// The sRGB curve of integer images (IEC 61966-2-1), through OpenColorIO.
#pragma once

#include <span>

#include "envmap/maths/vector.h"

namespace envmap {

void decode_srgb(std::span<Colour> pixels);
void encode_srgb(std::span<Colour> pixels);

}  // namespace envmap

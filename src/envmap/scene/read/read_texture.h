/// @file
/// Images on surfaces, in any format that maps are read from but KTX2 and DDS.
#pragma once

#include <string>
#include <vector>

#include "envmap/scene/scene.h"

namespace envmap {

/// @param name for messages; where the format has no mark in its bytes (Targa) it decides.
/// @throws InputError, beginning with the name.
Texture decode_texture(const std::string& name, std::vector<char> bytes);

}  // namespace envmap

/// @file
/// Images on surfaces, in any format that maps are read from but KTX2 and DDS.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "envmap/scenes/scene/scene_graph.h"

namespace envmap {

/// @param name for messages; where the format has no mark in its bytes (Targa) it decides.
/// @param pixels_left of all textures of the scene; those of this one are taken off it.
/// @throws InputError, beginning with the name.
Texture decode_texture(const std::string& name, std::vector<char> bytes, std::uint64_t& pixels_left);

/// The same of colours: linear values, of EXR and HDR files, are sRGB encoded. @param unsupported gets what is lost.
Texture decode_colours(const std::string& name, std::vector<char> bytes, std::uint64_t& pixels_left,
                       std::vector<std::string>& unsupported);

}  // namespace envmap

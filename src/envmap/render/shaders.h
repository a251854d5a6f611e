/// @file
/// The files of shaders/, in the program itself: shaders.cpp is made of them when it is built.
#pragma once

#include <string_view>

namespace envmap {

/// @param name such as "exact.frag.glsl". @throws std::out_of_range
std::string_view shader_source(std::string_view name);

}  // namespace envmap

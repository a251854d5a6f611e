/// @file
/// The files of shaders/ and below, in the program itself: shaders.cpp is made of them when it is built.
#pragma once

#include <string_view>

namespace envmap {

/// @param name such as "exact.frag.glsl". @return empty where there is none.
std::string_view shader_source(std::string_view name);

}  // namespace envmap

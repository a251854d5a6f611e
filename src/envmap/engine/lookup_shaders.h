// The lookups of shaders/envmap.glsl, for renderers that have shaders of their own.
#pragma once

#include <string_view>

namespace envmap {

/// A file of shaders/, in the program itself. @return empty where there is none.
std::string_view lookup_source(std::string_view name);

std::string_view glsl_lookups();  ///< GLSL 3.30 and GLSL ES 3.00.
std::string_view hlsl_lookups();  ///< The same text in HLSL.

}  // namespace envmap

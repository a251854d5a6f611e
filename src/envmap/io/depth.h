/// @file
/// What a file stores for each value.
#pragma once

#include <OpenImageIO/typedesc.h>

#include <optional>
#include <string_view>

namespace envmap {

enum class Depth { uint8, uint16, half, single };

inline constexpr std::string_view depth_names[] = {"uint8", "uint16", "half", "float"};

inline std::string_view name(Depth d) { return depth_names[static_cast<int>(d)]; }

/// Integers hold sRGB-encoded values from 0 to 1, floating point holds radiance.
inline bool is_integer(Depth d) { return d == Depth::uint8 || d == Depth::uint16; }

inline OIIO::TypeDesc type(Depth d) {
  constexpr OIIO::TypeDesc::BASETYPE types[] = {OIIO::TypeDesc::UINT8, OIIO::TypeDesc::UINT16, OIIO::TypeDesc::HALF,
                                                OIIO::TypeDesc::FLOAT};
  return types[static_cast<int>(d)];
}

inline Depth depth_of(OIIO::TypeDesc t) {
  switch (t.basetype) {
    case OIIO::TypeDesc::UINT8:
    case OIIO::TypeDesc::INT8: return Depth::uint8;
    case OIIO::TypeDesc::UINT16:
    case OIIO::TypeDesc::INT16:
    case OIIO::TypeDesc::UINT32:
    case OIIO::TypeDesc::INT32: return Depth::uint16;
    case OIIO::TypeDesc::HALF: return Depth::half;
    default: return Depth::single;
  }
}

}  // namespace envmap

/// @file
/// What a file stores for each value.
#pragma once

#include <OpenImageIO/typedesc.h>

#include <optional>
#include <string_view>

namespace envmap {

/// In rising order of what they hold; rgb9e5 (three 9-bit values under one 5-bit exponent) is all in half.
enum class Depth { uint8, uint16, rgb9e5, half, single };

inline constexpr std::string_view depth_names[] = {"uint8", "uint16", "rgb9e5", "half", "float"};

inline std::string_view name(Depth d) { return depth_names[static_cast<int>(d)]; }

/// Integers hold sRGB-encoded values from 0 to 1, floating point holds radiance.
inline bool is_integer(Depth d) { return d == Depth::uint8 || d == Depth::uint16; }

/// OpenImageIO's type; it has none for rgb9e5.
inline OIIO::TypeDesc type(Depth d) {
  switch (d) {
    case Depth::uint8: return OIIO::TypeDesc::UINT8;
    case Depth::uint16: return OIIO::TypeDesc::UINT16;
    case Depth::rgb9e5:
    case Depth::half: return OIIO::TypeDesc::HALF;
    case Depth::single: break;
  }
  return OIIO::TypeDesc::FLOAT;
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

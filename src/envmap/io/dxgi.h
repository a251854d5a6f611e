/// @file
/// Formats of texels as DirectX numbers and names them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "envmap/io/texels.h"

namespace envmap {

/// "R8G8_UNORM" of 49, or "DXGI_FORMAT 200" where the number has no name.
std::string dxgi_name(std::uint32_t dxgi);

/// How a format of packed integers lies, and whether it is one of sRGB.
struct PackedFormat {
  std::uint32_t dxgi;
  Packing packing;
  bool srgb = false;
};

/// Nothing for other formats.
std::optional<PackedFormat> packed_format(std::uint32_t dxgi);

}  // namespace envmap

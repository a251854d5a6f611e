/// @file
/// The headers of DDS files (Microsoft, "DDS_HEADER structure" and "DDS_HEADER_DXT10 structure").
#pragma once

#include <array>
#include <cstdint>

namespace envmap::dds {

constexpr std::uint32_t four(const char (&c)[5]) {
  return std::uint32_t(c[0]) | std::uint32_t(c[1]) << 8 | std::uint32_t(c[2]) << 16 | std::uint32_t(c[3]) << 24;
}

struct Header {
  std::uint32_t magic, size, flags, height, width, pitch, depth, levels;
  std::array<std::uint32_t, 11> reserved;
  struct PixelFormat {
    std::uint32_t size, flags, four_cc, bits, red, green, blue, alpha;
  } format;
  std::uint32_t caps, caps2, caps3, caps4, reserved2;
};
static_assert(sizeof(Header) == 128);

struct Dx10 {
  std::uint32_t dxgi, dimension, misc, array_size, misc2;
};
static_assert(sizeof(Dx10) == 20);

using Bits = const std::uint32_t;
inline constexpr Bits flags_of_texture = 0x1 | 0x2 | 0x4 | 0x1000;  // Caps, height, width, pixel format.
inline constexpr Bits flag_pitch = 0x8, flag_levels = 0x20000, flag_size = 0x80000;
inline constexpr Bits format_alpha = 0x1, format_four_cc = 0x4, format_rgb = 0x40, format_luminance = 0x20000;
inline constexpr Bits caps_texture = 0x1000, caps_complex = 0x8, caps_levels = 0x400000;
inline constexpr Bits caps2_cube = 0x200, caps2_all_faces = 0xfc00, caps2_volume = 0x200000;
inline constexpr Bits dimension_2d = 3, misc_cube = 0x4, alpha_mode = 0x7, alpha_premultiplied = 2, alpha_opaque = 3;

}  // namespace envmap::dds

/// @file
/// Texels as bytes: the formats of textures, half floats, rounding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "envmap/io/images/depth.h"
#include "envmap/maths/vector.h"

namespace envmap {

/// To the nearest half, ties to even; infinite from 65520 on, and NaN stays NaN.
void to_half(std::span<const float> from, std::span<std::uint16_t> to);
void from_half(std::span<const std::uint16_t> from, std::span<float> to);

// Texels as GPUs hold them.

/// Little-endian, channels in memory order; rgb9e5 and rg11b10 are 32-bit words with red in the lowest bits;
/// BC6H and UASTC HDR are blocks; those of one channel are grey; packed ones are as a Packing says.
enum class Texels {
  rgba16f,
  rgba32f,
  rgb9e5,
  rgb16f,
  rgb32f,
  rg11b10f,
  bc6h_ufloat,
  bc6h_sfloat,
  rgb8,
  rgb8_srgb,
  rgba8,
  rgba8_srgb,
  rgbd8,
  r16f,
  r32f,
  packed,
  packed_srgb,
  uastc_hdr
};

struct TexelFormat {
  Texels texels;
  const char* name;
  int bytes;  ///< Of a texel, or of a block.
  int channels;
  Depth depth;           ///< That holds its values.
  std::uint32_t vulkan;  ///< VkFormat (Vulkan 1.3, "Formats").
  std::uint32_t dxgi;    ///< DXGI_FORMAT; 0 where there is none.
  /// Bytes of what an API swaps on a big-endian machine: KTX2's typeSize, and KTX's glTypeSize.
  std::uint32_t type_size;
  int side = 1;  ///< Of a block, in texels.

  /// Bytes of a row of texels, or of blocks, and of an image: blocks reach over its right and lower side.
  [[nodiscard]] std::uint64_t row_bytes(int width) const { return blocks(width) * std::uint64_t(bytes); }
  [[nodiscard]] std::uint64_t image_bytes(int width, int height) const { return row_bytes(width) * blocks(height); }
  /// Rows of texels or blocks that so many texels take.
  [[nodiscard]] std::uint64_t blocks(int length) const {
    return (std::uint64_t(length) + std::uint64_t(side) - 1) / std::uint64_t(side);
  }
};

/// No VkFormat: of no texels in KTX2.
inline constexpr std::uint32_t no_vulkan = 0xffffffff;

inline constexpr TexelFormat texel_formats[] = {
    {Texels::rgba16f, "half RGBA", 8, 4, Depth::half, 97, 10, 2},
    {Texels::rgba32f, "float RGBA", 16, 4, Depth::single, 109, 2, 4},
    {Texels::rgb9e5, "E5B9G9R9", 4, 3, Depth::rgb9e5, 123, 67, 4},
    {Texels::rgb16f, "half RGB", 6, 3, Depth::half, 90, 0, 2},
    {Texels::rgb32f, "float RGB", 12, 3, Depth::single, 106, 6, 4},
    {Texels::rg11b10f, "B10G11R11", 4, 3, Depth::half, 122, 26, 4},
    {Texels::bc6h_ufloat, "BC6H UF16", 16, 3, Depth::bc6h, 131, 95, 1, 4},
    {Texels::bc6h_sfloat, "BC6H SF16", 16, 3, Depth::bc6h, 132, 96, 1, 4},
    {Texels::rgb8, "RGB8", 3, 3, Depth::uint8, 23, 0, 1},
    {Texels::rgb8_srgb, "RGB8 sRGB", 3, 3, Depth::uint8, 29, 0, 1},
    {Texels::rgba8, "RGBA8", 4, 4, Depth::uint8, 37, 0, 1},
    {Texels::rgba8_srgb, "RGBA8 sRGB", 4, 4, Depth::uint8, 43, 0, 1},
    {Texels::rgbd8, "RGBD", 4, 4, Depth::rgbd, no_vulkan, 0, 1},
    {Texels::r16f, "half R", 2, 1, Depth::half, no_vulkan, 54, 2},
    {Texels::r32f, "float R", 4, 1, Depth::single, no_vulkan, 41, 4},
    {Texels::packed, "integers", 8, 4, Depth::uint16, no_vulkan, 0, 1},
    {Texels::packed_srgb, "integers sRGB", 8, 4, Depth::uint8, no_vulkan, 0, 1},
    {Texels::uastc_hdr, "UASTC HDR 4x4", 16, 3, Depth::uastc_hdr, 1000066000, 0, 1, 4},
};

inline const TexelFormat& format_of(Texels t) { return texel_formats[int(t)]; }

/// Texels of up to 8 bytes, little-endian: which bits are a channel, an integer that stands for 0 to 1. The bits of a
/// channel lie side by side. Without green it is grey.
struct Packing {
  int bytes = 0;
  std::uint64_t red = 0, green = 0, blue = 0, alpha = 0;
};

/// What a depth is written as. @param depth half, single, rgb9e5, bc6h, uastc_hdr or rgbd.
inline Texels texels_of(Depth depth) {
  return depth == Depth::half        ? Texels::rgba16f
         : depth == Depth::rgb9e5    ? Texels::rgb9e5
         : depth == Depth::bc6h      ? Texels::bc6h_ufloat
         : depth == Depth::uastc_hdr ? Texels::uastc_hdr
         : depth == Depth::rgbd      ? Texels::rgbd8
                                     : Texels::rgba32f;
}

/// The largest value that E5B9G9R9 holds: 511/512 x 2^16.
inline constexpr double largest_rgb9e5 = 65408;

/// Alpha is 1. Values must be finite, not negative and within what the format holds. Shared exponents are rounded to
/// nearest (OpenGL 4.6, 8.5.2). @param texels of floats or shared exponents, but no blocks.
void encode(Texels texels, std::span<const Colour> from, std::span<std::byte> to);

/// A row of texels, or one of blocks. Bytes are linear from 0 to 1 unless their format is an sRGB one.
/// @param to as many rows as a block has, next to each other. @return whether every alpha is 1.
bool decode(Texels texels, std::span<const std::byte> from, std::span<Colour> to);
/// The same of packed texels.
bool decode(const Packing& packing, std::span<const std::byte> from, std::span<Colour> to);

}  // namespace envmap

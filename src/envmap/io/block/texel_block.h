/// @file
/// Blocks of 4x4 texels in 16 bytes, and the ways in which they are divided into two regions.
#pragma once

#include <array>
#include <cstdint>

namespace envmap::block {

inline constexpr int side = 4, block_texels = side * side, block_bytes = 16;

/// Which texels are the second region's, bit k of row-major texel k; and the texel of it whose index lacks its highest
/// bit.
struct Partition {
  std::uint16_t second;
  int anchor;
};
inline constexpr std::array<Partition, 32> partitions{{
    {0xcccc, 15}, {0x8888, 15}, {0xeeee, 15}, {0xecc8, 15}, {0xc880, 15}, {0xfeec, 15}, {0xfec8, 15}, {0xec80, 15},
    {0xc800, 15}, {0xffec, 15}, {0xfe80, 15}, {0xe800, 15}, {0xffe8, 15}, {0xff00, 15}, {0xfff0, 15}, {0xf000, 15},
    {0xf710, 15}, {0x008e, 2},  {0x7100, 8},  {0x08ce, 2},  {0x008c, 2},  {0x7310, 8},  {0x3100, 8},  {0x8cce, 15},
    {0x088c, 2},  {0x3110, 8},  {0x6666, 2},  {0x366c, 2},  {0x17e8, 8},  {0x0ff0, 8},  {0x718e, 2},  {0x399c, 2},
}};

}  // namespace envmap::block

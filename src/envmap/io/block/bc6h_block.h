/// @file
/// A block of BC6H, 16 bytes for 4x4 half-float RGB texels: its modes, regions and bits. Source: Microsoft, "Direct3D
/// 11.3 Functional Specification", BC6H; Khronos, "Data Format Specification" 1.4, "BPTC compressed texture image
/// formats".
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "envmap/io/block/texel_block.h"

namespace envmap::bc6h {

using block::block_bytes, block::block_texels, block::Partition, block::partitions, block::side;

/// How a block holds its endpoints: two for each region of texels.
struct Mode {
  unsigned number;  ///< What the block begins with.
  int number_bits;
  int regions;
  int bits;                   ///< Of a channel of the first endpoint, and of the others where these are no differences.
  std::array<int, 3> others;  ///< Bits of a channel of the other endpoints: of red, green and blue.
  bool differences;           ///< The others are differences from the first.
};

/// In the order of the specification, which counts from 1.
inline constexpr std::array<Mode, 14> modes{{
    {0x00, 2, 2, 10, {5, 5, 5}, true},
    {0x01, 2, 2, 7, {6, 6, 6}, true},
    {0x02, 5, 2, 11, {5, 4, 4}, true},
    {0x06, 5, 2, 11, {4, 5, 4}, true},
    {0x0a, 5, 2, 11, {4, 4, 5}, true},
    {0x0e, 5, 2, 9, {5, 5, 5}, true},
    {0x12, 5, 2, 8, {6, 5, 5}, true},
    {0x16, 5, 2, 8, {5, 6, 5}, true},
    {0x1a, 5, 2, 8, {5, 5, 6}, true},
    {0x1e, 5, 2, 6, {6, 6, 6}, false},
    {0x03, 5, 1, 10, {10, 10, 10}, false},
    {0x07, 5, 1, 11, {9, 9, 9}, true},
    {0x0b, 5, 1, 12, {8, 8, 8}, true},
    {0x0f, 5, 1, 16, {4, 4, 4}, true},
}};

/// Of 64 parts, how many are the second endpoint's: of indices of 3 bits (two regions) and of 4.
inline constexpr std::array<int, 8> weights_of_8{0, 9, 18, 27, 37, 46, 55, 64};
inline constexpr std::array<int, 16> weights_of_16{0, 4, 9, 13, 17, 21, 26, 30, 34, 38, 43, 47, 51, 55, 60, 64};

/// What a block says, as it is stored.
struct Block {
  int mode = 0;                                             ///< Of `modes`, from 0.
  std::array<std::array<std::uint32_t, 3>, 4> endpoints{};  ///< First and second of region 0, then of region 1.
  int partition = 0;
  std::array<std::uint8_t, block_texels> indices{};
};

/// @return nothing where the mode is one of the four that are reserved.
std::optional<Block> unpack(std::span<const std::byte, block_bytes> from);

/// @param block anchors' indices without their highest bit.
void pack(const Block& block, std::span<std::byte, block_bytes> to);

/// Bits of halves, three a texel.
using Halves = std::array<std::uint16_t, 3 * block_texels>;

/// What a block is read as; a reserved mode is black.
Halves halves_of(std::span<const std::byte, block_bytes> from, bool is_signed);

/// An endpoint's value over the range of 16 bits: in steps, with both ends exact.
int unquantised(int value, int bits, bool is_signed);

}  // namespace envmap::bc6h

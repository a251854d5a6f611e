/// @file
/// A block of UASTC HDR 4x4, 16 bytes: the part of ASTC HDR that can be turned into BC6H block by block. It has 24
/// modes: one colour, or one or two regions with ends of ASTC's endpoint modes 7 and 11. Source: Binomial, "UASTC HDR
/// 4x4 Texture Specification" 1.1; for the bits Khronos, "Data Format Specification" 1.4, "ASTC compressed texture
/// image formats".
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "envmap/io/block/bc6h_block.h"
#include "envmap/io/block/texel_block.h"
#include "envmap/io/block/uastc_hdr_endpoints.h"

namespace envmap::uastc_hdr {

using block::block_bytes, block::block_texels, block::side;

struct Mode {
  int regions;
  Ends ends;
  int weights;  ///< Levels of the indices.
  int bytes;    ///< Levels of the endpoints' bytes.
};

/// But for the mode of one colour.
inline constexpr std::array<Mode, 23> modes{{
    {1, Ends::two_colours, 3, 256},     {1, Ends::two_colours, 4, 256},     {1, Ends::two_colours, 5, 256},
    {1, Ends::two_colours, 6, 256},     {1, Ends::two_colours, 8, 256},     {1, Ends::two_colours, 10, 256},
    {1, Ends::two_colours, 12, 256},    {1, Ends::two_colours, 16, 192},    {1, Ends::base_and_scale, 3, 256},
    {1, Ends::base_and_scale, 4, 256},  {1, Ends::base_and_scale, 5, 256},  {1, Ends::base_and_scale, 6, 256},
    {1, Ends::base_and_scale, 8, 256},  {1, Ends::base_and_scale, 10, 256}, {1, Ends::base_and_scale, 12, 256},
    {1, Ends::base_and_scale, 16, 256}, {2, Ends::base_and_scale, 3, 256},  {2, Ends::base_and_scale, 4, 256},
    {2, Ends::base_and_scale, 5, 192},  {2, Ends::base_and_scale, 6, 128},  {2, Ends::base_and_scale, 8, 80},
    {2, Ends::two_colours, 3, 64},      {2, Ends::two_colours, 4, 40},
}};
inline constexpr int one_colour = -1;

/// The partitions that ASTC has, too: bit k of block::partitions[k].
inline constexpr std::uint32_t common_partitions = 0x27feffff;

struct Block {
  int mode = one_colour;
  std::array<std::uint16_t, 3> colour{};                   ///< As halves, of one_colour.
  int partition = 0;                                       ///< Of block::partitions.
  std::array<std::array<std::uint8_t, 6>, 2> endpoints{};  ///< Bytes of each region, among the levels of the mode.
  /// In the order of the weights: 0 is the region's first end.
  std::array<std::uint8_t, block_texels> indices{};
};

/// @return nothing where it is none of UASTC HDR.
std::optional<Block> unpack(std::span<const std::byte, block_bytes> from);
void pack(const Block& block, std::span<std::byte, block_bytes> to);

/// Weights of the second end by index: ASTC's of 64 parts, and the index of BC6H that a transcoder takes, which has 4
/// bits (3 of two regions, and of one with 8 levels).
int weight(const Mode& mode, int index);
int bc6h_index(const Mode& mode, int index);
/// Whether the transcoder makes a block of two regions of it.
inline bool has_short_indices(const Mode& mode) { return mode.regions == 2 || mode.weights == 8; }

/// The bits of a half that a channel is read as. @param log16 its logarithm, as ASTC interpolates it.
inline int half_of_log(int log16) {
  const int m = log16 & 0x7ff, curve = m < 512 ? 3 * m : m < 1536 ? 4 * m - 512 : 5 * m - 2048;
  return (log16 >> 11 << 10) + (curve >> 3);
}

/// Bits of halves, three a texel.
using Halves = std::array<std::uint16_t, 3 * block_texels>;

/// As cards with ASTC HDR read it.
Halves halves_of(const Block& block);

/// The transcoder's modes of bc6h::modes, the finest first; the last of each holds any ends.
inline constexpr std::array<int, 10> bc6h_modes_of_two{2, 3, 4, 0, 5, 6, 7, 8, 1, 9};
inline constexpr std::array<int, 4> bc6h_modes_of_one{13, 12, 11, 10};

/// As cards with BC6H get it of the transcoder: bit for bit Basis Universal's.
bc6h::Block to_bc6h(const Block& block);

}  // namespace envmap::uastc_hdr

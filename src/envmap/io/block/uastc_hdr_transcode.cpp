// UASTC HDR to BC6H, as Basis Universal's transcoder does it (basisu_transcoder.cpp 2.1, read for the choice of modes
// and for rounding): every card with BC6H shows what comes out of it, and so must what errors are measured in.
#include <algorithm>

#include "envmap/io/block/uastc_hdr_block.h"

namespace envmap::uastc_hdr {
namespace {

using Ends4 = std::array<std::array<int, 3>, 4>;  // Bits of halves: two ends of each region.

// Indices of 4 and of 3 bits, by count of levels.
constexpr std::array<std::uint8_t, 16> long_3{0, 8, 15}, long_4{0, 5, 10, 15}, long_5{0, 4, 7, 11, 15},
    long_6{0, 3, 6, 9, 12, 15}, long_10{0, 2, 3, 5, 6, 9, 10, 12, 13, 15},
    long_12{0, 1, 2, 4, 5, 6, 9, 10, 11, 13, 14, 15}, all{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15},
    short_3{0, 4, 7}, short_4{0, 2, 5, 7}, short_5{0, 2, 4, 5, 7}, short_6{0, 1, 3, 4, 6, 7};

const std::array<std::uint8_t, 16>& bc6h_indices(const Mode& mode) {
  const bool two = mode.regions == 2;
  switch (mode.weights) {
    case 3: return two ? short_3 : long_3;
    case 4: return two ? short_4 : long_4;
    case 5: return two ? short_5 : long_5;
    case 6: return two ? short_6 : long_6;
    case 10: return long_10;
    case 12: return long_12;
    default: return all;
  }
}

// An end in so many bits.
int quantised(int half, int bits) { return (half * 64 + 30) / 31 >> (16 - bits); }

// Turns the ends of each region whose anchor has the highest bit of its index, which a block has no place for.
void turn_anchors(bc6h::Block& block, int regions, int last, Ends4& ends) {
  const block::Partition& p = block::partitions[std::size_t(block.partition)];
  for (int r = 0; r < regions; ++r) {
    const int anchor = r == 0 ? 0 : p.anchor;
    if (block.indices[std::size_t(anchor)] <= last / 2) continue;
    std::swap(ends[std::size_t(2 * r)], ends[std::size_t(2 * r + 1)]);
    for (std::size_t k = 0; k < block_texels; ++k)
      if (regions == 1 || int(p.second >> k & 1) == r) block.indices[k] = std::uint8_t(last - block.indices[k]);
  }
}

std::span<const int> modes_for(bool two) {
  return two ? std::span<const int>(bc6h_modes_of_two) : std::span<const int>(bc6h_modes_of_one);
}

// Whether the mode holds the ends.
bool stores(const bc6h::Mode& mode, int number, const Ends4& ends, bc6h::Block& block) {
  block.mode = number;
  for (std::size_t c = 0; c < 3; ++c) {
    const int base = quantised(ends[0][c], mode.bits);
    block.endpoints[0][c] = std::uint32_t(base);
    for (std::size_t e = 1; e < 2 * std::size_t(mode.regions); ++e) {
      const int value = quantised(ends[e][c], mode.bits), half = 1 << (mode.others[c] - 1), off = value - base;
      if (mode.differences && (off < -half || off >= half)) return false;
      block.endpoints[e][c] =
          mode.differences ? std::uint32_t(off) & ((1U << mode.others[c]) - 1) : std::uint32_t(value);
    }
  }
  return true;
}

}  // namespace

int bc6h_index(const Mode& mode, int index) { return bc6h_indices(mode)[std::size_t(index)]; }

bc6h::Block to_bc6h(const Block& block) {
  bc6h::Block made;
  Ends4 ends{};
  bool two = false;
  if (block.mode == one_colour) {
    for (std::size_t e = 0; e < 2; ++e)
      for (std::size_t c = 0; c < 3; ++c) ends[e][c] = block.colour[c];
  } else {
    const Mode& mode = modes[std::size_t(block.mode)];
    two = has_short_indices(mode);
    for (std::size_t r = 0; r < (two ? 2 : 1); ++r) {
      const auto region = ends_of(mode.ends, block.endpoints[mode.regions == 2 ? r : 0]);
      for (std::size_t e = 0; e < 2; ++e)
        for (std::size_t c = 0; c < 3; ++c) ends[2 * r + e][c] = half_of_log(region[e][c] << 4);
    }
    made.partition = mode.regions == 2 ? block.partition : 0;
    std::ranges::transform(block.indices, made.indices.begin(),
                           [&](std::uint8_t index) { return std::uint8_t(bc6h_index(mode, index)); });
  }
  turn_anchors(made, two ? 2 : 1, two ? 7 : 15, ends);
  for (const int number : modes_for(two))
    if (stores(bc6h::modes[std::size_t(number)], number, ends, made)) break;
  return made;
}

}  // namespace envmap::uastc_hdr

/// @file
/// Blocks of BC6H that come near to texels: the search of the encoder. A texel is a point whose coordinates are the
/// bits of its halves, which are as good as the logarithm of radiance; what is least is the sum of squares there.
#pragma once

#include <array>

#include "envmap/io/texels/bc6h_block.h"

namespace envmap::bc6h {

/// So many blocks at once, each in a lane.
inline constexpr std::size_t batch = 16;

template <class T>
using Lanes = std::array<T, batch>;

struct alignas(64) Wanted {
  std::array<std::array<Lanes<float>, block_texels>, 3> halves;  ///< Of red, green, blue: bits of halves, 0 to 0x7bff.
  std::array<Lanes<float>, block_texels> weights;                ///< 0: whatever comes out.
};

/// Whole numbers, as Block has them; of blocks with one region there are two endpoints, and the partition is 0.
struct alignas(64) Found {
  Lanes<float> mode, partition;
  std::array<std::array<Lanes<float>, 3>, 4> endpoints;  ///< As values, not as differences.
  std::array<Lanes<float>, block_texels> indices;
};

void fit(const Wanted& wanted, Found& found);

}  // namespace envmap::bc6h

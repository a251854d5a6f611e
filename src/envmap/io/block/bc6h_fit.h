/// @file
/// Blocks of BC6H that come near to texels: the search of the encoder.
#pragma once

#include <array>

#include "envmap/io/block/bc6h_block.h"
#include "envmap/io/block/weighted_halves.h"

namespace envmap::bc6h {

using block::batch, block::Lanes, block::WeightedHalves;

/// Whole numbers, as Block has them; of blocks with one region there are two endpoints, and the partition is 0.
struct alignas(64) Found {
  Lanes<float> mode, partition;
  std::array<std::array<Lanes<float>, 3>, 4> endpoints;  ///< As values, not as differences.
  std::array<Lanes<float>, block_texels> indices;
};

void fit(const WeightedHalves& wanted, Found& found);

}  // namespace envmap::bc6h

/// @file
/// Blocks of UASTC HDR that come near to texels: the search of the encoder. What is made least is the sum of the
/// squares of both decodes, as ASTC and as BC6H.
#pragma once

#include <array>

#include "envmap/io/block/uastc_hdr_block.h"
#include "envmap/io/block/weighted_halves.h"

namespace envmap::uastc_hdr {

struct alignas(64) Found {
  block::Lanes<float> error;
  std::array<Block, block::batch> blocks;
};

void fit(const block::WeightedHalves& wanted, Found& found);

}  // namespace envmap::uastc_hdr

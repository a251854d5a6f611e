/// @file
/// Radiance in UASTC HDR 4x4, 8 bits a texel, 0 to 65216: ASTC that is cheaply turned into BC6H.
#pragma once

#include <cstddef>
#include <span>

#include "envmap/maths/vector.h"

namespace envmap {

/// One row of blocks, as cards with ASTC HDR read it. @param to four rows of `width` texels each; what the last block
/// holds beyond them is left out.
/// @throws InputError where a block is of none of UASTC HDR's modes.
void decode_uastc_hdr(std::span<const std::byte> from, std::size_t width, std::span<Colour> to);

/// Blocks become those of BC6H that cards without ASTC HDR get of the transcoder. @throws InputError as
/// decode_uastc_hdr().
void transcode_to_bc6h(std::span<std::byte> blocks);

/// One row of blocks: what comes nearest by the bits of halves, and so by the logarithm, in both ways of reading.
/// Values must be within 0 and 65504. The parameters are those of encode_bc6h().
void encode_uastc_hdr(std::span<const Colour> from, std::size_t width, bool top, bool bottom, std::span<std::byte> to);

}  // namespace envmap

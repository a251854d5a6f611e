/// @file
/// Radiance in BC6H, 8 bits a texel. UF16 holds 0 to 65504, SF16 either sign.
#pragma once

#include <cstddef>
#include <span>

#include "envmap/maths/vector.h"

namespace envmap {

/// One row of blocks, exactly as Direct3D and Vulkan have it; reserved modes are black.
/// @param to four rows of `width` texels each; what the last block holds beyond them is left out.
void decode_bc6h(std::span<const std::byte> from, bool is_signed, std::size_t width, std::span<Colour> to);

/// One row of blocks of UF16: what comes nearest by the bits of halves, and so by the logarithm. Values must be within
/// 0 and 65504.
/// @param from four rows of `width` texels, or as many as are left of an image; their last texels are repeated beyond
/// them.
/// @param top, bottom whether the image begins or ends here. @param to so many blocks as `width` takes.
void encode_bc6h(std::span<const Colour> from, std::size_t width, bool top, bool bottom, std::span<std::byte> to);

}  // namespace envmap

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

}  // namespace envmap

/// @file
/// Half precision, as OpenEXR and GPUs hold it.
#pragma once

#include <cstdint>
#include <span>

namespace envmap {

/// To the nearest half, ties to even; infinite from 65520 on, and NaN stays NaN.
void to_half(std::span<const float> from, std::span<std::uint16_t> to);
void from_half(std::span<const std::uint16_t> from, std::span<float> to);

}  // namespace envmap

/// @file
/// Colours in a Khronos data format descriptor. Source: "Khronos Data Format Specification" 1.4, sections
/// "colorPrimaries" and "transferFunction".
#pragma once

#include <cstdint>
#include <optional>

#include "envmap/io/claims/colour.h"

namespace envmap {

/// The two bytes of a basic descriptor block. 0: not specified.
struct KhrColour {
  std::uint8_t primaries = 0, transfer = 0;
};

inline constexpr std::uint8_t khr_linear = 1, khr_srgb = 2;

/// Returns the bytes for values of a space; nothing where the specification has no number for its primaries.
/// @param primaries empty where they are not known.
std::optional<KhrColour> khr_colour(const std::optional<Primaries>& primaries, Curve curve);

/// Returns true for the numbers whose primaries are known; files with others are refused.
bool knows_primaries(std::uint8_t number);

/// Returns the space that the bytes name; an empty claim where they name none.
ClaimedSpace space_of(KhrColour colour);

}  // namespace envmap

#include "envmap/io/claims/khr_colour.h"

#include <algorithm>

#include "envmap/io/claims/colour_config.h"

namespace envmap {
namespace {

struct Row {
  std::uint8_t number;
  Primaries primaries;
};

// KHR_DF_PRIMARIES_*. Of PAL525 (9) the standards do not agree.
constexpr Row numbered_primaries[] = {
    {1, rec709},
    {2, {{0.64, 0.33}, {0.29, 0.60}, {0.15, 0.06}, {0.3127, 0.3290}}},    // BT.601, 625 lines.
    {3, {{0.63, 0.34}, {0.31, 0.595}, {0.155, 0.07}, {0.3127, 0.3290}}},  // BT.601, 525 lines.
    {4, rec2020},
    {5, cie_xyz},
    {6, aces_ap0},
    {7, aces_ap1},
    {8, {{0.67, 0.33}, {0.21, 0.71}, {0.14, 0.08}, {0.3101, 0.3162}}},  // NTSC 1953.
    {10, p3_d65},
    {11, {{0.64, 0.33}, {0.21, 0.71}, {0.15, 0.06}, {0.3127, 0.3290}}},  // Adobe RGB (1998).
};

}  // namespace

std::optional<KhrColour> khr_colour(const std::optional<Primaries>& primaries, Curve curve) {
  const std::uint8_t transfer = curve == Curve::linear ? khr_linear : curve == Curve::srgb ? khr_srgb : 0;
  if (!primaries) return KhrColour{0, transfer};
  const auto* found =
      std::ranges::find_if(numbered_primaries, [&](const Row& row) { return same(row.primaries, *primaries); });
  return found == std::end(numbered_primaries) ? std::nullopt : std::optional(KhrColour{found->number, transfer});
}

bool knows_primaries(std::uint8_t number) {
  return std::ranges::find(numbered_primaries, number, &Row::number) != std::end(numbered_primaries);
}

ClaimedSpace space_of(KhrColour colour) {
  const auto* found = std::ranges::find(numbered_primaries, colour.primaries, &Row::number);
  if (found == std::end(numbered_primaries) || (colour.transfer != khr_linear && colour.transfer != khr_srgb))
    return {};
  constexpr const char* by = "data format descriptor";
  if (colour.transfer == khr_linear) return {space_with(found->primaries), found->primaries, by};
  const std::string name = encoded_space_with(found->primaries);
  return name.empty() ? ClaimedSpace{} : ClaimedSpace{name, found->primaries, by};
}

}  // namespace envmap

#include "envmap/io/bc6h.h"

#include <algorithm>
#include <array>

#include "envmap/io/bc6h_block.h"
#include "envmap/io/half.h"

namespace envmap {
namespace {

using namespace bc6h;

using Rgb16 = std::array<int, 3>;

int sign_extended(std::uint32_t value, int bits) {
  const std::uint32_t sign = 1U << (bits - 1);
  return static_cast<int>((value & (2 * sign - 1)) ^ sign) - static_cast<int>(sign);
}

// An endpoint's value over the range of 16 bits: in steps, with both ends exact.
int unquantised(int value, int bits, bool is_signed) {
  if (!is_signed) {
    if (bits >= 15 || value == 0) return value;
    return value == (1 << bits) - 1 ? 0xffff : ((value << 16) + 0x8000) >> bits;
  }
  if (bits >= 16 || value == 0) return value;
  const int size = std::abs(value);
  const int whole = size >= (1 << (bits - 1)) - 1 ? 0x7fff : ((size << 15) + 0x4000) >> (bits - 1);
  return value < 0 ? -whole : whole;
}

// To the bits of a half: 31/64 of 16 bits end at 65504, the largest.
std::uint16_t finished(int value, bool is_signed) {
  if (!is_signed) return static_cast<std::uint16_t>(value * 31 >> 6);
  return static_cast<std::uint16_t>(value < 0 ? 0x8000 | (-value * 31 >> 5) : value * 31 >> 5);
}

// The four endpoints, differences added up.
std::array<Rgb16, 4> endpoints_of(const Block& block, bool is_signed) {
  const Mode& mode = modes[static_cast<std::size_t>(block.mode)];
  std::array<Rgb16, 4> all{};
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t e = 0; e < 2 * static_cast<std::size_t>(mode.regions); ++e) {
      std::uint32_t value = block.endpoints[e][c];
      if (mode.differences && e > 0)
        value = (block.endpoints[0][c] + static_cast<std::uint32_t>(sign_extended(value, mode.others[c]))) &
                ((1U << mode.bits) - 1);
      all[e][c] = unquantised(is_signed ? sign_extended(value, mode.bits) : static_cast<int>(value), mode.bits, is_signed);
    }
  return all;
}

using Halves = std::array<std::uint16_t, 3 * texels>;

Halves halves_of(std::span<const std::byte, bytes> from, bool is_signed) {
  Halves halves{};
  const std::optional<Block> block = unpack(from);
  if (!block) return halves;
  const auto endpoints = endpoints_of(*block, is_signed);
  const bool two = modes[static_cast<std::size_t>(block->mode)].regions == 2;
  const unsigned second = two ? partitions[static_cast<std::size_t>(block->partition)].second : 0U;
  for (std::size_t k = 0; k < texels; ++k) {
    const std::size_t first = 2 * (second >> k & 1);
    const int weight = two ? weights_of_8[block->indices[k]] : weights_of_16[block->indices[k]];
    for (std::size_t c = 0; c < 3; ++c)
      halves[3 * k + c] =
          finished((endpoints[first][c] * (64 - weight) + endpoints[first + 1][c] * weight + 32) >> 6, is_signed);
  }
  return halves;
}

}  // namespace

void decode_bc6h(std::span<const std::byte> from, bool is_signed, std::size_t width, std::span<Colour> to) {
  std::array<float, 3 * texels> values;
  for (std::size_t left = 0; left < width; left += side, from = from.subspan(bytes)) {
    from_half(halves_of(from.first<bytes>(), is_signed), values);
    const std::size_t columns = std::min<std::size_t>(side, width - left);
    for (std::size_t k = 0; k < texels; ++k)
      if (k % side < columns)
        to[k / side * width + left + k % side] = Colour(values[3 * k], values[3 * k + 1], values[3 * k + 2]);
  }
}

}  // namespace envmap

#include "envmap/io/block/bc6h_block.h"

#include <algorithm>
#include <cstdlib>
#include <string_view>

#include "envmap/io/block/bits.h"

namespace envmap::bc6h {
using block::Bits;

namespace {

// The bits between the mode's number and the partition or the indices, the lowest first: of red, green or blue of the
// endpoint w, x, y or z bit N, or bits N to M.
constexpr std::array<std::string_view, modes.size()> layouts{
    "gy4 by4 bz4 rw0-9 gw0-9 bw0-9 rx0-4 gz4 gy0-3 gx0-4 bz0 gz0-3 bx0-4 bz1 by0-3 ry0-4 bz2 rz0-4 bz3",
    "gy5 gz4 gz5 rw0-6 bz0 bz1 by4 gw0-6 by5 bz2 gy4 bw0-6 bz3 bz5 bz4 rx0-5 gy0-3 gx0-5 gz0-3 bx0-5 by0-3 ry0-5 rz0-5",
    "rw0-9 gw0-9 bw0-9 rx0-4 rw10 gy0-3 gx0-3 gw10 bz0 gz0-3 bx0-3 bw10 bz1 by0-3 ry0-4 bz2 rz0-4 bz3",
    "rw0-9 gw0-9 bw0-9 rx0-3 rw10 gz4 gy0-3 gx0-4 gw10 gz0-3 bx0-3 bw10 bz1 by0-3 ry0-3 bz0 bz2 rz0-3 gy4 bz3",
    "rw0-9 gw0-9 bw0-9 rx0-3 rw10 by4 gy0-3 gx0-3 gw10 bz0 gz0-3 bx0-4 bw10 by0-3 ry0-3 bz1 bz2 rz0-3 bz4 bz3",
    "rw0-8 by4 gw0-8 gy4 bw0-8 bz4 rx0-4 gz4 gy0-3 gx0-4 bz0 gz0-3 bx0-4 bz1 by0-3 ry0-4 bz2 rz0-4 bz3",
    "rw0-7 gz4 by4 gw0-7 bz2 gy4 bw0-7 bz3 bz4 rx0-5 gy0-3 gx0-4 bz0 gz0-3 bx0-4 bz1 by0-3 ry0-5 rz0-5",
    "rw0-7 bz0 by4 gw0-7 gy5 gy4 bw0-7 gz5 bz4 rx0-4 gz4 gy0-3 gx0-5 gz0-3 bx0-4 bz1 by0-3 ry0-4 bz2 rz0-4 bz3",
    "rw0-7 bz1 by4 gw0-7 by5 gy4 bw0-7 bz5 bz4 rx0-4 gz4 gy0-3 gx0-4 bz0 gz0-3 bx0-5 by0-3 ry0-4 bz2 rz0-4 bz3",
    "rw0-5 gz4 bz0 bz1 by4 gw0-5 gy5 by5 bz2 gy4 bw0-5 gz5 bz3 bz5 bz4 rx0-5 gy0-3 gx0-5 gz0-3 bx0-5 by0-3 ry0-5 rz0-5",
    "rw0-9 gw0-9 bw0-9 rx0-9 gx0-9 bx0-9",
    "rw0-9 gw0-9 bw0-9 rx0-8 rw10 gx0-8 gw10 bx0-8 bw10",
    "rw0-9 gw0-9 bw0-9 rx0-7 rw11-10 gx0-7 gw11-10 bx0-7 bw11-10",
    "rw0-9 gw0-9 bw0-9 rx0-3 rw15-10 gx0-3 gw15-10 bx0-3 bw15-10",
};

struct Place {
  std::uint8_t channel, endpoint, bit;
};

struct Places {
  std::array<Place, 75> of_bit{};
  int count = 0;
};

constexpr Places places_of(std::string_view layout) {
  Places places;
  const auto number = [&layout] {
    int n = 0;
    for (; !layout.empty() && layout[0] >= '0' && layout[0] <= '9'; layout.remove_prefix(1))
      n = 10 * n + (layout[0] - '0');
    return n;
  };
  while (!layout.empty()) {
    const auto channel = std::string_view("rgb").find(layout[0]), endpoint = std::string_view("wxyz").find(layout[1]);
    layout.remove_prefix(2);
    const int first = number();
    int last = first;
    if (layout.starts_with('-')) {
      layout.remove_prefix(1);
      last = number();
    }
    layout.remove_prefix(layout.starts_with(' ') ? 1 : 0);
    for (int bit = first;; bit += first < last ? 1 : -1) {
      places.of_bit[std::size_t(places.count++)] = {std::uint8_t(channel), std::uint8_t(endpoint), std::uint8_t(bit)};
      if (bit == last) break;
    }
  }
  return places;
}

constexpr std::array<Places, modes.size()> all_places = [] {
  std::array<Places, modes.size()> all;
  for (std::size_t k = 0; k < modes.size(); ++k) all[k] = places_of(layouts[k]);
  return all;
}();

// Every bit of every endpoint has one place, and the block is full.
constexpr bool is_whole(const Mode& mode, const Places& places) {
  for (int endpoint = 0; endpoint < 2 * mode.regions; ++endpoint)
    for (int channel = 0; channel < 3; ++channel) {
      const int bits = endpoint == 0 ? mode.bits : mode.others[std::size_t(channel)];
      std::uint32_t seen = 0;
      int found = 0;
      for (int k = 0; k < places.count; ++k)
        if (const Place& p = places.of_bit[std::size_t(k)]; p.endpoint == endpoint && p.channel == channel)
          seen |= 1U << p.bit, ++found;
      if (found != bits || seen != (1U << bits) - 1) return false;
    }
  return mode.number_bits + places.count + (mode.regions == 2 ? 5 + 2 * 2 + 14 * 3 : 3 + 15 * 4) == 8 * block_bytes;
}
static_assert([] {
  for (std::size_t k = 0; k < modes.size(); ++k)
    if (!is_whole(modes[k], all_places[k])) return false;
  return true;
}());

// Of a texel's index; its region's anchor goes without the highest, which is 0.
int index_bits(const Mode& mode, int partition, int texel) {
  const bool second = mode.regions == 2 && texel == partitions[std::size_t(partition)].anchor;
  return (mode.regions == 2 ? 3 : 4) - (texel == 0 || second ? 1 : 0);
}

}  // namespace

std::optional<Block> unpack(std::span<const std::byte, block_bytes> from) {
  Bits bits(from);
  std::uint32_t number = bits.take(2);
  if (number > 1) number |= bits.take(3) << 2;
  const auto* const mode = std::ranges::find(modes, number, &Mode::number);
  if (mode == modes.end()) return std::nullopt;
  Block block{.mode = int(mode - modes.begin())};
  const Places& places = all_places[std::size_t(block.mode)];
  for (const Place& p : std::span(places.of_bit).first(std::size_t(places.count)))
    block.endpoints[p.endpoint][p.channel] |= bits.take(1) << p.bit;
  if (mode->regions == 2) block.partition = int(bits.take(5));
  for (int k = 0; k < block_texels; ++k)
    block.indices[std::size_t(k)] = std::uint8_t(bits.take(index_bits(*mode, block.partition, k)));
  return block;
}

void pack(const Block& block, std::span<std::byte, block_bytes> to) {
  const Mode& mode = modes[std::size_t(block.mode)];
  const Places& places = all_places[std::size_t(block.mode)];
  Bits bits;
  bits.put(mode.number, mode.number_bits);
  for (const Place& p : std::span(places.of_bit).first(std::size_t(places.count)))
    bits.put(block.endpoints[p.endpoint][p.channel] >> p.bit, 1);
  if (mode.regions == 2) bits.put(std::uint32_t(block.partition), 5);
  for (int k = 0; k < block_texels; ++k) bits.put(block.indices[std::size_t(k)], index_bits(mode, block.partition, k));
  std::ranges::copy(bits.as_bytes(), to.begin());
}

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

namespace {

using Rgb16 = std::array<int, 3>;

int sign_extended(std::uint32_t value, int bits) {
  const std::uint32_t sign = 1U << (bits - 1);
  return int((value & (2 * sign - 1)) ^ sign) - int(sign);
}

// To the bits of a half: 31/64 of 16 bits end at 65504, the largest.
std::uint16_t finished(int value, bool is_signed) {
  if (!is_signed) return std::uint16_t(value * 31 >> 6);
  return std::uint16_t(value < 0 ? 0x8000 | (-value * 31 >> 5) : value * 31 >> 5);
}

// The four endpoints, differences added up.
std::array<Rgb16, 4> endpoints_of(const Block& block, bool is_signed) {
  const Mode& mode = modes[std::size_t(block.mode)];
  std::array<Rgb16, 4> all{};
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t e = 0; e < 2 * std::size_t(mode.regions); ++e) {
      std::uint32_t value = block.endpoints[e][c];
      if (mode.differences && e > 0)
        value = (block.endpoints[0][c] + std::uint32_t(sign_extended(value, mode.others[c]))) & ((1U << mode.bits) - 1);
      all[e][c] = unquantised(is_signed ? sign_extended(value, mode.bits) : int(value), mode.bits, is_signed);
    }
  return all;
}

}  // namespace

Halves halves_of(std::span<const std::byte, block_bytes> from, bool is_signed) {
  Halves halves{};
  const std::optional<Block> block = unpack(from);
  if (!block) return halves;
  const auto endpoints = endpoints_of(*block, is_signed);
  const bool two = modes[std::size_t(block->mode)].regions == 2;
  const unsigned second = two ? partitions[std::size_t(block->partition)].second : 0U;
  for (std::size_t k = 0; k < block_texels; ++k) {
    const std::size_t first = 2 * (second >> k & 1);
    const int weight = two ? weights_of_8[block->indices[k]] : weights_of_16[block->indices[k]];
    for (std::size_t c = 0; c < 3; ++c)
      halves[3 * k + c] =
          finished((endpoints[first][c] * (64 - weight) + endpoints[first + 1][c] * weight + 32) >> 6, is_signed);
  }
  return halves;
}

}  // namespace envmap::bc6h

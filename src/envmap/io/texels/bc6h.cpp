#include "envmap/io/texels/bc6h.h"

#include <algorithm>
#include <array>
#include <vector>

#include "envmap/io/texels/bc6h_block.h"
#include "envmap/io/texels/bc6h_fit.h"
#include "envmap/io/texels/texels.h"

namespace envmap {
namespace {

using namespace bc6h;

using Rgb16 = std::array<int, 3>;

int sign_extended(std::uint32_t value, int bits) {
  const std::uint32_t sign = 1U << (bits - 1);
  return int((value & (2 * sign - 1)) ^ sign) - int(sign);
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

using Halves = std::array<std::uint16_t, 3 * block_texels>;

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

// Errors count so much more in texels on the border of an image, which meet those of another face: steps across the
// edges of cubes of 256 from three probes are changed by 1.4% to 2.6% of the texels in place of 1.8% to 3.3% (rms), and
// errors over the sphere grow by 0.1% of themselves.
constexpr float border_weight = 4;

// In a block the squares of relative errors count by the texels' radiance, down to this part of the brightest: so that
// a sun keeps its flux, of which it has most.
constexpr float least_weight = 0x1p-10;

// Texels of a row of blocks.
struct Strip {
  std::span<const Colour> colours;
  std::vector<std::uint16_t> halves;
  std::size_t width, rows;
  bool top, bottom;

  [[nodiscard]] bool on_border(std::size_t x, std::size_t y) const {
    return x == 0 || x + 1 == width || (top && y == 0) || (bottom && y + 1 == rows);
  }
};

// Channels that are so much darker than their texel's largest, as bits of halves, are as good as black: beside a red
// sun the blue of its texels would else take all the block's precision. It is 2^-10 of that channel, half of what
// rgb9e5 rounds by.
constexpr std::uint16_t too_dark = 10 << 10;

// Raises those channels towards what their neighbours have, which leaves one that is black in the whole block as it is.
void raise_dark(std::size_t lane, Wanted& wanted) {
  std::array<float, 3> most{};
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t k = 0; k < block_texels; ++k) most[c] = std::max(most[c], wanted.halves[c][k][lane]);
  for (std::size_t k = 0; k < block_texels; ++k) {
    const float largest = std::max({wanted.halves[0][k][lane], wanted.halves[1][k][lane], wanted.halves[2][k][lane]});
    for (std::size_t c = 0; c < 3; ++c) {
      float& half = wanted.halves[c][k][lane];
      half = std::max(half, std::min(largest - too_dark, most[c]));
    }
  }
}

// Block `at` into a lane. Texels beyond the image are its last ones, and count for nothing.
void put(const Strip& strip, std::size_t at, std::size_t lane, Wanted& wanted) {
  std::array<float, block_texels> light;
  for (std::size_t k = 0; k < block_texels; ++k) {
    const std::size_t i = side * at + k % side, j = k / side;
    const std::size_t x = std::min(i, strip.width - 1), y = std::min(j, strip.rows - 1);
    wanted.weights[k][lane] = x != i || y != j ? 0 : strip.on_border(x, y) ? border_weight : 1;
    const Colour& colour = strip.colours[y * strip.width + x];
    light[k] = std::max({colour.x, colour.y, colour.z});
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint16_t half = strip.halves[3 * (y * strip.width + x) + c];
      wanted.halves[c][k][lane] = half & 0x8000 ? 0 : std::min<std::uint16_t>(half, 0x7bff);
    }
  }
  raise_dark(lane, wanted);
  const float most = std::max(std::ranges::max(light), 1e-30F);
  for (std::size_t k = 0; k < block_texels; ++k) wanted.weights[k][lane] *= std::max(light[k] / most, least_weight);
}

Block block_of(const Found& found, std::size_t lane) {
  Block block{.mode = int(found.mode[lane]), .partition = int(found.partition[lane])};
  const Mode& mode = modes[std::size_t(block.mode)];
  for (std::size_t e = 0; e < 2 * std::size_t(mode.regions); ++e)
    for (std::size_t c = 0; c < 3; ++c) {
      const float base = e > 0 && mode.differences ? found.endpoints[0][c][lane] : 0;
      const int bits = e == 0 ? mode.bits : mode.others[c];
      block.endpoints[e][c] = std::uint32_t(int(found.endpoints[e][c][lane] - base)) & ((1U << bits) - 1);
    }
  for (std::size_t k = 0; k < block_texels; ++k) block.indices[k] = std::uint8_t(found.indices[k][lane]);
  return block;
}

}  // namespace

void encode_bc6h(std::span<const Colour> from, std::size_t width, bool top, bool bottom, std::span<std::byte> to) {
  Strip strip{from, std::vector<std::uint16_t>(3 * from.size()), width, from.size() / width, top, bottom};
  to_half({&from.data()->x, 3 * from.size()}, strip.halves);
  Wanted wanted{};
  Found found;
  const std::size_t blocks = to.size() / block_bytes;
  for (std::size_t first = 0; first < blocks; first += batch) {
    const std::size_t count = std::min(batch, blocks - first);
    for (std::size_t lane = 0; lane < count; ++lane) put(strip, first + lane, lane, wanted);
    fit(wanted, found);
    for (std::size_t lane = 0; lane < count; ++lane)
      pack(block_of(found, lane), to.subspan((first + lane) * block_bytes).first<block_bytes>());
  }
}

void decode_bc6h(std::span<const std::byte> from, bool is_signed, std::size_t width, std::span<Colour> to) {
  std::array<float, 3 * block_texels> values;
  for (std::size_t left = 0; left < width; left += side, from = from.subspan(block_bytes)) {
    from_half(halves_of(from.first<block_bytes>(), is_signed), values);
    const std::size_t columns = std::min<std::size_t>(side, width - left);
    for (std::size_t k = 0; k < block_texels; ++k)
      if (k % side < columns)
        to[k / side * width + left + k % side] = Colour(values[3 * k], values[3 * k + 1], values[3 * k + 2]);
  }
}

}  // namespace envmap

#include "envmap/io/block/uastc_hdr_block.h"

#include <algorithm>

#include "envmap/io/block/bits.h"
#include "envmap/io/block/integer_sequence.h"

namespace envmap::uastc_hdr {

using block::Bits;

namespace {

// ASTC's number of each common partition, and whether its first region is BC6H's second.
struct Seed {
  int partition, number;
  bool turned;
};
constexpr std::array<Seed, 27> seeds{{
    {0, 28, false},  {1, 20, false},   {2, 16, true},    {3, 29, false},  {4, 91, true},   {5, 9, false},
    {6, 107, true},  {7, 72, true},    {8, 149, false},  {9, 204, true},  {10, 50, false}, {11, 114, true},
    {12, 496, true}, {13, 17, true},   {14, 78, false},  {15, 39, true},  {17, 252, true}, {18, 828, true},
    {19, 43, false}, {20, 156, false}, {21, 116, false}, {22, 210, true}, {23, 476, true}, {24, 273, false},
    {25, 684, true}, {26, 359, false}, {29, 246, true},
}};
static_assert([] {
  std::uint32_t all = 0;
  for (const Seed& s : seeds) all |= 1U << s.partition;
  return all == common_partitions;
}());

// Counts of levels in the order of the block mode's range: bits 1 0 and 4 say 2 to 7, bit 9 six more.
constexpr std::array<int, 12> level_counts{2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32};

// The block mode of 4x4 indices but for their range: W = B + 4, H = A + 2 with B = 0, A = 2, no second plane.
constexpr std::uint32_t grid_bits = 0x5ec, grid_of_4x4 = 0x40;

// The block mode of one colour in halves, and behind it an extent that says nothing.
constexpr std::uint32_t colour_of_halves = 0xffc;
constexpr int halves_at = 64;
constexpr std::uint16_t largest_half = 0x7bff, half_of_one = 0x3c00;

// Indices of so many levels, whose numbers in the block are not in the order of their weights.
struct Order {
  std::array<std::uint8_t, 16> number{}, index{};
  std::array<int, 16> weight{};  // By index.
};

const Order& order_of(int levels) {
  static const auto all = [] {
    std::array<Order, 17> made;
    for (int n = 3; n <= 16; ++n) {
      if (std::ranges::find(level_counts, n) == level_counts.end()) continue;
      Order& o = made[std::size_t(n)];
      const auto used = std::span(o.number).first(std::size_t(n));
      for (std::size_t k = 0; k < used.size(); ++k) used[k] = std::uint8_t(k);
      std::ranges::sort(used, {}, [n](std::uint8_t k) { return block::weight_of(k, n); });
      for (std::size_t k = 0; k < used.size(); ++k) {
        o.index[used[k]] = std::uint8_t(k);
        o.weight[k] = block::weight_of(used[k], n);
      }
    }
    return made;
  }();
  return all[std::size_t(levels)];
}

std::optional<Block> unpacked_colour(const Bits& bits) {
  Block block;
  for (std::size_t c = 0; c < 3; ++c) {
    block.colour[c] = std::uint16_t(bits.at(halves_at + 16 * int(c), 16));
    if (block.colour[c] > largest_half) return std::nullopt;
  }
  return block;
}

// Where the endpoints begin: behind the block mode, the count of regions, the partition and the endpoint mode.
int endpoints_at(const Mode& mode) { return mode.regions == 1 ? 17 : 29; }

// Regions in ASTC's order of a block's two.
bool is_turned(const Block& block) {
  return modes[std::size_t(block.mode)].regions == 2 &&
         std::ranges::find(seeds, block.partition, &Seed::partition)->turned;
}

// The mode and partition that the first bits say.
std::optional<Block> unpacked_head(const Bits& bits) {
  const std::uint32_t word = bits.at(0, 11), range = (word >> 4 & 1) | (word & 3) << 1;
  if ((word & grid_bits) != grid_of_4x4 || range < 2) return std::nullopt;
  const int weights = level_counts[range - 2 + 6 * (word >> 9 & 1)], regions = int(bits.at(11, 2)) + 1;
  if (regions == 2 && bits.at(23, 2) != 0) return std::nullopt;  // Endpoint modes that differ.
  const int ends = int(bits.at(regions == 1 ? 13 : 25, 4));
  const auto* const mode = std::ranges::find_if(modes, [&](const Mode& m) {
    return m.regions == regions && int(m.ends) == ends && m.weights == weights;
  });
  if (mode == modes.end()) return std::nullopt;
  Block block{.mode = int(mode - modes.begin())};
  if (regions == 1) return block;
  const auto* const seed = std::ranges::find(seeds, int(bits.at(13, 10)), &Seed::number);
  if (seed == seeds.end()) return std::nullopt;
  block.partition = seed->partition;
  return block;
}

}  // namespace

std::optional<Block> unpack(std::span<const std::byte, block_bytes> from) {
  Bits bits(from);
  if (bits.at(0, 12) == colour_of_halves) return unpacked_colour(bits);
  std::optional<Block> block = unpacked_head(bits);
  if (!block) return block;
  const Mode& mode = modes[std::size_t(block->mode)];
  const auto count = std::size_t(bytes_of(mode.ends));
  std::array<std::uint8_t, 12> numbers{};
  bits.go_to(endpoints_at(mode));
  block::take_sequence(bits, mode.bytes, std::span(numbers).first(count * std::size_t(mode.regions)));
  const bool turned = is_turned(*block);
  for (std::size_t r = 0; r < std::size_t(mode.regions); ++r) {
    auto& bytes = block->endpoints[turned ? 1 - r : r];
    for (std::size_t k = 0; k < count; ++k) bytes[k] = byte_levels(mode.bytes).value(numbers[r * count + k]);
    for (const Rgb& end : ends_of(mode.ends, bytes))
      if (std::ranges::max(end) > largest_end) return std::nullopt;
  }
  Bits behind = bits.reversed();
  block::take_sequence(behind, mode.weights, block->indices);
  for (std::uint8_t& index : block->indices) index = order_of(mode.weights).index[index];
  return block;
}

void pack(const Block& block, std::span<std::byte, block_bytes> to) {
  Bits bits;
  if (block.mode == one_colour) {
    bits.put(colour_of_halves, 12);
    for (int k = 12; k < halves_at; ++k) bits.put(1, 1);
    for (const std::uint16_t half : block.colour) bits.put(half, 16);
    bits.put(half_of_one, 16);
    std::ranges::copy(bits.as_bytes(), to.begin());
    return;
  }
  const Mode& mode = modes[std::size_t(block.mode)];
  const auto range = std::uint32_t(std::ranges::find(level_counts, mode.weights) - level_counts.begin()),
             r = range % 6 + 2;
  bits.put(grid_of_4x4 | (r & 1) << 4 | r >> 1 | range / 6 << 9, 11);
  bits.put(std::uint32_t(mode.regions) - 1, 2);
  if (mode.regions == 2) {
    bits.put(std::uint32_t(std::ranges::find(seeds, block.partition, &Seed::partition)->number), 10);
    bits.put(0, 2);
  }
  bits.put(std::uint32_t(mode.ends), 4);
  const auto count = std::size_t(bytes_of(mode.ends));
  const bool turned = is_turned(block);
  std::array<std::uint8_t, 12> numbers{};
  for (std::size_t region = 0; region < std::size_t(mode.regions); ++region)
    for (std::size_t k = 0; k < count; ++k)
      numbers[region * count + k] = byte_levels(mode.bytes).number(block.endpoints[turned ? 1 - region : region][k]);
  block::put_sequence(bits, mode.bytes, std::span(numbers).first(count * std::size_t(mode.regions)));
  std::array<std::uint8_t, block_texels> indices{};
  std::ranges::transform(block.indices, indices.begin(),
                         [&](std::uint8_t index) { return order_of(mode.weights).number[index]; });
  Bits behind;
  block::put_sequence(behind, mode.weights, indices);
  bits |= behind.reversed();
  std::ranges::copy(bits.as_bytes(), to.begin());
}

int weight(const Mode& mode, int index) { return order_of(mode.weights).weight[std::size_t(index)]; }

Halves halves_of(const Block& block) {
  Halves halves{};
  if (block.mode == one_colour) {
    for (std::size_t k = 0; k < halves.size(); ++k) halves[k] = block.colour[k % 3];
    return halves;
  }
  const Mode& mode = modes[std::size_t(block.mode)];
  const unsigned second = mode.regions == 2 ? block::partitions[std::size_t(block.partition)].second : 0U;
  const std::array ends{ends_of(mode.ends, block.endpoints[0]), ends_of(mode.ends, block.endpoints[1])};
  for (std::size_t k = 0; k < block_texels; ++k) {
    const auto& [first, last] = ends[second >> k & 1];
    const int w = weight(mode, block.indices[k]);
    for (std::size_t c = 0; c < 3; ++c)
      halves[3 * k + c] = std::uint16_t(half_of_log(((first[c] << 4) * (64 - w) + (last[c] << 4) * w + 32) >> 6));
  }
  return halves;
}

}  // namespace envmap::uastc_hdr

#include "envmap/io/block/bc6h.h"

#include <algorithm>
#include <array>

#include "envmap/io/block/bc6h_block.h"
#include "envmap/io/block/bc6h_fit.h"
#include "envmap/io/block/weighted_halves.h"
#include "envmap/io/texels/texels.h"

namespace envmap {
namespace {

using namespace bc6h;

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
  const block::Strip strip(from, width, top, bottom);
  WeightedHalves wanted{};
  Found found;
  const std::size_t blocks = to.size() / block_bytes;
  for (std::size_t first = 0; first < blocks; first += batch) {
    const std::size_t count = std::min(batch, blocks - first);
    for (std::size_t lane = 0; lane < count; ++lane) strip.put(first + lane, lane, wanted);
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

#include "envmap/io/block/uastc_hdr.h"

#include <algorithm>
#include <array>

#include "envmap/base/error.h"
#include "envmap/io/block/uastc_hdr_block.h"
#include "envmap/io/block/uastc_hdr_fit.h"
#include "envmap/io/block/weighted_halves.h"
#include "envmap/io/texels/texels.h"

namespace envmap {
namespace {

using namespace uastc_hdr;

// The one colour of a lane's texels, which a block holds exactly.
bool is_one_colour(const block::WeightedHalves& wanted, std::size_t lane, Block& block) {
  for (std::size_t c = 0; c < 3; ++c) {
    const auto& halves = wanted.halves[c];
    for (const auto& texel : halves)
      if (texel[lane] != halves[0][lane]) return false;
    block.colour[c] = std::uint16_t(halves[0][lane]);
  }
  block.mode = one_colour;
  return true;
}

Block unpacked(std::span<const std::byte> from) {
  if (const auto block = unpack(from.first<block_bytes>())) return *block;
  throw InputError("not supported or damaged: a block of ASTC is none of UASTC HDR 4x4");
}

}  // namespace

void decode_uastc_hdr(std::span<const std::byte> from, std::size_t width, std::span<Colour> to) {
  std::array<float, 3 * block_texels> values;
  for (std::size_t left = 0; left < width; left += side, from = from.subspan(block_bytes)) {
    from_half(halves_of(unpacked(from)), values);
    const std::size_t columns = std::min<std::size_t>(side, width - left);
    for (std::size_t k = 0; k < block_texels; ++k)
      if (k % side < columns)
        to[k / side * width + left + k % side] = Colour(values[3 * k], values[3 * k + 1], values[3 * k + 2]);
  }
}

void transcode_to_bc6h(std::span<std::byte> blocks) {
  for (; !blocks.empty(); blocks = blocks.subspan(block_bytes))
    bc6h::pack(to_bc6h(unpacked(blocks)), blocks.first<block_bytes>());
}

void encode_uastc_hdr(std::span<const Colour> from, std::size_t width, bool top, bool bottom, std::span<std::byte> to) {
  const block::Strip strip(from, width, top, bottom);
  block::WeightedHalves wanted{};
  Found found;
  const std::size_t blocks = to.size() / block_bytes;
  for (std::size_t first = 0; first < blocks; first += block::batch) {
    const std::size_t count = std::min(block::batch, blocks - first);
    for (std::size_t lane = 0; lane < count; ++lane) strip.put(first + lane, lane, wanted);
    fit(wanted, found);
    for (std::size_t lane = 0; lane < count; ++lane) {
      Block& block = found.blocks[lane];
      is_one_colour(wanted, lane, block);
      pack(block, to.subspan((first + lane) * block_bytes).first<block_bytes>());
    }
  }
}

}  // namespace envmap

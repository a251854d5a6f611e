#include "envmap/io/block/bc6h.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "envmap/io/block/bc6h_block.h"
#include "envmap/io/block/uastc_hdr.h"
#include "envmap/io/block/uastc_hdr_block.h"
#include "targets.h"

using namespace envmap;

namespace {

using Stored = std::array<std::byte, bc6h::block_bytes>;

// What a block says is kept where it is packed again.
void expect_packed(std::span<const std::byte, bc6h::block_bytes> bytes) {
  const auto said = bc6h::unpack(bytes);
  if (!said) return;
  Stored packed{};
  bc6h::pack(*said, packed);
  const auto again = bc6h::unpack(packed);
  if (!again || again->mode != said->mode || again->partition != said->partition ||
      again->endpoints != said->endpoints || again->indices != said->indices)
    std::abort();
}

// The same of UASTC HDR, and BC6H of finite values is made of it.
void expect_transcoded(std::span<const std::byte, bc6h::block_bytes> bytes) {
  const auto said = uastc_hdr::unpack(bytes);
  if (!said) return;
  Stored packed{};
  uastc_hdr::pack(*said, packed);
  const auto again = uastc_hdr::unpack(packed);
  if (!again || again->mode != said->mode || again->partition != said->partition ||
      again->endpoints != said->endpoints || again->indices != said->indices || again->colour != said->colour)
    std::abort();
  transcode_to_bc6h(packed);
  if (!bc6h::unpack(packed)) std::abort();
}

void expect_halves(std::span<const Colour> texels, float least) {
  constexpr float largest = 65504;
  for (const Colour& c : texels)
    for (int k = 0; k < 3; ++k)
      if (!(c[k] >= least && c[k] <= largest)) std::abort();
}

}  // namespace

void fuzz_bc6h(Bytes bytes) {
  if (bytes.empty()) return;
  constexpr std::size_t most = 8;
  const std::size_t blocks = std::min(most, bytes.size() / bc6h::block_bytes);
  const std::span row = bytes.first(blocks * bc6h::block_bytes);
  for (std::size_t k = 0; k < blocks; ++k) {
    expect_packed(row.subspan(k * bc6h::block_bytes).first<bc6h::block_bytes>());
    expect_transcoded(row.subspan(k * bc6h::block_bytes).first<bc6h::block_bytes>());
  }

  const std::size_t beyond = std::to_integer<std::size_t>(bytes.back()) % bc6h::side;  // Texels outside of the image.
  if (blocks == 0) return;
  const std::size_t width = blocks * bc6h::side - beyond;
  std::vector<Colour> texels(bc6h::side * width);
  decode_bc6h(row, true, width, texels);
  expect_halves(texels, -65504);
  decode_bc6h(row, false, width, texels);
  expect_halves(texels, 0);

  std::vector<std::byte> encoded(row.size());
  encode_bc6h(texels, width, beyond & 1, beyond & 2, encoded);
  decode_bc6h(encoded, false, width, texels);
  expect_halves(texels, 0);
  encode_uastc_hdr(texels, width, beyond & 1, beyond & 2, encoded);
  decode_uastc_hdr(encoded, width, texels);
  expect_halves(texels, 0);
}

#include "envmap/io/block/weighted_halves.h"

#include <algorithm>

#include "envmap/io/texels/texels.h"

namespace envmap::block {
namespace {

// Errors count so much more in texels on the border of an image, which meet those of another face: steps across the
// edges of cubes of 256 from three probes are changed by 1.4% to 2.6% of the texels in place of 1.8% to 3.3% (rms), and
// errors over the sphere grow by 0.1% of themselves.
constexpr float border_weight = 4;

// In a block the squares of relative errors count by the texels' radiance, down to this part of the brightest: so that
// a sun keeps its flux, of which it has most.
constexpr float least_weight = 0x1p-10;

// Channels that are so much darker than their texel's largest, as bits of halves, are as good as black: beside a red
// sun the blue of its texels would else take all the block's precision. It is 2^-10 of that channel, half of what
// rgb9e5 rounds by.
constexpr std::uint16_t too_dark = 10 << 10;

// Raises those channels towards what their neighbours have, which leaves one that is black in the whole block as it is.
void raise_dark(std::size_t lane, WeightedHalves& wanted) {
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

}  // namespace

Strip::Strip(std::span<const Colour> from, std::size_t width, bool top, bool bottom)
    : colours_(from), halves_(3 * from.size()), width_(width), rows_(from.size() / width), top_(top), bottom_(bottom) {
  to_half({&from.data()->x, 3 * from.size()}, halves_);
}

bool Strip::on_border(std::size_t x, std::size_t y) const {
  return x == 0 || x + 1 == width_ || (top_ && y == 0) || (bottom_ && y + 1 == rows_);
}

void Strip::put(std::size_t at, std::size_t lane, WeightedHalves& wanted) const {
  std::array<float, block_texels> light;
  for (std::size_t k = 0; k < block_texels; ++k) {
    const std::size_t i = side * at + k % side, j = k / side;
    const std::size_t x = std::min(i, width_ - 1), y = std::min(j, rows_ - 1);
    wanted.weights[k][lane] = x != i || y != j ? 0 : on_border(x, y) ? border_weight : 1;
    const Colour& colour = colours_[y * width_ + x];
    light[k] = std::max({colour.x, colour.y, colour.z});
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint16_t half = halves_[3 * (y * width_ + x) + c];
      wanted.halves[c][k][lane] = half & 0x8000 ? 0 : std::min<std::uint16_t>(half, 0x7bff);
    }
  }
  raise_dark(lane, wanted);
  const float most = std::max(std::ranges::max(light), 1e-30F);
  for (std::size_t k = 0; k < block_texels; ++k) wanted.weights[k][lane] *= std::max(light[k] / most, least_weight);
}

}  // namespace envmap::block

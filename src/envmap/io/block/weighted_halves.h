/// @file
/// Texels as the encoders of blocks want them: bits of halves, which are as good as the logarithm of radiance, and how
/// much each counts. What encoders make least is the weighted sum of squares there.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "envmap/io/block/texel_block.h"
#include "envmap/maths/vector.h"

namespace envmap::block {

/// So many blocks at once, each in a lane.
inline constexpr std::size_t batch = 16;

template <class T>
using Lanes = std::array<T, batch>;

struct alignas(64) WeightedHalves {
  std::array<std::array<Lanes<float>, block_texels>, 3> halves;  ///< Of red, green, blue: bits of halves, 0 to 0x7bff.
  std::array<Lanes<float>, block_texels> weights;                ///< 0: whatever comes out.
};

/// Texels of a row of blocks.
class Strip {
 public:
  /// @param from up to four rows of `width` texels. @param top, bottom whether the image begins or ends here.
  Strip(std::span<const Colour> from, std::size_t width, bool top, bool bottom);

  /// Block `at` into a lane. Texels beyond the image are its last ones, and count for nothing.
  void put(std::size_t at, std::size_t lane, WeightedHalves& wanted) const;

 private:
  [[nodiscard]] bool on_border(std::size_t x, std::size_t y) const;

  std::span<const Colour> colours_;
  std::vector<std::uint16_t> halves_;
  std::size_t width_, rows_;
  bool top_, bottom_;
};

}  // namespace envmap::block

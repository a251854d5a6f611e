/// @file
/// Sums for the texels of a result that a part of the source gives light to.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <unordered_map>
#include <vector>

#include "envmap/maths/vector.h"

namespace envmap {

/// What has fallen into a texel of the result.
struct Caught {
  Direction light{0};
  double weight = 0;
  Colour low{std::numeric_limits<float>::max()};  // The least radiance of each channel.

  void add(const Caught& other) {
    light += other.light;
    weight += other.weight;
    low = glm::min(low, other.low);
  }
  // The mean over `steradians`, which `weight` meets but for the errors along the borders: those count for what is evenly
  // there, as so much more or less of it, and not for a sun, whose light must not be stretched with them.
  [[nodiscard]] Colour mean(double steradians) const {
    return Colour(Direction(low) + (light - weight * Direction(low)) / steradians);
  }
};

/// Sums over a part of the result, kept for those tiles of it that are touched.
class Tiles {
 public:
  Tiles(int width, int height)
      : across_((width + tile_side - 1) / tile_side), down_((height + tile_side - 1) / tile_side) {}

  Caught& at(int face, int x, int y) {
    const int tile = (face * down_ + y / tile_side) * across_ + x / tile_side;
    if (tile != last_) {
      auto& found = tiles_[tile];
      if (!found) found = std::make_unique<Tile>();
      last_ = tile;
      open_ = found.get();
    }
    return (*open_)[static_cast<std::size_t>(y % tile_side * tile_side + x % tile_side)];
  }

  // Adds all to the sums of the whole result. Each texel has one sum here: the order of the tiles does not matter.
  void add_to(std::vector<Caught>& sums, int width, int height) const {
    for (const auto& [index, tile] : tiles_) {
      const int face = index / (across_ * down_), x0 = index % across_ * tile_side, y0 = index / across_ % down_ * tile_side;
      for (int y = y0; y < std::min(y0 + tile_side, height); ++y)
        for (int x = x0; x < std::min(x0 + tile_side, width); ++x) {
          const Caught& from = (*tile)[static_cast<std::size_t>((y - y0) * tile_side + x - x0)];
          Caught& to =
              sums[(static_cast<std::size_t>(face) * static_cast<std::size_t>(height) + static_cast<std::size_t>(y)) *
                       static_cast<std::size_t>(width) +
                   static_cast<std::size_t>(x)];
          to.add(from);
        }
    }
  }

 private:
  static constexpr int tile_side = 16;
  using Tile = std::array<Caught, tile_side * tile_side>;
  int across_, down_, last_ = -1;
  Tile* open_ = nullptr;
  std::unordered_map<int, std::unique_ptr<Tile>> tiles_;
};

}  // namespace envmap

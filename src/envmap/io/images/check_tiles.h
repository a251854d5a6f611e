/// @file
/// Tiles that a header promises, against the image that they are of.
#pragma once

#include <fmt/format.h>

#include <algorithm>

#include "envmap/base/error.h"
#include "envmap/io/images/image_reader.h"

namespace envmap {

/// A tile may reach beyond the image, but the libraries take memory for all of it, and divide by its sides.
/// @throws InputError
inline void check_tiles(const ImageFacts& f) {
  constexpr int roomy = 4096;
  const auto sound = [&](int tile, int side) { return tile > 0 && tile <= std::max(side, roomy); };
  const bool tiled = f.tile_width != 0 || f.tile_height != 0;
  if (tiled && (!sound(f.tile_width, f.width) || !sound(f.tile_height, f.height)))
    throw InputError(
        fmt::format("damaged: tiles of {}x{} in an image of {}x{}", f.tile_width, f.tile_height, f.width, f.height));
}

}  // namespace envmap

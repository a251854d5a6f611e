#include "envmap/io/images/data_window.h"

#include <algorithm>

namespace envmap {

ImageReader in_window(ImageReader stored, const DataWindow& window) {
  ImageReader image{.format = stored.format, .facts = stored.facts, .read = {}};
  image.facts.width = window.width;
  image.facts.height = window.height;
  image.facts.tile_width = image.facts.tile_height = 0;
  image.read = [stored = std::move(stored), window](int, int begin, int end, int first, int count,
                                                    std::span<float> out) {
    std::ranges::fill(out, 0.0F);
    const ImageFacts& has = stored.facts;
    // Whole rows of tiles, where it is in tiles.
    const std::int64_t unit = std::max(1, has.tile_height), width = has.width, height = has.height;
    const auto in_file = [&](std::int64_t row) { return std::clamp<std::int64_t>(row - window.y, 0, height); };
    const std::int64_t top = in_file(begin) / unit * unit;
    const std::int64_t bottom = std::min(height, (in_file(end) + unit - 1) / unit * unit);
    const std::int64_t left = std::max<std::int64_t>(0, -window.x), right = std::min(width, window.width - window.x);
    if (top >= bottom || left >= right) return;
    const auto at = [count](std::int64_t across, std::int64_t row, std::int64_t column) {
      return std::size_t((row * across + column) * count);
    };
    std::vector<float> rows(at(width, bottom - top, 0));
    stored.read(0, int(top), int(bottom), first, count, rows);
    for (std::int64_t row = in_file(begin); row < in_file(end); ++row) {
      const auto from = std::span(rows).subspan(at(width, row - top, left), at(1, right - left, 0));
      std::ranges::copy(from, out.subspan(at(window.width, row + window.y - begin, left + window.x)).begin());
    }
  };
  return image;
}

}  // namespace envmap

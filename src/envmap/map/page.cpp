#include "envmap/map/page.h"

#include <algorithm>

namespace envmap {
namespace {

// The columns of one face in row y of an image band that begins at row `begin`.
template <class T>
std::span<T> part(std::span<T> band, int y, int begin, int columns, const Slot& slot, int face_width) {
  const auto w = static_cast<std::size_t>(face_width);
  return band.subspan((static_cast<std::size_t>(y - begin) * static_cast<std::size_t>(columns) +
                       static_cast<std::size_t>(slot.column)) * w, w);
}

}  // namespace

void Page::gather(int begin, int end, std::span<Colour> out) const {
  std::ranges::fill(out, Colour(0));
  const int h = level.height();
  const auto place = [&](int f, const Slot& slot) {
    for (int y = std::max(begin, slot.row * h); y < std::min(end, (slot.row + 1) * h); ++y) {
      const int j = y - slot.row * h;
      const auto to = part(out, y, begin, face < 0 ? grid.columns : 1, slot, level.width());
      std::ranges::copy(level.row(f, slot.turned ? h - 1 - j : j), to.begin());
      if (slot.turned) std::ranges::reverse(to);
    }
  };
  if (face >= 0) return place(face, {0, 0});
  for (int f = 0; f < level.faces(); ++f) place(f, grid.slots[static_cast<std::size_t>(f)]);
}

void scatter(std::span<const Colour> rows, int begin, int end, const Grid& grid, Level& level) {
  const int h = level.height();
  for (int f = 0; f < level.faces(); ++f) {
    const Slot& slot = grid.slots[static_cast<std::size_t>(f)];
    for (int y = std::max(begin, slot.row * h); y < std::min(end, (slot.row + 1) * h); ++y) {
      const int j = y - slot.row * h;
      const auto to = level.row(f, slot.turned ? h - 1 - j : j);
      std::ranges::copy(part(rows, y, begin, grid.columns, slot, level.width()), to.begin());
      if (slot.turned) std::ranges::reverse(to);
    }
  }
}

}  // namespace envmap

#include "envmap/map/page.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace envmap {
namespace {

// The columns of one face in row y of an image band that begins at row `begin`.
template <class T>
std::span<T> part(std::span<T> band, int y, int begin, int columns, const Slot& slot, int face_width) {
  const auto w = static_cast<std::size_t>(face_width);
  return band.subspan((static_cast<std::size_t>(y - begin) * static_cast<std::size_t>(columns) +
                       static_cast<std::size_t>(slot.column)) *
                          w,
                      w);
}

}  // namespace

Rows rows_of(const EnvironmentMap& map) {
  return {map.projection(), map.base().height(), map.forward, [&level = map.base()](int face, int row, std::span<Colour> out) {
            std::ranges::copy(level.row(face, row), out.begin());
          }};
}

void Page::gather(int begin, int end, std::span<Colour> out) const {
  const int h = rows.size, columns = face < 0 ? grid.columns : 1;
  const auto fill = [&](int f, const Slot& slot, int y) {
    const int j = y - slot.row * h;
    if (j < 0 || j >= h) return;
    const auto to = part(out, y, begin, columns, slot, face_width());
    rows.fill(f, slot.turned ? h - 1 - j : j, to);
    if (slot.turned) std::ranges::reverse(to);
  };
  tbb::parallel_for(begin, end, [&](int y) {
    std::ranges::fill(out.subspan(static_cast<std::size_t>(y - begin) * static_cast<std::size_t>(width()),
                                  static_cast<std::size_t>(width())),
                      Colour(0));
    if (face >= 0) return fill(face, {0, 0}, y);
    for (std::size_t f = 0; f < grid.slots.size(); ++f) fill(static_cast<int>(f), grid.slots[f], y);
  });
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

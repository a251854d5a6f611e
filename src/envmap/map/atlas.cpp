#include "envmap/map/atlas.h"

#include <algorithm>

#include "envmap/base/parallel.h"

namespace envmap {
namespace {

// The columns of one face in row y of an image band that begins at row `begin`.
template <class T>
std::span<T> part(std::span<T> band, int width, int y, int begin, const Slot& slot, int face_width) {
  const auto row = std::size_t(y - begin) * std::size_t(width);
  return band.subspan(row + std::size_t(slot.column * face_width), std::size_t(face_width));
}

}  // namespace

void Atlas::gather(int begin, int end, std::span<Colour> out) const {
  const int h = rows.size, w = width();
  const auto fill = [&](int f, const Slot& slot, int y) {
    const int j = y - slot.row * h;
    if (j < 0 || j >= h) return;
    const auto to = part(out, w, y, begin, slot, rows.width());
    rows.fill(f, slot.turned ? h - 1 - j : j, to);
    if (slot.turned) std::ranges::reverse(to);
  };
  parallel_for(end - begin, [&](int line) {
    const int y = begin + line;
    std::ranges::fill(out.subspan(std::size_t(line) * std::size_t(w), std::size_t(w)), background);
    if (face >= 0) return fill(face, {0, 0}, y);
    for (std::size_t f = 0; f < grid.slots.size(); ++f) fill(int(f), grid.slots[f], y);
  });
}

std::vector<char> shown_rows(const Grid& grid, int size, const RowRange& rows) {
  std::vector<char> shown;
  for (const Slot& slot : grid.slots)
    for (int j = 0; j < size; ++j) {
      const int y = slot.row * size + (slot.turned ? size - 1 - j : j);
      shown.push_back(y >= rows.begin && y < rows.end ? 1 : 0);
    }
  return shown;
}

Rows some_rows(Rows rows, const std::vector<char>& wanted) {
  if (wanted.empty()) return rows;
  Rows some = rows;
  some.fill = [rows = std::move(rows), wanted](int face, int row, std::span<Colour> out) {
    if (wanted[std::size_t(face * rows.size + row)] != 0)
      rows.fill(face, row, out);
    else
      std::ranges::fill(out, Colour(0));
  };
  return some;
}

void scatter(std::span<const Colour> rows, int width, int begin, int end, const Grid& grid, Level& level) {
  const int h = level.height();
  for (int f = 0; f < level.faces(); ++f) {
    const Slot& slot = grid.slots[f];
    for (int y = std::max(begin, slot.row * h); y < std::min(end, (slot.row + 1) * h); ++y) {
      const int j = y - slot.row * h;
      const auto to = level.row(f, slot.turned ? h - 1 - j : j);
      std::ranges::copy(part(rows, width, y, begin, slot, level.width()), to.begin());
      if (slot.turned) std::ranges::reverse(to);
    }
  }
}

}  // namespace envmap

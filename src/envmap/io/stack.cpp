#include "envmap/io/stack.h"

#include <vector>

#include "envmap/map/atlas.h"

namespace envmap {

Rows stacked(std::span<const Rows> levels, const Grid& places, std::span<const RowRange> ranges) {
  struct Line {
    std::size_t level;
    int row;
  };
  std::vector<Line> lines;
  for (std::size_t k = 0; k < ranges.size(); ++k)
    for (int y = ranges[k].begin; y < ranges[k].end; ++y) lines.push_back({k, y});
  Rows all = levels.front();
  all.size = int(lines.size());
  all.columns = places.columns * levels.front().width();
  all.fill = [levels, places, lines](int, int y, std::span<Colour> out) {
    const auto [level, row] = lines[std::size_t(y)];
    const Atlas atlas{levels[level], places};
    atlas.gather(row, row + 1, out.first(std::size_t(atlas.width())));
  };
  return all;
}

}  // namespace envmap

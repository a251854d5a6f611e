#include "envmap/map/rows.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace envmap {

Rows rows_of(const Level& level, Forward forward) {
  return {level.projection(), level.height(), forward,
          [&level](int face, int row, std::span<Colour> out) {
            std::ranges::copy(level.row(face, row), out.begin());
            level.trim();
          },
          level.width()};
}

Rows rows_of(const EnvironmentMap& map) { return rows_of(map.base(), map.forward); }

std::vector<Rows> all_rows_of(const EnvironmentMap& map) {
  std::vector<Rows> all;
  for (const Level& level : map.levels) all.push_back(rows_of(level, map.forward));
  return all;
}

Level level_of(const Rows& rows) {
  Level level(rows.projection, rows.size, rows.width());
  tbb::parallel_for(0, level.faces() * rows.size,
                    [&](int k) { rows.fill(k / rows.size, k % rows.size, level.row(k / rows.size, k % rows.size)); });
  return level;
}

}  // namespace envmap

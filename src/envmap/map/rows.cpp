#include "envmap/map/rows.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/map/check_chain.h"
#include "envmap/map/check_row.h"

namespace envmap {

Rows rows_of(const Level& level, Forward forward) {
  return {level.projection(), level.height(), forward,
          [&level](int face, int row, std::span<Colour> out) {
            check_row(level.faces(), level.height(), level.width(), face, row, out.size());
            std::ranges::copy(level.row(face, row), out.begin());
            level.trim();
          },
          level.width()};
}

Rows rows_of(Level&& level, Forward forward) {
  const auto kept = std::make_shared<const Level>(std::move(level));
  Rows rows = rows_of(*kept, forward);
  rows.fill = [kept, fill = std::move(rows.fill)](int face, int row, std::span<Colour> out) { fill(face, row, out); };
  return rows;
}

Rows rows_of(EnvironmentMap&& map) { return rows_of(std::move(map.base()), map.forward); }

Rows rows_of(const EnvironmentMap& map) { return rows_of(map.base(), map.forward); }

std::vector<Rows> all_rows_of(const EnvironmentMap& map) {
  std::vector<Rows> all;
  for (const Level& level : map.levels) all.push_back(rows_of(level, map.forward));
  return all;
}

std::vector<Rows> all_rows_of(EnvironmentMap&& map) {
  std::vector<Rows> all;
  for (Level& level : map.levels) all.push_back(rows_of(std::move(level), map.forward));
  return all;
}

Rows with_x_negated(const Rows& rows) {
  check_rows(rows);
  Rows negated = rows;
  negated.fill = [rows](int face, int row, std::span<Colour> out) {
    rows.fill(rows.projection == Projection::cube && face < 2 ? 1 - face : face, row, out);
    std::ranges::reverse(out);
  };
  return negated;
}

void check_rows(const Rows& rows) {
  if (!rows.fill) throw UsageError("rows need a function that fills them");
  check_enumerator("forward", rows.forward);
  check_range(limits::level_height, rows.size);
  if (rows.columns != 0) check_face_size(rows.projection, {rows.columns, rows.size});
}

Level level_of(const Rows& rows) {
  check_rows(rows);
  Level level(rows.projection, rows.size, rows.width());
  parallel_for(level.faces() * rows.size,
               [&](int k) { rows.fill(k / rows.size, k % rows.size, level.row(k / rows.size, k % rows.size)); });
  return level;
}

}  // namespace envmap

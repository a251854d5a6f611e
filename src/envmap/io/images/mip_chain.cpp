#include "envmap/io/images/mip_chain.h"

#include <algorithm>

#include "envmap/operate/levels.h"

namespace envmap {

MipChain::MipChain(std::span<const Rows> levels, Layout layout, bool to_one_texel) {
  const Grid places = grid(layout);
  const Atlas base{levels.front(), places};
  const bool fill = layout != Layout::api;
  const auto wide = [&](std::size_t k) { return fill ? std::max(1, base.width() >> k) : 0; };
  const auto high = [&](std::size_t k) { return fill ? std::max(1, base.height() >> k) : 0; };
  for (std::size_t k = 0; k < levels.size(); ++k) atlases_.push_back({levels[k], places, -1, wide(k), high(k)});
  if (!to_one_texel) return;

  more_.push_back(level_of(levels.back()));
  while (has_next(more_.back())) more_.push_back(half_level(more_.back()));
  for (const Level& level : more_) rows_.push_back(rows_of(level, levels.front().forward));
  for (std::size_t k = 1; k < rows_.size(); ++k)
    atlases_.push_back({rows_[k], places, -1, wide(atlases_.size()), high(atlases_.size())});
  Colour mean(0);
  for (int f = 0; f < more_.back().faces(); ++f) mean += *more_.back().texel(f, 0, 0);
  mean /= float(more_.back().faces());
  while (atlases_.back().width() > 1 || atlases_.back().height() > 1)
    atlases_.push_back({rows_.back(), {1, 1, {}}, -1, wide(atlases_.size()), high(atlases_.size()), mean});
}

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

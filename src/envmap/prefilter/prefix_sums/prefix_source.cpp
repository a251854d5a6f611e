// Builds the levels of cells and their prefix sums. Bands of rows are summed in parallel, each row of texels is read
// once, and coarser levels are sums of finer ones.
#include "envmap/prefilter/prefix_sums/prefix_source.h"

#include <algorithm>

#include "envmap/base/parallel.h"

namespace envmap::prefiltering {

namespace {

constexpr std::size_t flux = 9, least = 12, numbers = 15;  // Places in a cell.

std::size_t place(int rows, int columns, int face, int row) {
  return std::size_t(face * rows + row) * std::size_t(columns);
}

}  // namespace

// The cells of one row of each level, while they are summed.
template <class Grid>
struct PrefixSumSource<Grid>::Rows {
  std::vector<std::vector<CellSum>> sums;
  std::vector<BlockMoments> base;  // All moments of base cells.

  static CellSum nothing() {
    CellSum s{};
    std::fill(s.begin() + least, s.end(), std::numeric_limits<double>::max());
    return s;
  }
  explicit Rows(std::span<const Cells> levels) {  // Levels from the finest to the base.
    for (const Cells& level : levels) sums.emplace_back(std::size_t(level.grid.across.count()), nothing());
    base.resize(sums.back().size());
  }
};

template <class Grid>
PrefixSumSource<Grid>::PrefixSumSource(const Level& source, double mean, const Colour& min_radiance, int rows,
                                       int fewest, int order)
    : source_(source),
      min_radiance_(min_radiance),
      unit_(1 / mean),
      order_(order),
      grid_(source.width(), source.height()) {
  const int height = source.height();
  int side = 1;  // Of the smallest cells. Where finer ones are needed, which is seldom, their texels serve.
  while (side < 4 && height / (4 * side) >= rows) side *= 2;
  std::size_t before_base = 0;
  for (bool more = true; more; side *= 2) {
    typename Grid::Cells grid = grid_.cells(side);
    const std::size_t count = place(grid.down.count(), grid.across.count(), Grid::faces, 0);
    levels_.push_back({std::move(grid), std::make_unique_for_overwrite<CellLight[]>(count)});
    more = height / (2 * side) >= fewest;
    if (more && height / (2 * side) >= rows) ++before_base;
  }
  prefixes_.resize(levels_.size() - before_base);
  prefixes_.front().resize(prefix_place(before_base, Grid::faces, 0));
  parallel_for(levels_[base()].grid.down.count(), [&](int band) { set_band(band); });
  for (std::size_t level = base() + 1; level < levels_.size(); ++level) {
    set_coarser_cells(level);
    prefixes_[level - base()] = coarser(level);
  }
}

template <class Grid>
std::size_t PrefixSumSource<Grid>::prefix_place(std::size_t level, int face, int row) const {
  const auto& grid = levels_[level].grid;
  return place(grid.down.count(), grid.across.count() + 1, face, row) * stride();
}

// Sums a row of base cells and all finer cells in it, on all faces.
template <class Grid>
void PrefixSumSource<Grid>::set_band(int band) {
  const auto &grid = levels_[base()].grid, &fine = levels_.front().grid;
  const int steps = grid.across.side / fine.across.side, first = band * steps;
  std::vector<Rows> rows(Grid::faces, Rows(levels().first(base() + 1)));
  for (int row = first; row < std::min(first + steps, fine.down.count()); ++row) {
    std::vector<typename Grid::Row> texels;  // All faces share them.
    for (int j = fine.down.first(row); j < fine.down.end(row); ++j) texels.push_back(grid_.row(j, order_));
    for (int face = 0; face < Grid::faces; ++face) add_row(face, row, texels, rows[std::size_t(face)]);
  }
  for (int face = 0; face < Grid::faces; ++face) {
    double* p = &prefixes_.front()[prefix_place(base(), face, band)];
    for (const BlockMoments& b : rows[std::size_t(face)].base)
      for (std::size_t k = 0; k < stride(); ++k, ++p) p[stride()] = *p + unit_ * b.moments[1 + k / 3][k % 3];
  }
  source_.trim();
}

// Each cell is the sum of up to four cells of the level before.
template <class Grid>
void PrefixSumSource<Grid>::set_coarser_cells(std::size_t level) {
  const auto &grid = levels_[level].grid, &fine = levels_[level - 1].grid;
  for (int face = 0; face < Grid::faces; ++face)
    for (int row = 0; row < grid.down.count(); ++row)
      for (int column = 0; column < grid.across.count(); ++column) {
        CellSum sum = Rows::nothing();
        for (int j = 2 * row; j < std::min(2 * row + 2, fine.down.count()); ++j)
          for (int i = 2 * column; i < std::min(2 * column + 2, fine.across.count()); ++i) {
            const float* m = levels_[level - 1].cell(face, j, i).m;
            for (std::size_t k = 0; k < least; ++k) sum[k] += double(m[k]);
            for (std::size_t k = least; k < numbers; ++k) sum[k] = std::min(sum[k], double(m[k]));
          }
        CellLight& out =
            levels_[level].light[place(grid.down.count(), grid.across.count(), face, row) + std::size_t(column)];
        std::ranges::transform(sum, out.m, [](double x) { return float(x); });
        out.m[numbers] = 0;
      }
}

// Prefix sums of a level: every other border of the level before, rows in pairs.
template <class Grid>
auto PrefixSumSource<Grid>::coarser(std::size_t level) const -> Prefixes {
  const auto &grid = levels_[level].grid, &fine = levels_[level - 1].grid;
  const Prefixes& from = prefixes_[level - 1 - base()];
  Prefixes made(prefix_place(level, Grid::faces, 0));
  for (int face = 0; face < Grid::faces; ++face)
    for (int row = 0; row < fine.down.count(); ++row)
      for (int border = 0; border <= grid.across.count(); ++border) {
        const auto column = std::size_t(std::min(2 * border, fine.across.count()));
        const double* p = &from[prefix_place(level - 1, face, row) + column * stride()];
        double* to = &made[prefix_place(level, face, row / 2) + std::size_t(border) * stride()];
        for (std::size_t k = 0; k < stride(); ++k) to[k] += p[k];
      }
  return made;
}

// Sums a row of the finest cells.
template <class Grid>
void PrefixSumSource<Grid>::add_row(int face, int row, std::span<const typename Grid::Row> texels, Rows& rows) {
  const auto& fine = levels_.front().grid;
  const int steps = levels_[base()].grid.across.side / fine.across.side;
  std::vector<Colour> light;
  for (int i = 0; i < fine.across.count(); ++i) {
    const auto from = std::size_t(fine.across.first(i)), count = std::size_t(fine.across.end(i)) - from;
    BlockMoments block;
    for (std::size_t j = 0; j < texels.size(); ++j) {
      const auto all = source_.row(face, fine.down.first(row) + int(j)).subspan(from, count);
      light.assign(all.begin(), all.end());
      for (Colour& texel : light) texel -= min_radiance_;
      texels[j].add(light, int(from), order_, block);
    }
    BlockMoments& sum = rows.base[std::size_t(i / steps)];
    for (std::size_t m = 0; m <= stride() / 3; ++m)
      for (std::size_t k = 0; k < 3; ++k) sum.moments[m][k] += block.moments[m][k];
    CellSum& cell = rows.sums.front()[std::size_t(i)];
    const bool polar = fine.shape(row, i).polar;
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t m = 0; m < 3; ++m) cell[3 * m + k] = unit_ * block.moments[m + 1][k];
      cell[flux + k] = unit_ * block.moments[0][k];
      cell[least + k] = polar ? 0 : unit_ * double(block.least[int(k)]);
    }
  }
  close_row(0, face, row, rows);
}

// Stores a row of cells and adds it to its row of the next level. The last of the rows of that row closes it in turn.
template <class Grid>
void PrefixSumSource<Grid>::close_row(std::size_t level, int face, int row, Rows& rows) {
  const auto& grid = levels_[level].grid;
  CellLight* out = &levels_[level].light[place(grid.down.count(), grid.across.count(), face, row)];
  std::vector<CellSum>& cells = rows.sums[level];
  const bool last = level == base();
  for (std::size_t i = 0; i < cells.size(); ++i) {
    std::ranges::transform(cells[i], out[i].m, [](double x) { return float(x); });
    out[i].m[numbers] = 0;
    if (last) continue;
    CellSum& to = rows.sums[level + 1][i / 2];
    for (std::size_t k = 0; k < least; ++k) to[k] += cells[i][k];
    for (std::size_t k = least; k < numbers; ++k) to[k] = std::min(to[k], cells[i][k]);
  }
  std::ranges::fill(cells, Rows::nothing());
  if (!last && (row % 2 == 1 || row + 1 == grid.down.count())) close_row(level + 1, face, row / 2, rows);
}

template <class Grid>
void PrefixSumSource<Grid>::add(std::size_t level, int face, int row, int first, int last, Sums& sums) const {
  const int count = levels_[level].grid.across.count();
  const double* start = &prefixes_[level - base()][prefix_place(level, face, row)];
  const auto border = [&](int k) { return start + std::size_t(k) * stride(); };
  const auto add = [&](const double* to, const double* from) {
    for (std::size_t k = 0, end = stride(); k < end; ++k) sums[k] += to[k] - from[k];
  };
  if (last - first >= count) return add(border(count), border(0));
  if (first >= count) first -= count, last -= count;
  add(border(std::min(last, count)), border(first));
  if (last > count) add(border(last - count), border(0));
}

template <class Grid>
void PrefixSumSource<Grid>::prefetch(std::size_t level, int face, int row, int first, int last) const {
  const int count = levels_[level].grid.across.count();
  const double* start = &prefixes_[level - base()][prefix_place(level, face, row)];
  for (const int border : {first, last}) {
    const double* at = start + std::size_t(border < count ? border : border - count) * stride();
    __builtin_prefetch(at), __builtin_prefetch(at + 8);
  }
}

template class PrefixSumSource<LatlongGrid>;
template class PrefixSumSource<CubeGrid>;

}  // namespace envmap::prefiltering

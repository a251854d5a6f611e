#include "envmap/prefilter/multilevel_source.h"

#include <algorithm>

#include "envmap/base/parallel.h"
#include "envmap/prefilter/light_planes.h"

namespace envmap::prefiltering {

namespace {

// A periodic row with room on both sides, so that shifted copies are spans of it.
class Wrapped {
 public:
  static constexpr int room = 2 * nodes_across;
  void set(std::span<const float> row, std::size_t step, std::size_t offset) {
    const std::size_t count = row.size() / step;
    padded_.resize(count + 2 * room);
    for (std::size_t k = 0; k < count; ++k) padded_[room + k] = row[k * step + offset];
    for (std::size_t k = 0; k < room; ++k) {
      padded_[room + count + k] = padded_[room + k % count];
      padded_[room - 1 - k] = padded_[room + count - 1 - k % count];
    }
  }
  [[nodiscard]] std::span<const float> from(int shift, std::size_t count) const {
    return std::span(padded_).subspan(std::size_t(room + shift), count);
  }

 private:
  std::vector<float> padded_;
};

// Of the adjoint of interpolation at -1/4 and +1/4 of a cell: fine 2 k - 1/4, 2 k + 1 + 1/4.
struct Halving {
  Weights low, high;  // Of a fine cell left and right of its coarse one, from nodes -6 and -5 on.
  Halving() { lagrange(-0.25, low), lagrange(0.25, high); }
};
const Halving& halving() {
  static const Halving h;
  return h;
}

// Half as many columns.
void halve(std::span<const float> in, std::span<float> out) {
  thread_local Wrapped even, odd;
  even.set(in, 2, 0), odd.set(in, 2, 1);
  std::ranges::fill(out, 0.F);
  for (int i = 0; i < nodes_across; ++i) {
    // Coarse k has the fine 2 (k - node) and 2 (k - node) + 1.
    add_scaled(even.from(half_nodes - i, out.size()), float(halving().low[std::size_t(i)]), out);
    add_scaled(odd.from(half_nodes - 1 - i, out.size()), float(halving().high[std::size_t(i)]), out);
  }
}

LightPlanes coarser(const LightPlanes& fine) {
  LightPlanes narrow(fine.rows, fine.columns / 2), out(fine.rows / 2, fine.columns / 2);
  parallel_for(fine.rows, [&](int r) {
    for (int c = 0; c < 3; ++c) halve(fine.row(r, c), narrow.row(r, c));
  });
  parallel_for(out.rows, [&](int k) {
    for (int i = 0; i < nodes_across; ++i)
      for (int side = 0; side < 2; ++side) {
        const int node = i - half_nodes + side;
        const int from = 2 * (k - node) + side, r = folded(from, fine.rows);
        const double w = side == 0 ? halving().low[std::size_t(i)] : halving().high[std::size_t(i)];
        for (int c = 0; c < 3; ++c) add_row(narrow.row(r, c), {r, r != from, float(w)}, out.row(k, c));
      }
  });
  return out;
}

// Rows near poles in fewer columns.
NodeGrid thinned(const LightPlanes& full) {
  NodeGrid grid(full.rows);
  parallel_for(full.rows, [&](int r) {
    std::vector<float> row, next;
    for (int c = 0; c < 3; ++c) {
      const auto all = full.row(r, c);
      row.assign(all.begin(), all.end());
      while (int(row.size()) > grid.columns[std::size_t(r)]) {
        next.resize(row.size() / 2);
        halve(row, next);
        std::swap(row, next);
      }
      std::ranges::copy(row, grid.channel(r, c));
    }
    grid.repeat_columns(r);
  });
  return grid;
}

}  // namespace

SourceGrids::SourceGrids(const Level& source, double unit, const Colour& darkest, int finest) {
  const bool latlong = source.projection() == Projection::latlong;
  LightPlanes planes =
      latlong ? latlong_planes(source, unit, darkest, finest) : cube_planes(source, unit, darkest, finest);
  grids_.push_back(thinned(planes));
  while (planes.rows > least_rows) {
    planes = coarser(planes);
    grids_.push_back(thinned(planes));
  }
}

}  // namespace envmap::prefiltering

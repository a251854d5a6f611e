#include "envmap/sample/coverage.h"

#include <algorithm>
#include <cmath>

namespace envmap {

void Coverage::cover(std::span<const Point2> points) {
  Point2 low = points[0], high = points[0];
  double area = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Point2 &a = points[k], &b = points[k + 1 < points.size() ? k + 1 : 0];
    low = glm::min(low, a), high = glm::max(high, a);
    area += (b.y - a.y) * (a.x + b.x - 2 * points[0].x);
  }
  sign_ = area > 0 ? -1 : 1;  // A side that goes down takes from what lies to its right.
  left_ = int(std::floor(low.x));
  const int top = int(std::floor(low.y));
  clear(int(std::floor(high.x)) - left_ + 1, int(std::floor(high.y)) - top + 1);
  const Point2 origin(left_, top);
  for (std::size_t k = 0; k < points.size(); ++k)
    add_side(points[k] - origin, points[k + 1 < points.size() ? k + 1 : 0] - origin);
  find_runs(top);
}

void Coverage::clear(int across, int down) {
  for (std::size_t j = 0; j < reach_.size(); ++j)
    for (int i = reach_[j].first; i <= reach_[j].last; ++i) cells_[j * std::size_t(across_) + std::size_t(i)] = {};
  across_ = across, down_ = down;
  reach_.assign(std::size_t(down), {across, -1});
  cells_.resize(std::max(cells_.size(), std::size_t(across) * std::size_t(down)));
}

// A row of texels lies between two of cells.
void Coverage::find_runs(int top) {
  runs_.clear();
  for (int j = 0; j <= down_; ++j) {
    const Reach above = j > 0 ? reach_[j - 1] : Reach{across_, -1}, below = j < down_ ? reach_[j] : Reach{across_, -1};
    const int first = std::min(above.first, below.first), last = std::max(above.last, below.last);
    runs_.push_back({top + j, left_ + first, last < first ? 0 : last - first + 2});
  }
}

// From row to row, always downwards.
void Coverage::add_side(const Point2& a, const Point2& b) {
  if (a.y == b.y) return;
  if (a.y > b.y) {
    sign_ = -sign_;
    add_side(b, a);
    sign_ = -sign_;
    return;
  }
  const double slope = (b.x - a.x) / (b.y - a.y);
  Point2 from = a;
  for (int row = int(a.y); from.y < b.y; ++row) {
    const Point2 to = row + 1 < b.y ? Point2(a.x + (row + 1 - a.y) * slope, row + 1) : b;
    from.x <= to.x ? add_in_row(row, from, to) : add_in_row(row, to, from);
    from = to;
  }
}

// From column to column, always to the right; y may go either way, and counts by how far.
void Coverage::add_in_row(int row, const Point2& a, const Point2& b) {
  const double slope = b.x > a.x ? (b.y - a.y) / (b.x - a.x) : 0;
  row = std::min(row, down_ - 1);
  Reach& reach = reach_[row];
  reach.first = std::min({reach.first, int(a.x), across_ - 1});
  Point2 from = a;
  for (int column = int(a.x);; ++column) {
    const bool last = !(column + 1 < b.x);
    const Point2 to = last ? b : Point2(column + 1, a.y + (column + 1 - a.x) * slope);
    add_piece(cells_[row * across_ + std::min(column, across_ - 1)], {from.x - column, from.y - row},
              {to.x - column, to.y - row});
    reach.last = std::max(reach.last, std::min(column, across_ - 1));
    if (last) return;
    from = to;
  }
}

// Moments of what lies to the right of a straight piece within its cell, the unit square: means of x^m y^n along the
// piece, times how far it goes down. With x = m + d t, y = n + e t and t from -1 to 1, odd powers of t vanish,
// t^2 is 1/3 in the mean and t^4 1/5.
void Coverage::add_piece(Cell& cell, const Point2& a, const Point2& b) {
  const double w = sign_ * std::abs(b.y - a.y), third = w * (1.0 / 3);
  const double m = 0.5 * (a.x + b.x), d = 0.5 * (b.x - a.x), n = 0.5 * (a.y + b.y), e = 0.5 * (b.y - a.y);
  const double mm = m * m, dd = d * d, de = d * e, nn = n * n, ee = e * e;
  const double y = w * n, yy = w * nn + third * ee;
  const double x = w * m, xx = w * mm + third * dd, xxx = w * (m * (mm + dd));
  const double xy = n * x + third * de, xxy = n * xx + third * (2 * m * de), xxxy = n * xxx + w * de * (mm + 0.2 * dd);
  const double xyy = m * yy + third * (2 * n * de),
               xxyy = mm * yy + third * (4 * m * n * de + dd * nn) + 0.2 * w * dd * ee;
  cell.one += w - x, cell.x += 0.5 * (w - xx), cell.xx += 1.0 / 3 * (w - xxx);
  cell.y += y - xy, cell.xy += 0.5 * (y - xxy), cell.xxy += 1.0 / 3 * (y - xxxy);
  cell.yy += yy - xyy, cell.xyy += 0.5 * (yy - xxyy);
  cell.beyond += w, cell.beyond_y += y, cell.beyond_yy += yy;
}

std::span<const double> Coverage::weights(std::span<const double> densities) {
  weights_.assign(densities.size(), 0);
  // Rounding must not make a weight negative: there may be a sun of 1e9 beside it.
  const auto add = [&](std::size_t k, double weight) { weights_[k] += std::max(0.0, weight); };
  std::size_t start = 0;  // Of the run above the cells.
  for (std::size_t j = 0; j < std::size_t(down_); ++j) {
    const Run &above = runs_[j], &under = runs_[j + 1];
    const std::size_t next = start + std::size_t(above.count);
    double one = 0, y = 0, yy = 0;  // What the sides to the left of the cell give it.
    for (int i = reach_[j].first; i <= reach_[j].last; ++i) {
      const std::size_t k = start + std::size_t(left_ + i - above.first);
      const std::size_t l = next + std::size_t(left_ + i - under.first);
      const Cell* cell = &cells_[j * std::size_t(across_) + std::size_t(i)];
      const Cell m{cell->one + one,  cell->x + one / 2, cell->xx + one / 3, cell->y + y,
                   cell->xy + y / 2, cell->xxy + y / 3, cell->yy + yy,      cell->xyy + yy / 2};
      one += cell->beyond, y += cell->beyond_y, yy += cell->beyond_yy;
      const double a = densities[k], b = densities[k + 1], c = densities[l], d = densities[l + 1];
      const double gx = 0.5 * (b - a + d - c), gy = 0.5 * (c - a + d - b), g = 0.25 * (a + b + c + d) - 0.5 * (gx + gy);
      add(k, g * (m.one - m.x - m.y + m.xy) + gx * (m.x - m.xx - m.xy + m.xxy) + gy * (m.y - m.xy - m.yy + m.xyy));
      add(k + 1, g * (m.x - m.xy) + gx * (m.xx - m.xxy) + gy * (m.xy - m.xyy));
      add(l, g * (m.y - m.xy) + gx * (m.xy - m.xxy) + gy * (m.yy - m.xyy));
      add(l + 1, g * m.xy + gx * m.xxy + gy * m.xyy);
    }
    start = next;
  }
  return weights_;
}

}  // namespace envmap

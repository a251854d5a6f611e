// The cells and Gauss points of texels as an output's direction sees them, for latlong maps and cube faces: t over each
// as a plane. Included once a target.
#include <vector>

#include "envmap/maths/portable.h"
#include "envmap/maths/quadrature.h"
#include "envmap/prefilter/multilevel/level_kernel-inl.h"
#include "envmap/prefilter/sheen/sheen.h"
#include "envmap/prefilter/sheen/sheen_cell-inl.h"

#if defined(ENVMAP_PREFILTER_SHEEN_PLACES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ENVMAP_PREFILTER_SHEEN_PLACES_INL_H_
#undef ENVMAP_PREFILTER_SHEEN_PLACES_INL_H_
#else
#define ENVMAP_PREFILTER_SHEEN_PLACES_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {

using ScalarTag = hn::CappedTag<double, 1>;
using ScalarCell = Cell<hn::Vec<ScalarTag>>;

template <class V>
struct Point {
  V cosine, weight;
};

// Gauss's rule from 0 to 1.
struct SideRule {
  std::vector<double> at, weight;
  explicit SideRule(int count) { set<1>(count); }

 private:
  template <int n>
  void set(int count) {
    if constexpr (n <= 12) {
      if (n != count) return set<n + 1>(count);
      for (std::size_t k = 0; k < std::size_t(n); ++k) {
        at.push_back(0.5 + 0.5 * quadrature::rule<n>().node[k]);
        weight.push_back(0.5 * quadrature::rule<n>().weight[k]);
      }
    }
  }
};

// A row of cells of a latlong map: dOmega = d(height) d(longitude).
struct LatlongRow {
  double height, sine;         // Means.
  double middle, half, level;  // Heights from middle - half to middle + half; the sine of the polar angle at middle.
  double inward;               // Half the extent of that sine, by its variance.
  double bend, size;           // The difference of t from a plane; the height of the row as an angle.
  // Near a pole cells are no rectangles.
  [[nodiscard]] bool is_polar() const { return bend > 0.03 * size; }
  // @param top,bottom over pi. @param wide of a cell, in longitude.
  LatlongRow(double top, double bottom, double wide) {
    const double at = 0.5 * (top + bottom), high = bottom - top;
    size = pi * high;
    half = portable::sin_pi(at) * portable::sin_pi(0.5 * high);
    middle = portable::cos_pi(at) * portable::cos_pi(0.5 * high);
    level = std::sqrt((1 - middle) * (1 + middle));
    height = middle;
    sine = (0.5 * size - 0.5 * portable::cos_pi(2 * at) * portable::sin_pi(high)) / (2 * half);
    inward = half * middle / level;
    if (size > 0.02 * level)
      inward = std::copysign(std::sqrt(3 * std::max(0.0, level * level - half * half / 3 - sine * sine)), middle);
    bend = 0.2 * size * size / level + 0.125 * level * wide * wide + 0.25 * size * wide;
  }
};

struct OnLatlongCells {
  // Columns of cells over a texel: 1 - mean cosine and mean sine of their longitudes from the middle of a block, and
  // the cosine and sine of their middles.
  struct Columns {
    int count;
    double wide;
    std::vector<float> versine, sine, cosine, at_sine;  // Ordered by cell, then texel.
  };
  // Columns of Gauss points over a texel, with their weights.
  struct PointsAcross {
    int count;
    std::vector<float> versine, sine, weight;
  };
  struct PointRow {
    double cosine, sine, weight;  // Of a polar angle.
  };

  OnLatlongCells(const SheenBlocks& blocks, const SheenPlan& plan)
      : width(blocks.width()),
        height(blocks.height()),
        side(blocks.layers().front().side),
        many(plan.cells),
        gauss(plan.points) {
    const int cells = plan.cells;
    for (int count = 1; count <= cells; ++count) columns.push_back(columns_of(count));
    for (int count = 1; count <= most_points; ++count) points_across.push_back(points_of(count));
    const SideRule usual(gauss), finer(std::min(gauss + 2, most_points));
    for (int row = 0; row < blocks.layers().front().down * side; ++row) {
      wholes.emplace_back(double(row) / height, (row + 1.0) / height, 2 * pi / width);
      const double steep = plan.power * 2 * pi / width * wholes.back().level;
      points_of_row.push_back(points_for(steep, plan.points_error) - 1);
      first_point.push_back(point_rows.size());
      const SideRule& rule = wholes.back().is_polar() ? finer : usual;  // Near a pole texels are denser to one side.
      for (std::size_t r = 0; r < rule.at.size(); ++r) {
        const double at = (row + rule.at[r]) / height, sine = portable::sin_pi(at);
        point_rows.push_back({portable::cos_pi(at), sine, rule.weight[r] * sine * pi / height});
      }
      const double level = portable::sin_pi((row + 0.5) / height);
      across.push_back(std::clamp(int(std::ceil(level * cells)), 1, cells));
      for (int r = 0; r < cells; ++r)
        rows.emplace_back((row + double(r) / cells) / height, (row + (r + 1.0) / cells) / height,
                          columns[std::size_t(across.back() - 1)].wide);
    }
    first_point.push_back(point_rows.size());
  }

  // A part of a texel in double.
  struct Part {
    double left, right, top, bottom;  // Longitudes from the middle of a block, polar angles over pi.
    [[nodiscard]] ScalarCell cell(const Direction& n) const {
      const ScalarTag d;
      const LatlongRow row(top, bottom, right - left);
      const double at = 0.5 * (left + right), half = 0.5 * (right - left), shrink = portable::sin_pi(half / pi) / half;
      const double c = portable::cos_pi(at / pi), s = portable::sin_pi(at / pi), ahead = n.x * c + n.y * s;
      return {broadcast(d, row.height * n.z + row.sine * shrink * ahead),
              broadcast(d, row.sine * (n.y * c - n.x * s) * half),
              broadcast(d, row.half * n.z - row.inward * ahead),
              hn::Zero(d),
              hn::Zero(d),
              broadcast(d, 4 * row.half * half)};
    }
    [[nodiscard]] double bend() const { return LatlongRow(top, bottom, right - left).bend; }
    [[nodiscard]] bool is_polar() const { return LatlongRow(top, bottom, right - left).is_polar(); }
    [[nodiscard]] Part quarter(int k) const {
      const double x = 0.5 * (left + right), y = 0.5 * (top + bottom);
      return {k % 2 == 0 ? left : x, k % 2 == 0 ? x : right, k < 2 ? top : y, k < 2 ? y : bottom};
    }
  };

  // Eight texels of a row of a block.
  struct Texels {
    const OnLatlongCells& place;
    const Direction& n;
    int row, first;
    const Columns& columns;
    const PointsAcross& points;
    [[nodiscard]] int across() const { return columns.count; }
    [[nodiscard]] int down() const { return place.many; }
    [[nodiscard]] const LatlongRow& at(int r) const { return place.rows[std::size_t(row * place.many + r)]; }
    [[nodiscard]] double bend(int r) const { return at(r).bend; }
    [[nodiscard]] double bend() const { return place.wholes[std::size_t(row)].bend; }
    [[nodiscard]] bool is_polar() const { return place.wholes[std::size_t(row)].is_polar(); }
    [[nodiscard]] HWY_INLINE Cell<V> cell(int r, int q, std::size_t lane) const {
      return cell_of(at(r), columns, std::size_t(q * place.side + first) + lane);
    }
    [[nodiscard]] HWY_INLINE Cell<V> texel(std::size_t lane) const {
      return cell_of(place.wholes[std::size_t(row)], place.columns.front(), std::size_t(first) + lane);
    }
    [[nodiscard]] int points_across() const { return points.count; }
    [[nodiscard]] int points_down() const {
      return int(place.first_point[std::size_t(row) + 1] - place.first_point[std::size_t(row)]);
    }
    [[nodiscard]] HWY_INLINE Point<V> point(int r, int q, std::size_t lane) const {
      const D d;
      const PointRow& own = place.point_rows[place.first_point[std::size_t(row)] + std::size_t(r)];
      const std::size_t k = std::size_t(q * place.side + first) + lane;
      const V turn =
          broadcast(d, n.y) * hn::LoadU(d, &points.sine[k]) - broadcast(d, n.x) * hn::LoadU(d, &points.versine[k]);
      return {broadcast(d, own.cosine * n.z + own.sine * n.x) + broadcast(d, own.sine) * turn,
              broadcast(d, float(own.weight) * points.weight[std::size_t(q)])};
    }
    [[nodiscard]] HWY_INLINE Cell<V> cell_of(const LatlongRow& own, const Columns& from, std::size_t k) const {
      const D d;
      const V x = broadcast(d, n.x), y = broadcast(d, n.y), sine = broadcast(d, own.sine);
      const V turn = y * hn::LoadU(d, &from.sine[k]) - x * hn::LoadU(d, &from.versine[k]);
      const V c = hn::LoadU(d, &from.cosine[k]), s = hn::LoadU(d, &from.at_sine[k]);
      const V ahead = x * c + y * s, aside = y * c - x * s;
      const double middle = own.height * n.z + own.sine * n.x;
      return {broadcast(d, middle) + sine * turn,
              sine * aside * broadcast(d, 0.5 * from.wide),
              broadcast(d, own.half * n.z) - broadcast(d, own.inward) * ahead,
              hn::Zero(d),
              hn::Zero(d),
              broadcast(d, 2 * own.half * from.wide)};
    }
    [[nodiscard]] Part whole(int lane) const {
      const double left = (first + lane - 0.5 * place.side) * 2 * pi / place.width;
      return {left, left + 2 * pi / place.width, double(row) / place.height, (row + 1.0) / place.height};
    }
  };
  [[nodiscard]] Texels texels(const Direction& n, int row, int /*column*/, int j, int i) const {
    const int at = row * side + j;
    return {*this,
            n,
            at,
            i,
            columns[std::size_t(across[std::size_t(at)] - 1)],
            points_across[std::size_t(points_of_row[std::size_t(at)])]};
  }

  int width, height, side, many, gauss;
  std::vector<PointsAcross> points_across;  // Indexed by count - 1.
  std::vector<int> points_of_row;
  std::vector<std::size_t> first_point;  // Index for each row of texels, and the end.
  std::vector<PointRow> point_rows;
  std::vector<LatlongRow> wholes;  // Texels.
  std::vector<Columns> columns;    // Indexed by count - 1.
  std::vector<int> across;         // Cells of a texel across, for each row of texels.
  std::vector<LatlongRow> rows;

 private:
  [[nodiscard]] PointsAcross points_of(int count) const {
    PointsAcross made{count, {}, {}, {}};
    const SideRule rule(count);
    for (std::size_t q = 0; q < rule.at.size(); ++q) {
      made.weight.push_back(float(rule.weight[q] * 2 * pi / width));
      for (int i = 0; i < side; ++i) {
        const double at = 2 * (i + rule.at[q] - 0.5 * side) / width, half = portable::sin_pi(0.5 * at);
        made.versine.push_back(float(2 * half * half)), made.sine.push_back(float(portable::sin_pi(at)));
      }
    }
    return made;
  }
  [[nodiscard]] Columns columns_of(int count) const {
    Columns made{count, 2 * pi / width / count, {}, {}, {}, {}};
    const double half = 0.5 * made.wide, shrink = portable::sin_pi(half / pi) / half;
    for (int q = 0; q < count; ++q)
      for (int i = 0; i < side; ++i) {
        const double at = 2 * (i + (q + 0.5) / count - 0.5 * side) / width, c = portable::cos_pi(at),
                     s = portable::sin_pi(at);
        made.versine.push_back(float(1 - shrink * c)), made.sine.push_back(float(shrink * s));
        made.cosine.push_back(float(c)), made.at_sine.push_back(float(s));
      }
    return made;
  }
};

struct OnCubeCells {
  OnCubeCells(const SheenBlocks& blocks, const SheenPlan& plan)
      : size(blocks.height()), side(blocks.layers().front().side), many(plan.cells), rule(plan.points) {}

  // A cell about a place of a face, `half` to each side. @param level what is above the plane of the horizon there, as
  // n times a place of distance 1.
  template <class T, class Vector>
  static HWY_INLINE Cell<Vector> cell_at(T d, const Direction& n, Vector x, Vector y, Vector level, double half) {
    const Vector one = broadcast(d, 1), h = broadcast(d, half), nx = broadcast(d, n.x), ny = broadcast(d, n.y);
    const Vector square = one / (one + (x * x + y * y)), q = hn::Sqrt(square);
    const Vector cube = q * square, fall = level * cube;
    const Vector right = nx * q - x * fall, up = ny * q - y * fall;
    // The Laplacian of t: level times that of q, and twice the product of both slopes.
    const Vector bent = fall * (one - broadcast(d, 3) * square) - broadcast(d, 2) * cube * (nx * x + ny * y);
    const Vector dense = one + broadcast(d, 0.5 * half * half) * square * (broadcast(d, 3) - broadcast(d, 5) * square);
    const Vector falloff = broadcast(d, -3) * square * h;
    return {level * q + broadcast(d, half * half / 6) * bent, right * h, up * h, falloff * x, falloff * y,
            broadcast(d, 4 * half * half) * cube * dense};
  }

  struct Part {
    double x, y, half;
    [[nodiscard]] ScalarCell cell(const Direction& n) const {
      const ScalarTag d;
      return cell_at(d, n, broadcast(d, x), broadcast(d, y), broadcast(d, n.x * x + n.y * y + n.z), half);
    }
    [[nodiscard]] double bend() const { return half * half; }
    [[nodiscard]] bool is_polar() const { return false; }
    [[nodiscard]] Part quarter(int k) const {
      const double q = 0.5 * half;
      return {x + (k % 2 == 0 ? -q : q), y + (k < 2 ? -q : q), q};
    }
  };

  struct Texels {
    const OnCubeCells& place;
    const Direction& n;
    int row, block, first;  // Row of texels; column of the block's first texel; texel in the block.
    [[nodiscard]] int across() const { return place.many; }
    [[nodiscard]] int down() const { return place.many; }
    [[nodiscard]] double half(int count) const { return 1.0 / place.size / count; }
    [[nodiscard]] double bend(int /*r*/) const { return half(place.many) * half(place.many); }
    [[nodiscard]] double bend() const { return half(1) * half(1); }
    [[nodiscard]] bool is_polar() const { return false; }
    [[nodiscard]] HWY_INLINE Cell<V> cell(int r, int q, std::size_t lane) const {
      const Place at = place_at((q + 0.5) / place.many, (r + 0.5) / place.many, lane);
      return cell_at(D(), n, at.x, at.y, at.level, half(place.many));
    }
    [[nodiscard]] HWY_INLINE Cell<V> texel(std::size_t lane) const {
      const Place at = place_at(0.5, 0.5, lane);
      return cell_at(D(), n, at.x, at.y, at.level, half(1));
    }
    [[nodiscard]] int points_across() const { return int(place.rule.at.size()); }
    [[nodiscard]] int points_down() const { return points_across(); }
    [[nodiscard]] HWY_INLINE Point<V> point(int r, int q, std::size_t lane) const {
      const D d;
      const Place at = place_at(place.rule.at[std::size_t(q)], place.rule.at[std::size_t(r)], lane);
      const V square = broadcast(d, 1) / (broadcast(d, 1) + (at.x * at.x + at.y * at.y));
      const V root = hn::Sqrt(square);
      const double weight =
          place.rule.weight[std::size_t(q)] * place.rule.weight[std::size_t(r)] * 4 * half(1) * half(1);
      return {at.level * root, broadcast(d, weight) * (square * root)};
    }
    struct Place {
      V x, y, level;
    };
    // @param across,down of a texel, from 0 to 1.
    [[nodiscard]] HWY_INLINE Place place_at(double across, double down, std::size_t lane) const {
      const D d;
      const double y = 1 - (row + down) * 2 / place.size, x = 2.0 * (block + 0.5 * place.side) / place.size - 1;
      const double from = (first + across - 0.5 * place.side) * 2 / place.size;
      const V offset = broadcast(d, from) + broadcast(d, 2.0 / place.size) * hn::Iota(d, float(lane));
      return {broadcast(d, x) + offset, broadcast(d, y),
              broadcast(d, n.x * x + n.y * y + n.z) + broadcast(d, n.x) * offset};
    }
    [[nodiscard]] Part whole(int lane) const {
      return {2 * (block + first + lane + 0.5) / place.size - 1, 1 - 2 * (row + 0.5) / place.size, 1.0 / place.size};
    }
  };
  [[nodiscard]] Texels texels(const Direction& n, int row, int column, int j, int i) const {
    return {*this, n, row * side + j, column * side, i};
  }

  int size, side, many;
  SideRule rule;
};

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();
#endif

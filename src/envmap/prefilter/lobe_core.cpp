// Cores of lobes, compiled once for every instruction set and chosen at run time.
#include "envmap/prefilter/lobe_core.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "envmap/projection/cube.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/prefilter/lobe_core.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "envmap/prefilter/core_places-inl.h"

#ifndef ENVMAP_PREFILTER_LOBE_CORE_ONCE
#define ENVMAP_PREFILTER_LOBE_CORE_ONCE
namespace envmap::prefiltering {
namespace {

// Texels of one row of the source, as an output sees them.
struct RowOfTexels {
  std::span<const Colour> row;
  int first, count;    // Column of the first, which may lie beyond the row: rows of latlong maps wrap.
  Piece texel;         // The first.
  const Rule& rule;    // For each side of a texel.
  const float* x;      // Coordinates across of the first point of each texel: see the places below.
  std::size_t stride;  // To those of the next point.
};

// The light of a source is counted from the darkest, in a unit that keeps its sums within floats.
struct Light {
  const Level& source;
  const Colour& darkest;
  double scale;  // 1 / unit.
};

// Eight texels from k on as planes; 0 after the last.
struct EightTexels {
  alignas(64) float light[3][8];
  EightTexels(const RowOfTexels& texels, int k, const Light& of) {
    const int columns = int(texels.row.size()), count = std::min(8, texels.count - k);
    int at = (texels.first + k + 2 * columns) % columns;
    for (int i = 0; i < 8; ++i) {
      for (int c = 0; c < 3; ++c)
        light[c][i] = i < count ? float(double(texels.row[std::size_t(at)][c] - of.darkest[c]) * of.scale) : 0;
      at = at + 1 < columns ? at + 1 : 0;
    }
  }
};

}  // namespace
}  // namespace envmap::prefiltering
#endif

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {

// Whether sixteen points do: pieces small beside their distance from where the kernel has its pole, or is steep.
template <class K>
bool is_even(const K& kernel, double size, double nearest) {
  if (kernel.k.kind == LevelKernel::Kind::ggx)
    return size * size <= double(kernel.k.uneven) * (nearest * nearest + 2 * double(kernel.k.a));
  return size * (nearest + size) * double(kernel.k.power * kernel.k.part) <= double(kernel.k.uneven);
}

// Whether the rule's points do in each of some texels.
// @param panel of a side. @param x of the middles of the texels.
template <class K>
HWY_INLINE auto rule_does(const K& kernel, double size, double panel, V x) {
  const D d;
  const V square = hn::Add(x, x);
  if (kernel.k.kind == LevelKernel::Kind::ggx)
    return hn::Le(hn::Set(d, float(size * size)),
                  hn::Mul(hn::Set(d, 0.6F * kernel.k.uneven), hn::Add(square, hn::Set(d, 2 * kernel.k.a))));
  const float steep = float(panel) * kernel.k.power * kernel.k.part;
  return hn::Le(hn::Mul(hn::Set(d, steep * steep), hn::Add(square, hn::Set(d, float(size * size)))),
                hn::Set(d, kernel.k.uneven * kernel.k.uneven));
}

template <class Place, class K>
double over(const Place& place, const K& kernel, const Piece& p, int depth) {
  const Seen s = place.seen(p);
  V nearest = s.x[0];
  for (std::size_t k = 1; k < vectors; ++k) nearest = hn::Min(nearest, s.x[k]);
  // No place is farther from a point than half the largest gap each way.
  const double near = std::sqrt(2 * double(-largest(hn::Neg(nearest)))) - 0.25 * s.size, end = double(kernel.k.end);
  if (near > 0 && near * near > 2 * end) return 0;
  if (depth < 40 && !(s.size < 0.3 && is_even(kernel, s.size, std::max(0.0, near)))) {
    const double x = 0.5 * (p.x0 + p.x1), y = 0.5 * (p.y0 + p.y1);
    const auto part = [&](double x0, double x1, double y0, double y1) {
      return over(place, kernel, {x0, x1, y0, y1}, depth + 1);
    };
    return (part(p.x0, x, p.y0, y) + part(x, p.x1, p.y0, y)) + (part(p.x0, x, y, p.y1) + part(x, p.x1, y, p.y1));
  }
  V sum[parts];
  for (std::size_t k = 0; k < parts; ++k) {
    const V inside = hn::Mul(kernel(s.x[k]), s.weight[k]);
    sum[k] = hn::Add(inside, hn::Mul(kernel(s.x[k + parts]), s.weight[k + parts]));
  }
  return 0.25 * (p.x1 - p.x0) * (p.y1 - p.y0) * sum_of(sum);
}

// The sum of weight x kernel over the rule's points of some texels. @param x their coordinates across.
template <class Place, class K>
HWY_INLINE V by_rule(const Place& place, const K& kernel, const typename Place::Row& row, const RowOfTexels& texels,
                     const float* x) {
  const D d;
  V sum = hn::Zero(d);
  for (std::size_t e = 0; e < texels.rule.count; ++e) {
    const V across = hn::LoadU(d, x + e * texels.stride);
    V column = hn::Zero(d);
    for (std::size_t g = 0; g < texels.rule.count; ++g)
      column = hn::Add(column, hn::Mul(place.weight(row, g, across), kernel(place.versine(row, g, across))));
    sum = hn::Add(sum, hn::Mul(hn::Set(d, float(texels.rule.weight[e])), column));
  }
  return sum;
}

// By the rule where that does, else by pieces.
template <class Place, class K>
Flux over_row(const Place& place, const K& kernel, const RowOfTexels& texels, const Light& of) {
  const D d;
  const Piece& first = texels.texel;
  const double wide = first.x1 - first.x0, high = first.y1 - first.y0;
  const typename Place::Row row = place.row(first, texels.rule);
  const double panel = 4 * row.size / double(texels.rule.count);
  V total[3][parts];
  for (auto& channel : total)
    for (V& v : channel) v = hn::Zero(d);
  Flux pieces(0);
  for (int k = 0; k < texels.count; k += int(virtual_lanes)) {
    const EightTexels eight(texels, k, of);
    for (std::size_t part = 0; part < parts; ++part) {
      const std::size_t at = std::size_t(k) + part * lanes, middle = texels.rule.count / 2;
      const float* x = texels.x + at;
      const V of_middles = place.versine(row, middle, hn::LoadU(d, x + middle * texels.stride));
      const auto even = rule_does(kernel, row.size, panel, of_middles);
      const V sum = hn::IfThenElseZero(even, by_rule(place, kernel, row, texels, x));
      for (std::size_t c = 0; c < 3; ++c)
        total[c][part] = hn::Add(total[c][part], hn::Mul(sum, hn::Load(d, eight.light[c] + part * lanes)));
      if (hn::AllTrue(d, even)) continue;
      std::uint8_t bits[8] = {};
      hn::StoreMaskBits(d, even, bits);
      for (std::size_t i = 0; i < lanes && at + i < std::size_t(texels.count); ++i) {
        const std::size_t n = part * lanes + i;
        const Flux light(eight.light[0][n], eight.light[1][n], eight.light[2][n]);
        if ((bits[0] >> i & 1) != 0 || light == Flux(0)) continue;
        const double left = first.x0 + double(at + i) * wide;
        pieces += over(place, kernel, {left, left + wide, first.y0, first.y1}, 0) * light;
      }
    }
  }
  return pieces + wide * high * Flux(sum_of(total[0]), sum_of(total[1]), sum_of(total[2]));
}

template <class Place>
Flux OverRow(const Place& place, const LevelKernel& k, const RowOfTexels& texels, const Light& of) {
  const auto with = [&](const auto& kernel) { return over_row(place, kernel, texels, of); };
  if (k.kind == LevelKernel::Kind::power) return k.cosine ? with(OfPower<true>{k}) : with(OfPower<false>{k});
  return k.quartic ? with(OfGgx<false, true, true>{k}) : with(OfGgx<false, true, false>{k});
}

// How many panels of a side do for a lobe, where it is steepest.
Rule rule_for(const LevelKernel& k, double side) {
  if (k.kind == LevelKernel::Kind::ggx) return Rule(1);
  const double steep = side * double(k.power * k.part) * (std::sqrt(2 * double(k.end)) + side);
  const double panels = steep / double(k.uneven);
  return Rule(panels <= 1 ? 1 : panels <= 2 ? 2 : 4);
}

// Coordinates of points of texels, those of a point one after another.
class PointsAcross {
 public:
  PointsAcross(const Rule& rule, int texels) : stride_(std::size_t(texels) + 2 * virtual_lanes), x_(room()) {
    if (x_.size() < rule.count * stride_) x_.resize(rule.count * stride_);
  }
  [[nodiscard]] std::size_t stride() const { return stride_; }
  [[nodiscard]] float* of(std::size_t point) const { return &x_[point * stride_]; }

 private:
  static std::vector<float>& room() {
    thread_local std::vector<float> kept;
    return kept;
  }
  std::size_t stride_;
  std::vector<float>& x_;
};

// Columns of a row of a latlong map.
struct Window {
  int row, first, last;
};

// What is within x = end of a direction. @param at its column.
std::vector<Window> windows(const Level& source, double end, const GridView& view, double at) {
  const double reach = 2 * portable::asin(std::sqrt(0.5 * end)), step = pi / source.height();
  const int columns = source.width(), low = std::max(0, int((view.angle - reach) / step)),
            high = std::min(source.height() - 1, int((view.angle + reach) / step));
  std::vector<Window> all;
  for (int row = low; row <= high; ++row) {
    const double sine =
        std::min(portable::sin_pi(double(row) / source.height()), portable::sin_pi((row + 1.0) / source.height()));
    const double away = std::max({0.0, row * step - view.angle, view.angle - (row + 1) * step});
    const double c = 2 * portable::sin_pi(0.5 * away / pi) * portable::sin_pi(0.5 * away / pi);
    const double versine = (end - c) / std::max(1e-30, sine * view.sine);
    if (versine <= 0) continue;
    const double half = versine >= 2 ? columns : half_width(versine, columns);
    int first = int(std::floor(at - half)), last = int(std::floor(at + half));
    if (last - first + 1 > columns) first = int(std::floor(at)) - columns / 2, last = first + columns - 1;
    all.push_back({row, first, last});
  }
  return all;
}

Flux OfLatlong(const Light& light, const LevelKernel& k, const GridView& view) {
  const Level& source = light.source;
  const OnLatlong place(view);
  const int columns = source.width();
  const double at = view.longitude * columns / (2 * pi), wide = 2 * pi / columns, step = pi / source.height();
  const std::vector<Window> rows = windows(source, double(k.end), view, at);
  if (rows.empty()) return Flux(0);
  int low = rows[0].first, high = rows[0].last;
  for (const Window& w : rows) low = std::min(low, w.first), high = std::max(high, w.last);
  const Rule rule = rule_for(k, step);
  const PointsAcross across(rule, high - low + 1);
  for (std::size_t e = 0; e < rule.count; ++e)
    versines(at - rule.at[e], columns, low, high + int(virtual_lanes), across.of(e));
  Flux sum(0);
  for (const Window& w : rows) {
    const double x = (w.first - at) * wide, y = w.row * step - view.angle;
    sum += OverRow(place, k,
                   {source.row(0, w.row),
                    w.first,
                    w.last - w.first + 1,
                    {x, x + wide, y, y + step},
                    rule,
                    across.of(0) + (w.first - low),
                    across.stride()},
                   light);
  }
  return sum;
}

// Which of a face's rows or columns reach to within `reach` of a direction, whose part in front is `ahead`, whose part
// to the side `aside`.
struct Cells {
  int first, last;
};
Cells cells_of(double ahead, double aside, double reach, int size) {
  const double angle = portable::atan2(aside, ahead);
  const double wide =
      portable::asin(std::min(1.0, portable::sin_pi(reach / pi) / portable::hypot(ahead, aside))) + 1e-9;
  const auto cell = [&](double a) {
    const double turn = std::clamp(a / pi, -0.25, 0.25);
    return int(std::floor(0.5 * size * (1 + portable::sin_pi(turn) / portable::cos_pi(turn))));
  };
  return {std::max(0, cell(angle - wide)), std::min(size - 1, cell(angle + wide))};
}

Flux OfCube(const Light& light, const LevelKernel& k, const Direction& n) {
  const Level& source = light.source;
  const double reach = 2 * portable::asin(std::sqrt(0.5 * double(k.end)));
  const int size = source.height();
  const double wide = 2.0 / size;
  const Rule rule = rule_for(k, wide);
  Flux sum(0);
  for (int face = 0; face < 6; ++face) {
    const Cube::Axes& a = Cube::axes[std::size_t(face)];
    const double ahead = glm::dot(n, a.forward), right = glm::dot(n, a.right), up = glm::dot(n, a.up);
    if (ahead < 0.3) continue;  // Beyond a corner by more than widest_core.
    const Cells across = cells_of(ahead, right, reach, size), down = cells_of(ahead, -up, reach, size);
    const double s = right / ahead, t = -up / ahead;
    const int count = across.last - across.first + 1;
    if (count <= 0) continue;
    const OnCube place{float(s), float(t), float(std::sqrt(1 + s * s + t * t))};
    const double left = across.first * wide - 1 - s;
    const PointsAcross places(rule, count);
    for (std::size_t e = 0; e < rule.count; ++e)
      for (int i = 0; i < count + int(virtual_lanes); ++i) places.of(e)[i] = float(left + (i + rule.at[e]) * wide);
    for (int row = down.first; row <= down.last; ++row) {
      const double y = row * wide - 1 - t;
      sum += OverRow(place, k,
                     {source.row(face, row),
                      across.first,
                      count,
                      {left, left + wide, y, y + wide},
                      rule,
                      places.of(0),
                      places.stride()},
                     light);
    }
  }
  return sum;
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace envmap::prefiltering {
HWY_EXPORT(OfLatlong);
HWY_EXPORT(OfCube);

Flux core_sum(const Level& source, const Colour& darkest, double unit, const LevelKernel& kernel,
              const Direction& direction) {
  const Light light{source, darkest, 1 / unit};
  if (source.projection() == Projection::cube)
    return kernel.scale * HWY_DYNAMIC_DISPATCH(OfCube)(light, kernel, direction);
  return kernel.scale * HWY_DYNAMIC_DISPATCH(OfLatlong)(light, kernel, GridView(direction));
}

}  // namespace envmap::prefiltering
#endif  // HWY_ONCE

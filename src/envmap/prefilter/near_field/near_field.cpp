// The near field of narrow lobes over the texels of a source: rows of a latlong map, then faces of a cube. Compiled
// once for every instruction set and chosen at run time.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "envmap/base/without_avx512.h"
#include "envmap/prefilter/multilevel/multilevel_kernels.h"
#include "envmap/projection/cube.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/prefilter/near_field/near_field.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "envmap/prefilter/near_field/narrow_power-inl.h"
#include "envmap/prefilter/near_field/power_on_face-inl.h"
#include "envmap/prefilter/near_field/texel_rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {

// A row of a latlong map as an output sees it.
struct RowOfLatlong {
  OnLatlong place;
  RowOfTexels texels;

  // The longitude of its farther end from the output.
  [[nodiscard]] double farthest() const {
    const Piece& p = texels.texel;
    return std::max(-p.x0, p.x0 + texels.count * (p.x1 - p.x0));
  }
  // Longitudes are small angles, and the sine of the polar angle changes little over the height of the row.
  [[nodiscard]] bool is_far_from_poles() const {
    const Piece& p = texels.texel;
    return farthest() < 0.4 && place.least_sine > 64 * (p.y1 - p.y0);
  }
};

// Prefetches a row: rows lie far apart in memory.
HWY_INLINE void prefetch(const RowOfTexels& texels) {
  constexpr int in_cache_line = 5;
  const int columns = int(texels.row.size());
  for (int k = texels.first; k < texels.first + texels.count; k += in_cache_line)
    hwy::Prefetch(&texels.row[std::size_t(column_of(k, columns))]);
}

// The texels within x = end of a direction, by rows. @param at the direction's column.
std::vector<RowOfLatlong> rows_within(const Level& source, double end, const GridView& view, double at) {
  const double reach = 2 * portable::asin(std::sqrt(0.5 * end)), step = pi / source.height();
  const int columns = source.width(), low = std::max(0, int((view.angle - reach) / step)),
            high = std::min(source.height() - 1, int((view.angle + reach) / step));
  const double wide = 2 * pi / columns;
  const OnLatlong place(view);
  std::vector<RowOfLatlong> all;
  all.reserve(std::size_t(std::max(0, high - low + 1)));
  OnLatlong::Side above = place.side(low * step - view.angle);
  for (int row = low; row <= high; ++row) {
    const double y = row * step - view.angle;
    const OnLatlong::Side top = above, below = place.side((row + 1) * step - view.angle);
    const double sine = std::min(top.sine, below.sine);
    const double c = top.angle.sine > 0 ? top.angle.versine : below.angle.sine < 0 ? below.angle.versine : 0;
    above = below;
    const double versine = (end - c) / std::max(1e-30, sine * view.sine);
    if (versine <= 0) continue;
    const double half = versine >= 2 ? columns : half_width(versine, columns);
    int first = int(std::floor(at - half)), last = int(std::floor(at + half));
    if (last - first + 1 > columns) first = int(std::floor(at)) - columns / 2, last = first + columns - 1;
    const double x = (first - at) * wide;
    all.push_back({place.of_row(top, sine), {source.row(0, row), first, last - first + 1, {x, x + wide, y, y + step}}});
    prefetch(all.back().texels);
  }
  return all;
}

// The columns [low, high) that the rows have together, as longitudes from an output.
struct Columns {
  double at;  // Column of the output.
  int columns, low, high;

  // Sets v = 1 - cos of their longitudes, at a part of a column from its left.
  void set(double part, float* v) const { versines(at - part, columns, low, high, v); }
};

using RowsOfLatlong = std::span<const RowOfLatlong>;

Flux over_rows(const LevelKernel& k, RowsOfLatlong rows, const Columns& columns, const Light& of) {
  const Piece& first = rows[0].texels.texel;
  const Rules rules = rules_for(k, first.y1 - first.y0, columns.low, columns.high - columns.low);
  for (const RuleAcross& r : rules.used())
    for (std::size_t e = 0; e < r.rule->count; ++e) columns.set(r.rule->at[e], r.x + e * r.stride);
  Flux sum(0);
  for (const RowOfLatlong& r : rows) sum += OverRow(r.place, k, rules, r.texels, of);
  return sum;
}

// v = 1 - cos(longitude) in the middles of the panels of columns.
struct Middles {
  std::size_t panels, stride;  // Panels of a column. All first panels come first, then all second ones.
  std::vector<float> v;

  Middles(const Columns& columns, std::size_t of_panels)
      : panels(of_panels), stride(std::size_t(columns.high - columns.low) + virtual_lanes), v(panels * stride) {
    for (std::size_t n = 0; n < panels; ++n) columns.set((double(n) + 0.5) / double(panels), &v[n * stride]);
  }
};

Flux over_power_row(const PowerPolynomial& power, const RowOfTexels& texels, int low, const Middles& middles,
                    const Light& of) {
  const D d;
  Sums total;
  count(Work::near_field_points, std::size_t(texels.count) * middles.panels);
  for (int k = 0; k < texels.count; k += int(virtual_lanes)) {
    const EightTexels eight(texels, k, of);
    for (std::size_t part = 0; part < parts; ++part) {
      const float* v = &middles.v[std::size_t(texels.first - low + k) + part * lanes];
      V mean = power.mean_of(hn::LoadU(d, v));
      for (std::size_t n = 1; n < middles.panels; ++n) mean += power.mean_of(hn::LoadU(d, v + n * middles.stride));
      total.add(part, mean, eight.light[0] + part * lanes, virtual_lanes);
    }
  }
  return total.whole();
}

template <bool cosine>
Flux over_power_rows(const LevelKernel& k, RowsOfLatlong rows, const Columns& columns, const Light& of) {
  const Piece& first = rows[0].texels.texel;
  const double high = first.y1 - first.y0;
  const Middles middles(columns, std::size_t(std::ceil(std::max(1.0, variation_over(k, high)))));
  const SideRule& down = steepest_rule(k, high);
  std::vector<PowerRow> powers;
  powers.reserve(rows.size());
  double least = 1, most = 0, farthest = 0;
  for (const RowOfLatlong& r : rows) {
    OnLatlong::Row points;
    r.place.set(r.texels.texel, down, points);
    const PowerRow& power = powers.emplace_back(PowerRow::of<cosine>(k, points, down.count));
    least = std::min(least, power.gamma), most = std::max(most, power.gamma);
    farthest = std::max(farthest, power.gamma * SmallAngle(r.farthest()).versine);
  }
  const double panel = (first.x1 - first.x0) / double(middles.panels);
  const PowerPolynomials<cosine> across(k, 0.5 * panel, least, most, farthest);
  Flux sum(0);
  for (std::size_t r = 0; r < rows.size(); ++r)
    sum += powers[r].height * over_power_row(across.at(powers[r]), rows[r].texels, columns.low, middles, of);
  return panel * high * sum;
}

// Whether a power falls little enough over a texel for narrow_power-inl.h.
bool is_power(const LevelKernel& k, double side) {
  return k.kind == LevelKernel::Kind::power && variation_over(k, side) <= most_panels;
}

Flux NearFieldLatlong(const Light& light, const LevelKernel& k, const GridView& view) {
  const int columns = light.source.width();
  const double at = view.longitude * columns / (2 * pi);
  std::vector<RowOfLatlong> rows = rows_within(light.source, double(k.end), view, at);
  if (rows.empty()) return Flux(0);
  Columns seen{at, columns, columns, -columns};
  for (const RowOfLatlong& r : rows) {
    seen.low = std::min(seen.low, r.texels.first);
    seen.high = std::max(seen.high, r.texels.first + r.texels.count + int(virtual_lanes));
  }
  auto others = rows.begin();
  if (is_power(k, pi / light.source.height()))
    others = std::ranges::stable_partition(rows, &RowOfLatlong::is_far_from_poles).begin();
  const auto powers = RowsOfLatlong(rows.begin(), others), rest = RowsOfLatlong(others, rows.end());
  Flux sum(0);
  if (!powers.empty())
    sum += k.cosine ? over_power_rows<true>(k, powers, seen, light) : over_power_rows<false>(k, powers, seen, light);
  if (!rest.empty()) sum += over_rows(k, rest, seen, light);
  return sum;
}

// The rows or columns of a face that come within `reach` of a direction. @param ahead,aside the direction's components
// along the face's axis and along its side.
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

// What a lobe covers of a face.
struct Window {
  OnCube place;
  Cells across, down;
  double wide;  // The side of a texel.

  [[nodiscard]] int count() const { return across.last - across.first + 1; }
  // The left or upper side of a texel, from the direction's place.
  [[nodiscard]] double left(double column) const { return column * wide - 1 - place.exact_s; }
  [[nodiscard]] double top(double row) const { return row * wide - 1 - place.exact_t; }
  // What of it lies within a distance of the direction's place.
  [[nodiscard]] Window within(double distance) const {
    const auto cells = [&](double at, const Cells& all) {
      const auto cell = [&](double beside) { return int(std::floor((beside + 1 + at) / wide)); };
      return Cells{std::clamp(cell(-distance), all.first, all.last), std::clamp(cell(distance), all.first, all.last)};
    };
    return {place, cells(place.exact_s, across), cells(place.exact_t, down), wide};
  }
  [[nodiscard]] RowOfTexels row_of(const Level& source, int face, int row) const {
    const double x = left(across.first), y = top(row);
    return {source.row(face, row), across.first, count(), {x, x + wide, y, y + wide}};
  }
};

Flux over_face(const Light& light, const LevelKernel& k, int face, const Window& w) {
  const Rules rules = rules_for(k, w.wide, w.across.first, w.count());
  for (const RuleAcross& r : rules.used())
    for (std::size_t e = 0; e < r.rule->count; ++e)
      for (int i = 0; i < w.count() + int(virtual_lanes); ++i)
        r.x[e * r.stride + std::size_t(i)] = float(w.left(w.across.first + i + r.rule->at[e]));
  Flux sum(0);
  for (int row = w.down.first; row <= w.down.last; ++row)
    sum += OverRow(w.place, k, rules, w.row_of(light.source, face, row), light);
  return sum;
}

// The texels of a window, each divided into panels x panels.
template <bool cosine>
class PanelsOnFace {
 public:
  PanelsOnFace(const LevelKernel& k, const Window& window, int panels)
      : window_(window),
        count_(std::size_t(panels)),
        half_(0.5 / panels),
        area_(float(window.wide / panels * (window.wide / panels))),
        stride_(std::size_t(window.count()) + virtual_lanes),
        across_(window.left(window.across.first + half_), window.left(window.across.last + 1 - half_)),
        means_(window.place, k, across_,
               {window.top(window.down.first + half_), window.top(window.down.last + 1 - half_)}, window.wide / panels),
        places_(count_ * stride_),
        rows_(count_) {
    for (std::size_t n = 0; n < count_; ++n)
      for (std::size_t i = 0; i < stride_; ++i) {
        const double column = window.across.first + double(i) + half_ * double(2 * n + 1);
        places_[n * stride_ + i] = float((window.left(column) - across_.middle) / across_.half);
      }
  }

  // @param row of the face, which may lie beside the window.
  void set_row(int row) {
    for (std::size_t m = 0; m < count_; ++m) rows_[m] = means_.row(window_.top(row + half_ * double(2 * m + 1)));
  }

  // The integral of the power over each texel of a vector from a column of the window on.
  [[nodiscard]] HWY_INLINE V sum_at(int column) const {
    const D d;
    const auto k = std::size_t(column - window_.across.first);
    V sum = hn::Zero(d);
    for (std::size_t n = 0; n < count_; ++n) {
      const V t = hn::LoadU(d, &places_[n * stride_ + k]);
      for (const auto& row : rows_) sum += exp2_small(d, row.at(t));
    }
    return broadcast(area_) * sum;
  }

  [[nodiscard]] std::size_t values_of(std::size_t texels) const { return texels * count_ * count_; }

 private:
  Window window_;
  std::size_t count_;
  double half_;  // Half of a panel's side, as a part of a texel's.
  float area_;
  std::size_t stride_;
  MiddlesAlong across_;
  PanelMeans<cosine> means_;
  std::vector<float> places_;  // From -1 to 1: of the first panels of all texels, then of the second ones.
  std::vector<typename PanelMeans<cosine>::Row> rows_;
};

// Texels in the middle, where a power falls less, are divided into one panel less.
template <bool cosine>
Flux over_power_face(const Light& light, const LevelKernel& k, int face, const Window& w, int panels) {
  PanelsOnFace<cosine> outer(k, w, panels);
  std::optional<PanelsOnFace<cosine>> inner;
  const double reach = panels > 1 ? reach_of_panels(k, w.wide, panels - 1) : 0;
  if (panels > 1) inner.emplace(k, w.within(reach), panels - 1);
  Sums total;
  std::size_t values = (inner ? 2 : 1) * panel_values;
  for (int row = w.down.first; row <= w.down.last; ++row) {
    const RowOfTexels texels = w.row_of(light.source, face, row);
    outer.set_row(row);
    if (inner) inner->set_row(row);
    for (int i = 0; i < texels.count; i += int(virtual_lanes)) {
      const Piece& p = texels.texel;
      const double left = p.x0 + i * w.wide, right = left + virtual_lanes * w.wide;
      const bool is_near = portable::hypot(std::max(-left, right), std::max(-p.y0, p.y1)) < reach;
      const PanelsOnFace<cosine>& divided = is_near ? *inner : outer;
      const EightTexels eight(texels, i, light);
      for (std::size_t part = 0; part < parts; ++part)
        total.add(part, divided.sum_at(w.across.first + i + int(part * lanes)), eight.light[0] + part * lanes,
                  virtual_lanes);
      values += divided.values_of(virtual_lanes);
    }
  }
  count(Work::near_field_points, values);
  return total.whole();
}

Flux NearFieldCube(const Light& light, const LevelKernel& k, const Direction& n) {
  const double reach = 2 * portable::asin(std::sqrt(0.5 * double(k.end)));
  const int size = light.source.height();
  const double wide = 2.0 / size;
  const std::optional<int> panels = panels_on_face(k, wide);
  Flux sum(0);
  for (int face = 0; face < 6; ++face) {
    const Cube::Axes& a = Cube::axes[std::size_t(face)];
    const double ahead = glm::dot(n, a.forward), right = glm::dot(n, a.right), up = glm::dot(n, a.up);
    if (ahead < 0.3) continue;  // Beyond a corner by more than 0.2 radians.
    const Window w{{right / ahead, -up / ahead},
                   cells_of(ahead, right, reach, size),
                   cells_of(ahead, -up, reach, size),
                   wide};
    if (w.count() <= 0 || w.down.last < w.down.first) continue;
    if (!panels)
      sum += over_face(light, k, face, w);
    else
      sum += k.cosine ? over_power_face<true>(light, k, face, w, *panels)
                      : over_power_face<false>(light, k, face, w, *panels);
  }
  return sum;
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace envmap::prefiltering {
HWY_EXPORT(NearFieldLatlong);
HWY_EXPORT(NearFieldCube);

Flux near_field_sum(const Level& source, const Colour& min_radiance, double unit, const LevelKernel& kernel,
                    const Direction& direction) {
  const Light light(source, min_radiance, unit);
  if (source.projection() == Projection::cube)
    return kernel.scale * HWY_DYNAMIC_DISPATCH(NearFieldCube)(light, kernel, direction);
  return kernel.scale * HWY_DYNAMIC_DISPATCH(NearFieldLatlong)(light, kernel, GridView(direction));
}

}  // namespace envmap::prefiltering
#endif  // HWY_ONCE

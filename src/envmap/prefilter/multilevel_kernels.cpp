// The inner loops of multilevel summation, compiled once for every instruction set and chosen at run time.
#include "envmap/prefilter/multilevel_kernels.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/prefilter/multilevel_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "envmap/prefilter/level_kernel-inl.h"

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {

void AddScaled(std::span<const float> in, float weight, std::span<float> out) {
  const D d;
  const V w = hn::Set(d, weight);
  std::size_t k = 0;
  for (; k + lanes <= out.size(); k += lanes)
    hn::StoreU(hn::Add(hn::LoadU(d, &out[k]), hn::Mul(w, hn::LoadU(d, &in[k]))), d, &out[k]);
  for (; k < out.size(); ++k) out[k] += weight * in[k];
}

void DotProducts(std::span<const float> in, std::size_t step, std::span<const float> weights, std::span<float> out) {
  const D d;
  for (std::size_t k = 0; k < out.size(); ++k) {
    const float* from = &in[k * step];
    V total[parts];
    for (V& v : total) v = hn::Zero(d);
    for (std::size_t i = 0; i < weights.size(); i += virtual_lanes)
      for (std::size_t part = 0; part < parts; ++part) {
        const std::size_t at = i + part * lanes;
        total[part] = hn::Add(total[part], hn::Mul(hn::LoadU(d, from + at), hn::LoadU(d, &weights[at])));
      }
    out[k] = float(sum_of(total));
  }
}

template <class K>
Flux GatherRows(const SourceGrid& grid, const K& kernel, const GatherRoom& room) {
  const D d;
  V total[3][parts];
  for (auto& channel : total)
    for (V& v : channel) v = hn::Zero(d);
  for (const GatherRoom::Row& r : room.rows) {
    const float* light = &grid.light[grid.first[std::size_t(r.row)]];
    const std::size_t stride = grid.stride(r.row), mask = std::size_t(grid.columns[std::size_t(r.row)]) - 1;
    const GatherRoom::Angles& angles = room.kinds[std::size_t(r.kind)];
    const float* versines = &room.versines[angles.first + std::size_t(r.start - angles.low)];
    const V c = hn::Set(d, r.c), g = hn::Set(d, r.g);
    V sum[3][parts];
    for (auto& channel : sum)
      for (V& v : channel) v = hn::Zero(d);
    std::size_t at = std::size_t(r.start);
    for (int block = 0; block < r.blocks; ++block, at += virtual_lanes, versines += virtual_lanes) {
      const float* p = light + (at & mask);
      for (std::size_t part = 0; part < parts; ++part, p += lanes) {
        const V k = kernel(hn::Add(c, hn::Mul(g, hn::LoadU(d, versines + part * lanes))));
        for (std::size_t channel = 0; channel < 3; ++channel)
          sum[channel][part] = hn::Add(sum[channel][part], hn::Mul(k, hn::LoadU(d, p + channel * stride)));
      }
    }
    for (std::size_t channel = 0; channel < 3; ++channel)
      for (std::size_t part = 0; part < parts; ++part)
        total[channel][part] = hn::Add(total[channel][part], sum[channel][part]);
  }
  Flux out;
  for (std::size_t channel = 0; channel < 3; ++channel) out[int(channel)] = sum_of(total[channel]);
  return out;
}

template <bool quartic>
Flux GatherGgx(const SourceGrid& grid, const LevelKernel& k, const GatherRoom& room) {
  if (k.inner.is) {
    if (k.outer.is) return GatherRows(grid, OfGgx<true, true, quartic>{k}, room);
    return GatherRows(grid, OfGgx<true, false, quartic>{k}, room);
  }
  if (k.outer.is) return GatherRows(grid, OfGgx<false, true, quartic>{k}, room);
  return GatherRows(grid, OfGgx<false, false, quartic>{k}, room);
}

// Which columns of a row the kernel reaches, in blocks of eight. @return whether there are any.
HWY_INLINE bool set_window(const SourceGrid& grid, int row, double end, const GridView& view, GatherRoom::Row& out) {
  const auto r = std::size_t(row);
  const double d = grid.half_sine[r] * view.half_cosine - grid.half_cosine[r] * view.half_sine, c = 2 * d * d;
  const double g = double(grid.sine[r]) * view.sine;
  if (c >= end) return false;
  const double versine = (end - c) / std::max(1e-30, g);
  const int columns = grid.columns[r];
  const double at = view.longitude * columns / (2 * pi) - 0.5,
               w = versine >= 2 ? columns : half_width(versine, columns);
  out.row = row, out.c = float(c), out.g = float(g);
  if (2 * w >= columns - 10) {
    out.start = int(std::floor(at)) - columns / 2;
    out.start -= out.start & 7, out.blocks = columns / 8;
  } else {
    out.start = int(std::ceil(at - w));
    out.blocks = (int(std::floor(at + w)) + 1 - out.start + 7) / 8;
  }
  return out.blocks > 0;
}

// Widens the span of longitudes of rows with as many columns. @return which that is.
HWY_INLINE int set_kind(int columns, const GatherRoom::Row& row, std::vector<GatherRoom::Angles>& kinds) {
  const int end = row.start + 8 * row.blocks;
  for (std::size_t k = kinds.size(); k-- > 0;) {
    GatherRoom::Angles& a = kinds[k];
    if (a.columns != columns) continue;
    a.low = std::min(a.low, row.start), a.high = std::max(a.high, end);
    return int(k);
  }
  kinds.push_back({columns, row.start, end, 0});
  return int(kinds.size()) - 1;
}

// Finds the rows of the window, and the columns of each.
void SetRoom(const SourceGrid& grid, const LevelKernel& kernel, const GridView& view, GatherRoom& room) {
  const double end = double(kernel.end), reach = end >= 1 ? 0.5 * pi : 2 * portable::asin(std::sqrt(0.5 * end)),
               per_row = grid.rows / pi;
  const int low = std::max(0, int(std::floor((view.angle - reach) * per_row)));
  const int high = std::min(grid.rows - 1, int(std::floor((view.angle + reach) * per_row)));
  room.rows.resize(std::size_t(high - low + 1)), room.kinds.clear();
  std::size_t count = 0;
  for (int r = low; r <= high; ++r) {
    GatherRoom::Row& row = room.rows[count];
    if (!set_window(grid, r, end, view, row)) continue;
    row.kind = set_kind(grid.columns[std::size_t(r)], row, room.kinds);
    ++count;
  }
  room.rows.resize(count);
  std::size_t size = 0;
  for (GatherRoom::Angles& a : room.kinds) {
    a.high += (8 - (a.high - a.low) % 8) % 8;
    a.first = size, size += std::size_t(a.high - a.low);
  }
  if (room.versines.size() < size) room.versines.resize(size);
}

Flux Gather(const SourceGrid& grid, const LevelKernel& k, const GridView& view, GatherRoom& room) {
  SetRoom(grid, k, view, room);
  for (const GatherRoom::Angles& a : room.kinds)
    versines(view.longitude * a.columns / (2 * pi) - 0.5, a.columns, a.low, a.high, &room.versines[a.first]);
  if (k.kind == LevelKernel::Kind::ggx)
    return k.quartic ? GatherGgx<true>(grid, k, room) : GatherGgx<false>(grid, k, room);
  if (k.cosine) return GatherRows(grid, OfPower<true>{k}, room);
  return GatherRows(grid, OfPower<false>{k}, room);
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace envmap::prefiltering {
HWY_EXPORT(AddScaled);
HWY_EXPORT(DotProducts);
HWY_EXPORT(Gather);

void dot_products(std::span<const float> in, std::size_t step, std::span<const float> weights, std::span<float> out) {
  HWY_DYNAMIC_DISPATCH(DotProducts)(in, step, weights, out);
}

void add_scaled(std::span<const float> in, float weight, std::span<float> out) {
  HWY_DYNAMIC_DISPATCH(AddScaled)(in, weight, out);
}

GridView::GridView(const Direction& n)
    : longitude(portable::atan2(n.x, -n.z)), sine(portable::hypot(n.x, n.z)), angle(portable::atan2(sine, n.y)) {
  if (longitude < 0) longitude += 2 * pi;
  half_sine = portable::sin_pi(0.5 * angle / pi), half_cosine = portable::cos_pi(0.5 * angle / pi);
}

Flux gather(const SourceGrid& grid, const LevelKernel& kernel, const GridView& view, GatherRoom& room) {
  return kernel.scale * HWY_DYNAMIC_DISPATCH(Gather)(grid, kernel, view, room);
}

}  // namespace envmap::prefiltering
#endif  // HWY_ONCE

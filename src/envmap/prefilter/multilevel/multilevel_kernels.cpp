// The inner loops of multilevel summation, compiled once for every instruction set and chosen at run time.
#include "envmap/prefilter/multilevel/multilevel_kernels.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <type_traits>
#include <utility>

#include "envmap/base/without_avx512.h"
#include "envmap/prefilter/multilevel/lagrange.h"
#include "envmap/prefilter/work_counters.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/prefilter/multilevel/multilevel_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "envmap/prefilter/multilevel/level_kernel-inl.h"

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {

void AddScaled(std::span<const float> in, float weight, std::span<float> out) {
  const D d;
  const V w = broadcast(weight);
  std::size_t k = 0;
  for (; k + lanes <= out.size(); k += lanes) hn::StoreU(hn::LoadU(d, &out[k]) + w * hn::LoadU(d, &in[k]), d, &out[k]);
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
        total[part] += hn::LoadU(d, from + at) * hn::LoadU(d, &weights[at]);
      }
    out[k] = float(sum_of(total));
  }
}

// The values of a kernel in a window, vector after vector of columns.
template <class K>
struct KernelWeights {
  const K& kernel;
  const GatherBuffers& buffers;
  const float* versine = nullptr;
  float c = 0, g = 0;

  HWY_INLINE void begin(const GatherBuffers::Row& r) {
    const GatherBuffers::Longitudes& of = buffers.longitudes[std::size_t(r.longitudes)];
    versine = &buffers.versines[of.first + std::size_t(r.start - of.low)], c = r.c, g = r.g;
  }
  HWY_INLINE V next() {
    const D d;
    const V at = broadcast(c) + broadcast(g) * hn::LoadU(d, versine);
    versine += lanes;
    return kernel(at);
  }
};
// A column that may lie outside the row by less than its length.
HWY_INLINE int wrapped(int at, int columns) {
  at = at < 0 ? at + columns : at;
  return at >= columns ? at - columns : at;
}
// The column one block further on.
HWY_INLINE int next_block(int at, int columns) {
  at += int(virtual_lanes);
  return at >= columns ? at - columns : at;
}

// The sum of weights x values over all rows of a window.
template <class Weights>
Flux SumOfRows(const NodeGrid& grid, const GatherBuffers& buffers, Weights weights) {
  Sums total;
  for (const GatherBuffers::Row& r : buffers.rows) {
    const float* values = &grid.values[grid.first[std::size_t(r.row)]];
    const int columns = grid.columns[std::size_t(r.row)];
    const std::size_t stride = grid.stride(r.row);
    weights.begin(r);
    Sums sum;
    int at = wrapped(r.start, columns);
    for (int block = 0; block < r.blocks; ++block, at = next_block(at, columns))
      for (std::size_t part = 0; part < parts; ++part)
        sum.add(part, weights.next(), values + at + part * lanes, stride);
    total.add(sum);
  }
  return total.whole();
}

// Products of taps and N windows of a row, none of which passes the end of the row.
template <std::size_t N>
HWY_INLINE void add_windows(const float* taps, std::size_t size, const float* const (&values)[N], std::size_t stride,
                            Sums (&sum)[N]) {
  for (std::size_t k = 0; k < size; k += virtual_lanes)
    for (std::size_t part = 0; part < parts; ++part) {
      const V tap = hn::LoadU(D(), taps + k + part * lanes);
      for (std::size_t n = 0; n < N; ++n) sum[n].add(part, tap, values[n] + k + part * lanes, stride);
    }
}
// Products of taps and a window of a row from column `at` on, which wraps.
HWY_INLINE void add_wrapped(const float* taps, std::size_t size, const float* row, int at, int columns,
                            std::size_t stride, Sums& sum) {
  for (std::size_t k = 0; k < size; k += virtual_lanes, at = next_block(at, columns))
    for (std::size_t part = 0; part < parts; ++part)
      sum.add(part, hn::LoadU(D(), taps + k + part * lanes), row + at + part * lanes, stride);
}

// Adds taps x values of N nodes of a row with `columns` columns: of the node `by` columns after the one that the taps
// are for, and of every `step`-th node after it. Rows have 2^k times fewer or more columns, so that all nodes share the
// taps.
template <std::size_t N>
void SumOfTaps(const NodeGrid& grid, const GatherBuffers& buffers, int columns, int by, int step, double scale,
               Flux* out) {
  Sums total[N];
  const float* taps = buffers.taps.data();
  for (const GatherBuffers::Row& r : buffers.rows) {
    const int here = grid.columns[std::size_t(r.row)];
    const std::size_t stride = grid.stride(r.row), size = std::size_t(r.blocks) * virtual_lanes;
    const float *row = &grid.values[grid.first[std::size_t(r.row)]], *values[N];
    const int denser = int(std::bit_width(unsigned(here))) - int(std::bit_width(unsigned(columns)));
    bool is_whole = true;
    for (std::size_t n = 0; n < N; ++n) {
      const int moved = by + int(n) * step;
      const int at = wrapped(wrapped(r.start, here) + (denser >= 0 ? moved << denser : moved >> -denser), here);
      values[n] = row + at;
      is_whole = is_whole && std::size_t(at) + size <= std::size_t(here) + virtual_lanes;
    }
    Sums sum[N];
    if (is_whole)
      add_windows(taps, size, values, stride, sum);
    else
      for (std::size_t n = 0; n < N; ++n) add_wrapped(taps, size, row, int(values[n] - row), here, stride, sum[n]);
    taps += size;
    for (std::size_t n = 0; n < N; ++n) total[n].add(sum[n]);
  }
  for (std::size_t n = 0; n < N; ++n) out[n * std::size_t(step)] += scale * total[n].whole();
}

// Calls sum(kernel) with the kernel for lanes.
template <bool quartic, class Sum>
auto with_ggx(const LevelKernel& k, Sum&& sum) {
  if (k.inner.active)
    return k.outer.active ? sum(GgxKernel<true, true, quartic>{k}) : sum(GgxKernel<true, false, quartic>{k});
  return k.outer.active ? sum(GgxKernel<false, true, quartic>{k}) : sum(GgxKernel<false, false, quartic>{k});
}
template <class Sum>
auto with_kernel(const LevelKernel& k, Sum&& sum) {
  if (k.kind == LevelKernel::Kind::ggx) return k.quartic ? with_ggx<true>(k, sum) : with_ggx<false>(k, sum);
  return k.cosine ? sum(PowerKernel<true>{k}) : sum(PowerKernel<false>{k});
}

// Sets the columns of a row that the kernel reaches, in blocks of eight. @return whether there are any.
HWY_INLINE bool set_window(const NodeGrid& grid, int row, double end, const GridView& view, GatherBuffers::Row& out) {
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

// Adds the columns of a row to the longitudes of rows with as many columns. @return the index of these.
HWY_INLINE int add_longitudes(int columns, const GatherBuffers::Row& row, std::vector<GatherBuffers::Longitudes>& all) {
  const int end = row.start + 8 * row.blocks;
  for (std::size_t k = all.size(); k-- > 0;) {
    GatherBuffers::Longitudes& a = all[k];
    if (a.columns != columns) continue;
    a.low = std::min(a.low, row.start), a.high = std::max(a.high, end);
    return int(k);
  }
  all.push_back({columns, row.start, end, 0});
  return int(all.size()) - 1;
}

// The first and the last row of the window.
std::pair<int, int> rows_of(const NodeGrid& grid, const LevelKernel& kernel, const GridView& view) {
  const double end = double(kernel.end), reach = end >= 1 ? 0.5 * pi : 2 * portable::asin(std::sqrt(0.5 * end)),
               per_row = grid.rows / pi;
  return {std::max(0, int(std::floor((view.angle - reach) * per_row))),
          std::min(grid.rows - 1, int(std::floor((view.angle + reach) * per_row)))};
}

// Sets the columns of each row of the window.
void SetWindows(const NodeGrid& grid, const LevelKernel& kernel, const GridView& view, GatherBuffers& buffers) {
  const double end = double(kernel.end);
  const auto [low, high] = rows_of(grid, kernel, view);
  buffers.rows.resize(std::size_t(high - low + 1)), buffers.longitudes.clear();
  std::size_t count = 0;
  for (int r = low; r <= high; ++r) {
    GatherBuffers::Row& row = buffers.rows[count];
    if (!set_window(grid, r, end, view, row)) continue;
    row.longitudes = add_longitudes(grid.columns[std::size_t(r)], row, buffers.longitudes);
    ++count;
  }
  buffers.rows.resize(count);
  std::size_t blocks = 0;
  for (const GatherBuffers::Row& r : buffers.rows) blocks += std::size_t(r.blocks);
  envmap::prefiltering::count(Work::kernels, virtual_lanes * blocks);
  std::size_t size = 0;
  for (GatherBuffers::Longitudes& a : buffers.longitudes) {
    a.high += (8 - (a.high - a.low) % 8) % 8;
    a.first = size, size += std::size_t(a.high - a.low);
  }
  if (buffers.versines.size() < size) buffers.versines.resize(size);
}

// Sets the columns of each row of the window, and their versines.
void SetVersines(const NodeGrid& grid, const LevelKernel& k, const GridView& view, GatherBuffers& buffers) {
  SetWindows(grid, k, view, buffers);
  for (const GatherBuffers::Longitudes& a : buffers.longitudes)
    versines(view.longitude * a.columns / (2 * pi) - 0.5, a.columns, a.low, a.high, &buffers.versines[a.first]);
}

Flux Gather(const NodeGrid& grid, const LevelKernel& k, const GridView& view, GatherBuffers& buffers) {
  SetVersines(grid, k, view, buffers);
  return with_kernel(k, [&](const auto& kernel) {
    return SumOfRows(grid, buffers, KernelWeights<std::decay_t<decltype(kernel)>>{kernel, buffers});
  });
}

// Sets the values of the kernel in the window, row after row.
template <class K>
void SetTaps(const K& kernel, GatherBuffers& buffers) {
  buffers.taps.clear();
  KernelWeights<K> weights{kernel, buffers};
  for (const GatherBuffers::Row& r : buffers.rows) {
    const std::size_t first = buffers.taps.size(), count = virtual_lanes * std::size_t(r.blocks);
    buffers.taps.resize(first + count);
    weights.begin(r);
    for (std::size_t k = 0; k < count; k += lanes) hn::StoreU(weights.next(), D(), &buffers.taps[first + k]);
  }
}

void GatherAtRow(const NodeGrid& grid, const LevelKernel& k, int row, GatherBuffers& buffers, std::span<Flux> out) {
  const int columns = grid.columns[std::size_t(row)];
  // Nodes as far apart as the columns of the sparsest row lie alike among the columns of all rows, and share taps.
  const auto [low, high] = rows_of(grid, k, grid.node(row, 0));
  const int sparsest = std::min(grid.columns[std::size_t(low)], grid.columns[std::size_t(high)]);
  const int phases = std::max(1, columns / sparsest);
  for (int phase = 0; phase < phases; ++phase) {
    SetVersines(grid, k, grid.node(row, phase), buffers);
    with_kernel(k, [&](const auto& kernel) { SetTaps(kernel, buffers); });
    count(Work::taps, buffers.taps.size() * std::size_t((columns - phase + phases - 1) / phases));
    constexpr int together = 4;
    int n = phase;
    for (; n + (together - 1) * phases < columns; n += together * phases)
      SumOfTaps<together>(grid, buffers, columns, n - phase, phases, k.scale, &out[std::size_t(n)]);
    for (; n < columns; n += phases)
      SumOfTaps<1>(grid, buffers, columns, n - phase, phases, k.scale, &out[std::size_t(n)]);
  }
}

// Weights of an interpolation across a row, padded with 0 to two blocks of lanes.
struct Across {
  int columns = 0, first = 0;
  bool turned = false;
  alignas(32) float weights[2 * virtual_lanes] = {};

  void set(double longitude, int of_columns, bool is_turned) {
    columns = of_columns, turned = is_turned;
    Weights w;
    first = lagrange((longitude / (2 * pi) + (turned ? 0.5 : 0)) * columns - 0.5, w);
    first = (first + columns) % columns;
    for (std::size_t k = 0; k < w.size(); ++k) weights[k] = float(w[k]);
  }
};

Flux Interpolate(const NodeGrid& grid, const GridView& view) {
  const D d;
  count(Work::nodes, 1);
  Weights down;
  const int top = lagrange(view.angle * grid.rows / pi - 0.5, down);
  Sums total;
  Across across;
  for (int i = 0; i < nodes_across; ++i) {
    const int r = folded(top + i, grid.rows);
    const bool turned = r != top + i;
    const int columns = grid.columns[std::size_t(r)];
    if (columns != across.columns || turned != across.turned) across.set(view.longitude, columns, turned);
    const float* from = &grid.values[grid.first[std::size_t(r)] + std::size_t(across.first)];
    const V weight = broadcast(down[std::size_t(i)]);
    for (std::size_t part = 0; part < 2 * parts; ++part)
      total.add(part % parts, weight * hn::Load(d, across.weights + part * lanes), from + part * lanes, grid.stride(r));
  }
  return total.whole();
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace envmap::prefiltering {
HWY_EXPORT(AddScaled);
HWY_EXPORT(DotProducts);
HWY_EXPORT(Gather);
HWY_EXPORT(GatherAtRow);
HWY_EXPORT(Interpolate);

void dot_products(std::span<const float> in, std::size_t step, std::span<const float> weights, std::span<float> out) {
  HWY_DYNAMIC_DISPATCH(DotProducts)(in, step, weights, out);
}

void add_scaled(std::span<const float> in, float weight, std::span<float> out) {
  HWY_DYNAMIC_DISPATCH(AddScaled)(in, weight, out);
}

Flux gather(const NodeGrid& grid, const LevelKernel& kernel, const GridView& view, GatherBuffers& buffers) {
  return kernel.scale * HWY_DYNAMIC_DISPATCH(Gather)(grid, kernel, view, buffers);
}

void gather_at_row(const NodeGrid& grid, const LevelKernel& kernel, int row, GatherBuffers& buffers,
                   std::span<Flux> out) {
  HWY_DYNAMIC_DISPATCH(GatherAtRow)(grid, kernel, row, buffers, out);
}

Flux interpolate(const NodeGrid& grid, const GridView& view) { return HWY_DYNAMIC_DISPATCH(Interpolate)(grid, view); }

}  // namespace envmap::prefiltering
#endif  // HWY_ONCE

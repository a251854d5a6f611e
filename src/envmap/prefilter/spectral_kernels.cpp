// The inner loops of the spectral method, compiled once for every instruction set and chosen at run time.
#include "envmap/prefilter/spectral_kernels.h"

#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/prefilter/spectral_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;

// Where ring k of a stencil really is: its row and first column.
struct Place {
  int ring, column;
};
HWY_INLINE Place place(const RingGrid& grid, const Stencil& at, std::size_t k) {
  const int ring = at.ring + int(k);
  if (ring >= 0 && ring < grid.rings) return {ring, at.column};
  return {ring < 0 ? -1 - ring : 2 * grid.rings - 1 - ring, (at.column + grid.columns / 2) % grid.columns};
}

// The stencils of all points of a spot first, as one table; then that times each colour.
void SpreadOne(RingGrid& grid, const Spot& spot) {
  const D d;
  double row_sum = 0, column_sum = 0;
  for (std::size_t n = 0; n < spot.count; ++n) row_sum += spot.down[n], column_sum += spot.across[n];
  constexpr int before = taps / 2 - 1;
  const int ring = int(std::floor(row_sum / double(spot.count))) - before;
  const int column = int(std::floor(column_sum / double(spot.count))) - before;
  alignas(64) std::array<std::array<double, taps>, taps> table{};
  for (std::size_t n = 0; n < spot.count; ++n) {
    const std::array<double, taps> down = lagrange(spot.down[n] - ring), across = lagrange(spot.across[n] - column);
    for (std::size_t k = 0; k < taps; ++k) {
      const V weight = hn::Set(d, spot.weight[n] * down[k]);
      for (std::size_t s = 0; s < taps; s += hn::Lanes(d))
        hn::Store(hn::Add(hn::Load(d, &table[k][s]), hn::Mul(weight, hn::LoadU(d, &across[s]))), d, &table[k][s]);
    }
  }
  const Stencil at{ring, (column + 2 * grid.columns) % grid.columns, {}, {}};
  for (std::size_t k = 0; k < taps; ++k) {
    const Place first = place(grid, at, k);
    for (std::size_t turn = 0; turn < spot.light.turns; ++turn) {
      const int to = (first.column + int(turn) * (grid.columns / 4)) % grid.columns;
      for (std::size_t c = 0; c < 3; ++c) {
        double* row = grid.row(first.ring, c) + to;
        const V colour = hn::Set(d, spot.light.colours[turn][c]);
        for (std::size_t s = 0; s < taps; s += hn::Lanes(d))
          hn::StoreU(hn::Add(hn::LoadU(d, row + s), hn::Mul(colour, hn::Load(d, &table[k][s]))), d, row + s);
      }
    }
  }
}
void Spread(RingGrid& grid, std::span<const Spot> spots) {
  for (const Spot& spot : spots) SpreadOne(grid, spot);
}

// The sum down first, then across in one order whatever the width of a vector.
void Interpolate(RingGrid& grid, const Stencil& at, std::array<double, 3>& out) {
  const D d;
  for (std::size_t c = 0; c < 3; ++c) {
    std::array<double, taps> sums;
    for (std::size_t n = 0; n < taps; n += hn::Lanes(d)) {
      V sum = hn::Zero(d);
      for (std::size_t k = 0; k < taps; ++k) {
        const Place from = place(grid, at, k);
        const double* row = grid.row(from.ring, c) + from.column;
        sum = hn::Add(sum, hn::Mul(hn::Set(d, at.down[k]), hn::LoadU(d, row + n)));
      }
      hn::StoreU(hn::Mul(sum, hn::LoadU(d, &at.across[n])), d, &sums[n]);
    }
    out[c] = ((sums[0] + sums[7]) + (sums[1] + sums[6])) + ((sums[2] + sums[5]) + (sums[3] + sums[4]));
  }
}

void Legendre(std::span<const double> a, std::span<const double> b, const std::array<double, block>& y,
              const std::array<double, block>& first, std::span<std::array<double, block>> out) {
  const D d;
  for (std::size_t s = 0; s < block; s += hn::Lanes(d)) {
    const V at = hn::LoadU(d, &y[s]);
    V before = hn::Zero(d), now = hn::LoadU(d, &first[s]);
    hn::StoreU(now, d, &out[0][s]);
    for (std::size_t k = 1; k < out.size(); ++k) {
      const V next = hn::Mul(hn::Set(d, a[k]), hn::Sub(hn::Mul(at, now), hn::Mul(hn::Set(d, b[k]), before)));
      before = now;
      now = next;
      hn::StoreU(now, d, &out[k][s]);
    }
  }
}

void ProjectRings(std::span<const std::array<double, block>> p, const std::array<Parts, block>& even,
                  const std::array<Parts, block>& odd, std::span<Parts> coefficients) {
  const D d;
  for (std::size_t s = 0; s < even[0].size(); s += hn::Lanes(d))
    for (std::size_t k = 0; k < p.size(); ++k) {
      const std::array<Parts, block>& rings = k % 2 == 0 ? even : odd;
      V low = hn::LoadU(d, &coefficients[k][s]), high = hn::Zero(d);
      for (std::size_t n = 0; n < block; n += 2) {
        low = hn::Add(low, hn::Mul(hn::Set(d, p[k][n]), hn::LoadU(d, &rings[n][s])));
        high = hn::Add(high, hn::Mul(hn::Set(d, p[k][n + 1]), hn::LoadU(d, &rings[n + 1][s])));
      }
      hn::StoreU(hn::Add(low, high), d, &coefficients[k][s]);
    }
}

void EvaluateRings(std::span<const std::array<double, block>> p, std::span<const Parts> coefficients,
                   std::array<Parts, block>& even, std::array<Parts, block>& odd) {
  const D d;
  for (std::size_t s = 0; s < even[0].size(); s += hn::Lanes(d))
    for (std::size_t n = 0; n < block; n += 4)
      for (std::size_t parity = 0; parity < 2; ++parity) {
        V s0 = hn::Zero(d), s1 = s0, s2 = s0, s3 = s0;
        for (std::size_t k = parity; k < p.size(); k += 2) {
          const V c = hn::LoadU(d, &coefficients[k][s]);
          s0 = hn::Add(s0, hn::Mul(hn::Set(d, p[k][n]), c));
          s1 = hn::Add(s1, hn::Mul(hn::Set(d, p[k][n + 1]), c));
          s2 = hn::Add(s2, hn::Mul(hn::Set(d, p[k][n + 2]), c));
          s3 = hn::Add(s3, hn::Mul(hn::Set(d, p[k][n + 3]), c));
        }
        std::array<Parts, block>& out = parity == 0 ? even : odd;
        hn::StoreU(s0, d, &out[n][s]), hn::StoreU(s1, d, &out[n + 1][s]);
        hn::StoreU(s2, d, &out[n + 2][s]), hn::StoreU(s3, d, &out[n + 3][s]);
      }
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace envmap::prefiltering {
HWY_EXPORT(Spread);
HWY_EXPORT(Interpolate);
HWY_EXPORT(Legendre);
HWY_EXPORT(ProjectRings);
HWY_EXPORT(EvaluateRings);

Stencil stencil_at(const RingGrid& grid, double u, double v) {
  constexpr int before = taps / 2 - 1;
  const double down = v * grid.rings - 0.5, across = u * grid.columns;
  const int ring = int(std::floor(down)) - before, column = int(std::floor(across)) - before;
  return {ring, (column + 2 * grid.columns) % grid.columns, lagrange(down - ring), lagrange(across - column)};
}

void spread(RingGrid& grid, std::span<const Spot> spots) { HWY_DYNAMIC_DISPATCH(Spread)(grid, spots); }
std::array<double, 3> interpolate(RingGrid& grid, const Stencil& at) {
  std::array<double, 3> found;
  HWY_DYNAMIC_DISPATCH(Interpolate)(grid, at, found);
  return found;
}
void legendre(std::span<const double> a, std::span<const double> b, const std::array<double, block>& y,
              const std::array<double, block>& first, std::span<std::array<double, block>> out) {
  HWY_DYNAMIC_DISPATCH(Legendre)(a, b, y, first, out);
}
void project_rings(std::span<const std::array<double, block>> p, const std::array<Parts, block>& even,
                   const std::array<Parts, block>& odd, std::span<Parts> coefficients) {
  HWY_DYNAMIC_DISPATCH(ProjectRings)(p, even, odd, coefficients);
}
void evaluate_rings(std::span<const std::array<double, block>> p, std::span<const Parts> coefficients,
                    std::array<Parts, block>& even, std::array<Parts, block>& odd) {
  HWY_DYNAMIC_DISPATCH(EvaluateRings)(p, coefficients, even, odd);
}

}  // namespace envmap::prefiltering
#endif  // HWY_ONCE

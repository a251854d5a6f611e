// clipped_mean(), compiled once for every instruction set and chosen at run time.
#include "envmap/prefilter/clip.h"

#include <array>
#include <limits>

#include "envmap/base/eight_lanes.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/prefilter/clip.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "envmap/prefilter/lobe_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {

// max(t,0)^exponent of each, t up to 1.
void Powers(const std::array<double, 12>& t, const std::array<double, 12>& exponent, std::array<double, 12>& out) {
  const hn::CappedTag<double, 4> d;
  const auto zero = hn::Zero(d), one = set(d, 1);
  for (std::size_t k = 0; k < t.size(); k += hn::Lanes(d)) {
    const auto at = hn::LoadU(d, &t[k]);
    const auto power = exp2_small(d, hn::Mul(hn::LoadU(d, &exponent[k]), log2_of(d, at, hn::Sub(one, at))));
    hn::StoreU(hn::IfThenElseZero(hn::Gt(at, zero), power), d, &out[k]);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace envmap::prefiltering {

HWY_EXPORT(Powers);

ClippedMean clipped_mean(const Phong& lobe, const FlatPiece& piece) {
  const double a = std::max(piece.across, piece.down), flat = std::min(piece.across, piece.down);
  // The second difference keeps its digits where no side is much flatter than the other; what that adds is a bend, too.
  const double b = std::max(flat, 1e-3 * a), bend = piece.bend + (b - flat), reach = a + b, skew = a - b;
  const double low = piece.cosine - bend, high = piece.cosine + bend;
  if (high + reach <= 0) return {0, 0};
  if (!(a > 1e-12 && high + reach <= 2)) return {0, std::numeric_limits<double>::infinity()};

  constexpr double half = 0.5;  // Powers of t / 2, which is at most 1.
  const double m = lobe.exponent, n = m + 2;
  std::array<double, 12> power;
  HWY_DYNAMIC_DISPATCH(Powers)
  ({half * (low + reach), half * (low + skew), half * (low - skew), half * (low - reach), half * (high + reach),
    half * (high + skew), half * (high - skew), half * (high - reach), half * (high + reach), half * (low - reach),
    half, 0},
   {n, n, n, n, n, n, n, n, m, m, m, m}, power);
  const double scale = lobe.scale() / power[10], second = scale / (a * b * (m + 1) * n);
  const double least = second * ((power[0] - power[1]) - (power[2] - power[3]));
  const double most = second * ((power[4] - power[5]) - (power[6] - power[7]));
  // A density that spans `uneven` is in the mean at most half of that from its own mean, and then counts for at most
  // half of what the lobe spans. A power is off by 1e-14 of itself at most.
  const double span = scale * (power[8] - power[9]), rounding = 2e-14 * second * power[4];
  return {half * (least + most), half * (most - least) + 0.25 * piece.uneven * span + rounding};
}

}  // namespace envmap::prefiltering
#endif  // HWY_ONCE

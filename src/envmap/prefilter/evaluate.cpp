// evaluate(), compiled once for every instruction set and chosen at run time.
#include "envmap/prefilter/evaluate.h"

#include <algorithm>

#include "envmap/prefilter/traverse.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/prefilter/evaluate.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "envmap/prefilter/lobe_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {

// What a lobe with a kink of 1 at the horizon comes to over a node of this mean and deviation s, beyond what two points
// have of it: as over an even interval of half-width 3^(1/2) s, ((r^2 + 3) / (4 3^(1/2)) - max(1, r) / 2) s with
// r = |1 - mean| / s.
template <class D, class V>
HWY_INLINE V rounded_kink(D d, V versine, V deviation, V inverse) {
  const V far = hn::Mul(hn::Abs(hn::Sub(set(d, 1), versine)), inverse), r = hn::Min(far, set(d, 1.7320508075688772));
  const V even = hn::Mul(set(d, 0.14433756729740643), hn::Add(hn::Mul(r, r), set(d, 3)));
  return hn::Mul(deviation, hn::Sub(even, hn::Mul(set(d, 0.5), hn::Max(r, set(d, 1)))));
}

// What a channel has of a node: the lobe at two points with weights that make its mean right. Those are kept between 0
// and 1 where the lobe is not convex: see judge().
template <class L, class D, class V>
HWY_INLINE V two_points(const L& lobe, D d, V flux, V lean, V sum, V difference, V deviation) {
  if (!lobe.convex()) {
    const V most = hn::Mul(flux, deviation);
    lean = hn::Max(hn::Neg(most), hn::Min(lean, most));
  }
  return hn::Max(hn::Zero(d), hn::Add(hn::Mul(flux, sum), hn::Mul(lean, difference)));
}

template <class L>
void evaluate_lanes(const L& lobe, std::span<const TileNode> nodes, Tile& tile) {
  const hn::CappedTag<float, Tile::most> d;
  using V = hn::Vec<decltype(d)>;
  const V half = hn::Set(d, 0.5F), zero = hn::Zero(d), bend = set(d, lobe.kink());
  for (std::size_t k = 0; k < tile.count; k += hn::Lanes(d)) {
    const V x = hn::Load(d, &tile.x[k]), y = hn::Load(d, &tile.y[k]), z = hn::Load(d, &tile.z[k]);
    const V xx = hn::Mul(x, x), xy = hn::Mul(x, y), xz = hn::Mul(x, z);
    const V yy = hn::Mul(y, y), yz = hn::Mul(y, z), zz = hn::Mul(z, z);
    const auto dot = [&](const std::array<float, 3>& a) HWY_ATTR {
      return hn::Add(hn::Add(hn::Mul(hn::Set(d, a[0]), x), hn::Mul(hn::Set(d, a[1]), y)), hn::Mul(hn::Set(d, a[2]), z));
    };
    V red = zero, green = zero, blue = zero;
    for (const TileNode& node : nodes) {
      const V ox = hn::Sub(x, hn::Set(d, node.centre[0])), oy = hn::Sub(y, hn::Set(d, node.centre[1])),
              oz = hn::Sub(z, hn::Set(d, node.centre[2]));
      const V square = hn::Add(hn::Add(hn::Mul(ox, ox), hn::Mul(oy, oy)), hn::Mul(oz, oz));
      const V versine = hn::Mul(half, hn::Add(square, hn::Set(d, node.sag)));
      const auto& m = node.covariance;
      const V outer =
          hn::Add(hn::Add(hn::Mul(hn::Set(d, m[0]), xx), hn::Mul(hn::Set(d, m[3]), yy)), hn::Mul(hn::Set(d, m[5]), zz));
      const V mixed =
          hn::Add(hn::Add(hn::Mul(hn::Set(d, m[1]), xy), hn::Mul(hn::Set(d, m[2]), xz)), hn::Mul(hn::Set(d, m[4]), yz));
      const V variance = hn::Add(hn::Add(hn::Set(d, node.variance), dot(node.slope)), hn::Add(outer, mixed));
      const V most = hn::Set(d, node.most_variance), least = hn::Set(d, least_variance(node.most_variance));
      const V deviation = hn::Sqrt(hn::Max(hn::Min(variance, most), least));
      const V near = value(lobe, d, hn::Sub(versine, deviation));
      const V far = value(lobe, d, hn::Add(versine, deviation));
      const V inverse = hn::Div(set(d, 1), deviation);
      V sum = hn::Mul(half, hn::Add(near, far));
      if (node.near_horizon) sum = hn::Add(sum, hn::Mul(bend, rounded_kink(d, versine, deviation, inverse)));
      const V difference = hn::Mul(hn::Mul(half, hn::Sub(near, far)), inverse);
      const auto add = [&](std::size_t c, V& total) HWY_ATTR {
        const V lean = hn::Add(hn::Set(d, node.lean[c]), dot(node.dipole[c]));
        total = hn::Add(total, two_points(lobe, d, hn::Set(d, node.flux[c]), lean, sum, difference, deviation));
      };
      add(0, red), add(1, green), add(2, blue);
    }
    hn::Store(red, d, &tile.sums[0][k]);
    hn::Store(green, d, &tile.sums[1][k]);
    hn::Store(blue, d, &tile.sums[2][k]);
  }
}

template <class L>
std::array<double, node_channels> evaluate_seen(const L& lobe, std::span<const SeenNodes> seen) {
  const hn::CappedTag<float, SeenNodes::most> d;
  using V = hn::Vec<decltype(d)>;
  const V half = hn::Set(d, 0.5F), zero = hn::Zero(d), bend = set(d, lobe.kink());
  alignas(64) std::array<std::array<float, SeenNodes::most>, node_channels> sums;
  for (std::size_t k = 0; k < SeenNodes::most; k += hn::Lanes(d)) {
    V red = zero, green = zero, blue = zero;
    for (const SeenNodes& s : seen) {
      const V versine = hn::Load(d, &s.versine[k]), deviation = hn::Sqrt(hn::Load(d, &s.variance[k]));
      const V near = value(lobe, d, hn::Sub(versine, deviation)), far = value(lobe, d, hn::Add(versine, deviation));
      const V inverse = hn::Div(set(d, 1), deviation);
      const V bent = hn::Mul(bend, rounded_kink(d, versine, deviation, inverse));
      const V sum = hn::Add(hn::Mul(half, hn::Add(near, far)), bent);
      const V difference = hn::Mul(hn::Mul(half, hn::Sub(near, far)), inverse);
      const auto add = [&](std::size_t c, V& total) HWY_ATTR {
        total = hn::Add(total, two_points(lobe, d, hn::Load(d, &s.flux[c][k]), hn::Load(d, &s.lean[c][k]), sum,
                                          difference, deviation));
      };
      add(0, red), add(1, green), add(2, blue);
    }
    hn::Store(red, d, &sums[0][k]);
    hn::Store(green, d, &sums[1][k]);
    hn::Store(blue, d, &sums[2][k]);
  }
  std::array<double, node_channels> totals{};
  for (std::size_t c = 0; c < node_channels; ++c)
    for (const float part : sums[c]) totals[c] += part;
  return totals;
}

void EvaluateSeen(const Lobe& lobe, std::span<const SeenNodes> seen, std::array<double, node_channels>& out) {
  std::visit([&](const auto& l) HWY_ATTR { out = evaluate_seen(l, seen); }, lobe);
}

void Evaluate(const Lobe& lobe, std::span<const TileNode> nodes, Tile& tile) {
  std::visit([&](const auto& l) HWY_ATTR { evaluate_lanes(l, nodes, tile); }, lobe);
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace envmap::prefiltering {

HWY_EXPORT(Evaluate);
HWY_EXPORT(EvaluateSeen);

namespace {

Direction times(const std::array<float, 6>& m, const Direction& v) {
  return {m[0] * v.x + m[1] * v.y + m[2] * v.z, m[1] * v.x + m[3] * v.y + m[4] * v.z,
          m[2] * v.x + m[4] * v.y + m[5] * v.z};
}

// What the variance may be at most: the a^2 of judge(). Covariances are of float32, whose rounding is more than that
// where a narrow lobe looks along the node, and would put a point into its peak.
float most_variance(const Node& node, double distance) {
  const double a = node.spread * std::min(1.0, distance + 0.5 * (node.reach + node.spread));
  return float(a * a);
}

}  // namespace

std::array<double, node_channels> evaluate(const Lobe& lobe, std::span<const SeenNodes> seen) {
  std::array<double, node_channels> found;
  HWY_DYNAMIC_DISPATCH(EvaluateSeen)(lobe, seen, found);
  return found;
}

void add_seen(const Node& node, const Direction& middle, std::size_t& count, std::vector<SeenNodes>& seen) {
  const std::size_t k = count++ % SeenNodes::most;
  if (k == 0) {
    seen.emplace_back();
    seen.back().versine.fill(3);  // Below any horizon.
    seen.back().variance.fill(least_variance(0));
  }
  SeenNodes& s = seen.back();
  const std::array<float, 6> covariance = covariance_of(node);
  const Direction at = node.centre - middle, slope = times(covariance, middle);
  s.versine[k] = float(0.5 * (glm::dot(at, at) + sag_of(covariance)));
  const float most = most_variance(node, glm::length(at));
  s.variance[k] = std::max(std::min(float(glm::dot(middle, slope)), most), least_variance(most));
  for (std::size_t c = 0; c < node_channels; ++c) {
    s.flux[c][k] = node.flux[c];
    s.lean[c][k] = float(glm::dot(Direction(node.dipole[c]), middle));
  }
}

void evaluate(const Lobe& lobe, std::span<const TileNode> nodes, Tile& tile) {
  HWY_DYNAMIC_DISPATCH(Evaluate)(lobe, nodes, tile);
}

TileNode seen_from_tile(const Node& node, const Direction& middle, double radius) {
  const std::array<float, 6> covariance = covariance_of(node);
  const Direction at = node.centre - middle, slope = times(covariance, middle);
  TileNode seen{};
  seen.sag = float(sag_of(covariance));
  seen.variance = float(glm::dot(middle, slope));
  const double far = glm::length(at) + radius;
  seen.most_variance = most_variance(node, far);
  seen.near_horizon = 0.5 * far * far + 1.74 * node.spread + 0.5 * node.spread * node.spread >= 1;
  for (std::size_t k = 0; k < 3; ++k) {
    seen.centre[k] = float(at[int(k)]);
    seen.slope[k] = float(2 * slope[int(k)]);
  }
  for (std::size_t k = 0; k < 6; ++k)
    seen.covariance[k] = (k == 0 || k == 3 || k == 5 ? 1.0F : 2.0F) * covariance[k];
  seen.flux = node.flux;
  for (std::size_t c = 0; c < node_channels; ++c) {
    const Vec3<float>& d = node.dipole[c];
    seen.lean[c] = float(glm::dot(Direction(d), middle));
    seen.dipole[c] = {d.x, d.y, d.z};
  }
  return seen;
}

}  // namespace envmap::prefiltering
#endif  // HWY_ONCE

// gather(), compiled once for every instruction set and chosen at run time.
#include "envmap/prefilter/gather.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/prefilter/gather.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "envmap/prefilter/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace envmap {
namespace HWY_NAMESPACE {

template <class Lanes>
void gather_lanes(const Lanes& lobe, std::span<const Lamp> lamps, Tile& tile) {
  const hn::CappedTag<float, Tile::most> d;
  using V = hn::Vec<decltype(d)>;
  const V half = hn::Set(d, 0.5F), zero = hn::Zero(d), tiny = hn::Set(d, 1e-30F);
  for (std::size_t k = 0; k < tile.count; k += hn::Lanes(d)) {
    const V x = hn::Load(d, &tile.x[k]), y = hn::Load(d, &tile.y[k]), z = hn::Load(d, &tile.z[k]);
    const V xx = hn::Mul(x, x), xy = hn::Mul(x, y), xz = hn::Mul(x, z);
    const V yy = hn::Mul(y, y), yz = hn::Mul(y, z), zz = hn::Mul(z, z);
    const auto dot = [&](const std::array<float, 3>& a) HWY_ATTR {
      return hn::Add(hn::Add(hn::Mul(hn::Set(d, a[0]), x), hn::Mul(hn::Set(d, a[1]), y)), hn::Mul(hn::Set(d, a[2]), z));
    };
    V red = zero, green = zero, blue = zero, white = zero;
    for (const Lamp& lamp : lamps) {
      const V ox = hn::Sub(x, hn::Set(d, lamp.centre[0])), oy = hn::Sub(y, hn::Set(d, lamp.centre[1])),
              oz = hn::Sub(z, hn::Set(d, lamp.centre[2]));
      const V square = hn::Add(hn::Add(hn::Mul(ox, ox), hn::Mul(oy, oy)), hn::Mul(oz, oz));
      const V versine = hn::Mul(half, hn::Add(square, hn::Set(d, lamp.sag)));
      const auto& m = lamp.covariance;
      const V outer =
          hn::Add(hn::Add(hn::Mul(hn::Set(d, m[0]), xx), hn::Mul(hn::Set(d, m[3]), yy)), hn::Mul(hn::Set(d, m[5]), zz));
      const V mixed =
          hn::Add(hn::Add(hn::Mul(hn::Set(d, m[1]), xy), hn::Mul(hn::Set(d, m[2]), xz)), hn::Mul(hn::Set(d, m[4]), yz));
      const V variance = hn::Add(hn::Add(hn::Set(d, lamp.variance), dot(lamp.slope)), hn::Add(outer, mixed));
      const V deviation = hn::Sqrt(hn::Max(variance, tiny));
      const V near = lobe.value(d, hn::Sub(versine, deviation));
      const V far = lobe.value(d, hn::Add(versine, deviation));
      const V sum = hn::Mul(half, hn::Add(near, far));
      const V difference = hn::Div(hn::Mul(half, hn::Sub(near, far)), deviation);
      const auto add = [&](std::size_t c, V& total) HWY_ATTR {
        const V lean = hn::Add(hn::Set(d, lamp.lean[c]), dot(lamp.dipole[c]));
        const V part = hn::Add(hn::Mul(hn::Set(d, lamp.flux[c]), sum), hn::Mul(lean, difference));
        total = hn::Add(total, hn::Max(zero, part));
      };
      add(0, red), add(1, green), add(2, blue), add(3, white);
    }
    hn::Store(red, d, &tile.sums[0][k]);
    hn::Store(green, d, &tile.sums[1][k]);
    hn::Store(blue, d, &tile.sums[2][k]);
    hn::Store(white, d, &tile.sums[3][k]);
  }
}

template <class Lanes>
std::array<double, light_channels> gather_sights(const Lanes& lobe, std::span<const Sight> sights) {
  const hn::CappedTag<float, Sight::most> d;
  using V = hn::Vec<decltype(d)>;
  const V half = hn::Set(d, 0.5F), zero = hn::Zero(d), tiny = hn::Set(d, 1e-30F);
  alignas(64) std::array<std::array<float, Sight::most>, light_channels> sums;
  for (std::size_t k = 0; k < Sight::most; k += hn::Lanes(d)) {
    V red = zero, green = zero, blue = zero, white = zero;
    for (const Sight& s : sights) {
      const V versine = hn::Load(d, &s.versine[k]), deviation = hn::Sqrt(hn::Max(hn::Load(d, &s.variance[k]), tiny));
      const V near = lobe.value(d, hn::Sub(versine, deviation)), far = lobe.value(d, hn::Add(versine, deviation));
      const V sum = hn::Mul(half, hn::Add(near, far));
      const V difference = hn::Div(hn::Mul(half, hn::Sub(near, far)), deviation);
      const auto add = [&](std::size_t c, V& total) HWY_ATTR {
        const V part = hn::Add(hn::Mul(hn::Load(d, &s.flux[c][k]), sum), hn::Mul(hn::Load(d, &s.lean[c][k]), difference));
        total = hn::Add(total, hn::Max(zero, part));
      };
      add(0, red), add(1, green), add(2, blue), add(3, white);
    }
    hn::Store(red, d, &sums[0][k]);
    hn::Store(green, d, &sums[1][k]);
    hn::Store(blue, d, &sums[2][k]);
    hn::Store(white, d, &sums[3][k]);
  }
  std::array<double, light_channels> totals{};
  for (std::size_t c = 0; c < light_channels; ++c)
    for (const float part : sums[c]) totals[c] += part;
  return totals;
}

void GatherSights(const Lobe& lobe, std::span<const Sight> sights, std::array<double, light_channels>& out) {
  std::visit([&](const auto& l) HWY_ATTR { out = gather_sights(lanes_of(l), sights); }, lobe);
}

void Gather(const Lobe& lobe, std::span<const Lamp> lamps, Tile& tile) {
  std::visit([&](const auto& l) HWY_ATTR { gather_lanes(lanes_of(l), lamps, tile); }, lobe);
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace envmap {

HWY_EXPORT(Gather);
HWY_EXPORT(GatherSights);

namespace {

Direction times(const std::array<float, 6>& m, const Direction& v) {
  return {m[0] * v.x + m[1] * v.y + m[2] * v.z, m[1] * v.x + m[3] * v.y + m[4] * v.z, m[2] * v.x + m[4] * v.y + m[5] * v.z};
}

}  // namespace

std::array<double, light_channels> gather(const Lobe& lobe, std::span<const Sight> sights) {
  std::array<double, light_channels> found;
  HWY_DYNAMIC_DISPATCH(GatherSights)(lobe, sights, found);
  return found;
}

void add_sight(const Light& light, const Direction& middle, std::size_t& count, std::vector<Sight>& sights) {
  const std::size_t k = count++ % Sight::most;
  if (k == 0) {
    sights.emplace_back();
    sights.back().versine.fill(3);  // Below any horizon.
  }
  Sight& s = sights.back();
  const Direction at = light.centre - middle, slope = times(light.covariance, middle);
  s.versine[k] = static_cast<float>(0.5 * (glm::dot(at, at) + (1 - glm::dot(light.centre, light.centre))));
  s.variance[k] = static_cast<float>(glm::dot(middle, slope));
  for (std::size_t c = 0; c < light_channels; ++c) {
    s.flux[c][k] = light.flux[c];
    s.lean[c][k] = static_cast<float>(glm::dot(Direction(light.dipole[c]), middle));
  }
}

void gather(const Lobe& lobe, std::span<const Lamp> lamps, Tile& tile) {
  HWY_DYNAMIC_DISPATCH(Gather)(lobe, lamps, tile);
}

Lamp lamp_of(const Light& light, const Direction& middle) {
  const Direction at = light.centre - middle, slope = times(light.covariance, middle);
  Lamp lamp{};
  lamp.sag = static_cast<float>(1 - glm::dot(light.centre, light.centre));
  lamp.variance = static_cast<float>(glm::dot(middle, slope));
  for (std::size_t k = 0; k < 3; ++k) {
    lamp.centre[k] = static_cast<float>(at[static_cast<int>(k)]);
    lamp.slope[k] = static_cast<float>(2 * slope[static_cast<int>(k)]);
  }
  for (std::size_t k = 0; k < 6; ++k)
    lamp.covariance[k] = (k == 0 || k == 3 || k == 5 ? 1.0F : 2.0F) * light.covariance[k];
  lamp.flux = light.flux;
  for (std::size_t c = 0; c < light_channels; ++c) {
    const Vec3<float>& d = light.dipole[c];
    lamp.lean[c] = static_cast<float>(glm::dot(Direction(d), middle));
    lamp.dipole[c] = {d.x, d.y, d.z};
  }
  return lamp;
}

}  // namespace envmap
#endif  // HWY_ONCE

// judge() and walk(), compiled once for every instruction set and chosen at run time.
#include "envmap/prefilter/quad.h"

#include <hwy/cache_control.h>

#include <cstdint>

#include "envmap/prefilter/light_tree.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/prefilter/quad.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "envmap/prefilter/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace envmap {
namespace HWY_NAMESPACE {

using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;

// Brings what is read later on its way.
template <class T>
HWY_INLINE void fetch(const T* what) {
  for (std::size_t k = 0; k < sizeof(T); k += 64) hwy::Prefetch(reinterpret_cast<const char*>(what) + k);
}

HWY_INLINE unsigned bits_of(hn::Mask<D> mask) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(D(), mask, bits);
  return (bits[0] | bits[1] * 256U) & ((1U << hn::Lanes(D())) - 1);
}

// As many as a vector has, from lane n on. @param middle what centres are counted from. @param slack what they may be off.
template <class Lanes>
HWY_INLINE void judge_lanes(const Lanes& lobe, const View& view, const Bunch& b, std::size_t n,
                            const Vec3<float>& middle, float slack, Verdict& found) {
  const D d;
  const V zero = hn::Zero(d), one = hn::Set(d, 1), half = hn::Set(d, 0.5F);
  const V x = hn::Sub(hn::Load(d, &b.centre[0][n]), hn::Set(d, middle.x)),
          y = hn::Sub(hn::Load(d, &b.centre[1][n]), hn::Set(d, middle.y)),
          z = hn::Sub(hn::Load(d, &b.centre[2][n]), hn::Set(d, middle.z));
  const V radius = hn::Set(d, static_cast<float>(view.radius) + slack), reach = hn::Load(d, &b.reach[n]);
  const V distance = hn::Sqrt(hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z)));
  const V low = hn::Max(zero, hn::Sub(hn::Sub(distance, radius), reach)), high = hn::Add(hn::Add(distance, radius), reach);
  const V near = hn::Mul(half, hn::Mul(low, low)), far = hn::Mul(half, hn::Mul(high, high));
  const auto visible = hn::Lt(near, one);
  const unsigned seen = bits_of(visible);
  found.visible |= seen << n;
  if (seen == 0) return;

  const V sine = hn::Min(one, hn::Add(hn::Add(distance, radius), hn::Mul(half, reach)));
  const V extent = hn::Mul(sine, reach);
  const auto crossing = hn::Ge(far, one);
  // Of a light that the horizon crosses, where the part begins that surely lies above it.
  const V last = hn::IfThenElse(crossing, hn::Sub(one, extent), far), end = hn::Max(near, last);
  const V at_near = lobe.value(d, near), at_end = lobe.value(d, end), at_far = hn::IfThenZeroElse(crossing, at_end);
  const V gap = hn::Sub(at_near, at_far), limit = hn::Set(d, view.limit);
  V flux = zero;
  for (std::size_t c = 0; c < light_channels; ++c)
    flux = hn::Max(flux, hn::Mul(hn::Load(d, &b.flux[c][n]), hn::Set(d, view.most[c])));
  if (view.surveying) {
    hn::Store(at_far, d, &found.least[n]);
    const auto small = hn::Lt(reach, hn::Set(d, 0.5F * static_cast<float>(view.radius)));
    found.good |= bits_of(hn::And(visible, hn::Or(small, hn::Lt(hn::Mul(gap, flux), limit)))) << n;
    return;
  }
  const V sine2 = hn::Mul(sine, sine), spread = hn::Load(d, &b.spread[n]), uneven = hn::Load(d, &b.uneven[n]);
  const V spread2 = hn::Mul(spread, spread), cube = hn::Mul(hn::Mul(hn::Mul(sine2, sine), spread2), spread);
  // Four points give the variance of the cosine but for what it has by the sphere's bend alone, seen from the middle.
  const V variance = hn::Add(hn::Mul(sine2, uneven), hn::Mul(hn::Set(d, 0.13F), hn::Mul(spread2, spread2)));
  const V second = hn::Max(lobe.second(d, near, at_near), lobe.second(d, end, at_end));
  const V third = hn::Min(hn::Set(d, 1e30F), hn::Max(lobe.third(d, near, at_near), lobe.third(d, end, at_end)));
  const V smooth = hn::Add(hn::Mul(half, hn::Mul(second, variance)), hn::Mul(hn::Set(d, 1.0F / 3), hn::Mul(third, cube)));
  // Two lights for a bent lobe are wrong by a part of what it is there.
  const V bent = hn::Mul(hn::Set(d, lobe.bend()), lobe.value(d, hn::Max(near, hn::Sub(one, hn::Add(extent, extent)))));
  const V series = hn::Add(hn::IfThenElseZero(crossing, bent), hn::IfThenElseZero(hn::Gt(last, near), smooth));
  const V error = hn::Mul(flux, hn::Min(series, hn::Mul(half, gap)));
  hn::Store(error, d, &found.error[n]);
  found.good |= bits_of(hn::And(visible, hn::Le(error, limit))) << n;
}

template <class Lanes>
HWY_INLINE Verdict judge_bunch(const Lanes& lobe, const View& view, const Bunch& lights, std::size_t count,
                               const Vec3<float>& middle, float slack) {
  Verdict found;
  for (std::size_t n = 0; n < count; n += hn::Lanes(D())) judge_lanes(lobe, view, lights, n, middle, slack, found);
  return found;
}

HWY_INLINE void copy(const Quad& from, Bunch& to, std::size_t lane) {
  const hn::CappedTag<float, 4> d;
  const auto each = [&](const Quad::Lanes& a, Bunch::Lanes& b) HWY_ATTR {
    for (std::size_t n = 0; n < 4; n += hn::Lanes(d)) hn::Store(hn::Load(d, &a[n]), d, &b[lane + n]);
  };
  for (std::size_t n = 0; n < 3; ++n) each(from.centre[n], to.centre[n]);
  each(from.reach, to.reach), each(from.spread, to.spread), each(from.uneven, to.uneven);
  for (std::size_t c = 0; c < light_channels; ++c) each(from.flux[c], to.flux[c]);
}

template <class Lanes>
void walk_lanes(const Lanes& lobe, const LightTree& tree, View& view, Walked& found) {
  constexpr float slack = 3e-7F;  // Of stored centres in float32.
  const Vec3<float> middle(view.middle);
  struct Entry {
    int k, face, i, j;  // The quad of blocks 2i, 2i + 1 and 2j, 2j + 1 of level k.
  };
  std::array<Entry, 512> stack;  // Twelve are left behind on each of at most 30 levels, and the faces.
  std::size_t count = 0;
  for (int face = faces(tree.source().projection()); face-- > 0;) stack[count++] = {tree.last(), face, 0, 0};
  Bunch bunch = Bunch::none();
  while (count > 0 && found.count <= view.most_lights) {
    // Four at a time, whatever the width of a vector: it is their order that sums depend on.
    std::array<Entry, 4> quads;
    const std::size_t several = std::min(count, quads.size());
    for (std::size_t k = 0; k < several; ++k) {
      quads[k] = stack[--count];
      copy(tree.blocks(quads[k].k).quad(quads[k].face, quads[k].i, quads[k].j), bunch, 4 * k);
    }
    const Verdict v = judge_bunch(lobe, view, bunch, 4 * several, middle, slack);
    for (std::size_t n = 4 * several; n-- > 0;) {
      const Entry& e = quads[n / 4];
      const int lane = static_cast<int>(n % 4), i = 2 * e.i + lane % 2, j = 2 * e.j + lane / 2;
      if (v.good >> n & 1) {
        if (view.surveying) {
          found.add_least(view, {bunch.flux[0][n], bunch.flux[1][n], bunch.flux[2][n], bunch.flux[3][n]}, v.least[n]);
        } else {
          found.add_error(v.error[n]);
          found.lights.push_back(&tree.blocks(e.k).light(e.face, i, j));
          fetch(found.lights.back());
        }
      } else if (v.visible >> n & 1) {
        if (e.k == tree.first()) {
          found.opened.push_back({e.face, i, j});
        } else {
          stack[count++] = {e.k - 1, e.face, i, j};
          fetch(&tree.blocks(e.k - 1).quad(e.face, i, j));
        }
      }
    }
  }
}

void Judge(const Lobe& lobe, const View& view, const Bunch& lights, std::size_t count, Verdict& out) {
  std::visit([&](const auto& l) HWY_ATTR { out = judge_bunch(lanes_of(l), view, lights, count, Vec3<float>(0), 0); }, lobe);
}
void WalkDown(const Lobe& lobe, const LightTree& tree, View& view, Walked& found) {
  std::visit([&](const auto& l) HWY_ATTR { walk_lanes(lanes_of(l), tree, view, found); }, lobe);
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace envmap {

HWY_EXPORT(Judge);
HWY_EXPORT(WalkDown);

Verdict judge(const Lobe& lobe, const View& view, const Bunch& lights, std::size_t count) {
  Verdict found;
  HWY_DYNAMIC_DISPATCH(Judge)(lobe, view, lights, count, found);
  return found;
}

void walk(const LightTree& tree, const Lobe& lobe, View& view, Walked& found) {
  found.lights.clear(), found.opened.clear();
  found.sum = found.power = 0;
  found.count = 0;
  found.got = {};
  HWY_DYNAMIC_DISPATCH(WalkDown)(lobe, tree, view, found);
}

}  // namespace envmap
#endif  // HWY_ONCE

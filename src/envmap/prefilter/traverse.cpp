// judge() and traverse(), compiled once for every instruction set and chosen at run time.
#include "envmap/prefilter/work.h"
#include "envmap/prefilter/traverse.h"

#include <hwy/cache_control.h>

#include <cstdint>

#include "envmap/prefilter/tree.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/prefilter/traverse.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "envmap/prefilter/lobe_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {

using D = hn::CappedTag<float, 16>;
using V = hn::Vec<D>;

// Prefetches an object into the cache.
template <class T>
HWY_INLINE void fetch(const T* what) {
  for (std::size_t k = 0; k < sizeof(T); k += 64) hwy::Prefetch(reinterpret_cast<const char*>(what) + k);
}

HWY_INLINE unsigned bits_of(hn::Mask<D> mask) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(D(), mask, bits);
  return (bits[0] | bits[1] * 256U) & ((1U << hn::Lanes(D())) - 1);
}

// 2^-24 is what a float may be off by; the bounds are worked out in some tens of steps.
constexpr double rounding = 1 + 1e-5;

// x from which evaluate() has the lobe itself: below, value() is held down.
HWY_INLINE V lowest(const Cosine&) { return set(D(), -1e30); }
HWY_INLINE V lowest(const Phong& l) { return set(D(), -0.69 / std::max(1e-30, l.exponent)); }
HWY_INLINE V lowest(const BlinnPhong& l) { return set(D(), -1.38 / std::max(1e-30, l.power)); }
HWY_INLINE V lowest(const Charlie&) { return set(D(), 1e-9); }
HWY_INLINE V lowest(const Ggx& l) { return set(D(), -0.5 * l.a / l.b); }

// As many as a vector has, from lane n on. @param middle what centres are counted from.
// @param slack what they may be off.
template <class L>
HWY_INLINE void judge_lanes(const L& lobe, const Criterion& criterion, const NodeGroup& b, std::size_t n,
                            const Vec3<float>& middle, float slack, Judged& found) {
  const D d;
  const V zero = hn::Zero(d), one = set(d, 1), half = set(d, 0.5);
  const V x = hn::Sub(hn::Load(d, &b.centre[0][n]), hn::Set(d, middle.x)),
          y = hn::Sub(hn::Load(d, &b.centre[1][n]), hn::Set(d, middle.y)),
          z = hn::Sub(hn::Load(d, &b.centre[2][n]), hn::Set(d, middle.z));
  const V radius = hn::Set(d, float(criterion.radius) + slack), reach = hn::Load(d, &b.reach[n]);
  const V distance = hn::Sqrt(hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z)));
  const V low = hn::Max(zero, hn::Sub(hn::Sub(distance, radius), reach)),
          high = hn::Add(hn::Add(distance, radius), reach);
  const V near = hn::Mul(half, hn::Mul(low, low)), far = hn::Mul(half, hn::Mul(high, high));
  const auto visible = hn::Lt(near, one);
  const unsigned seen = bits_of(visible);
  found.visible |= seen << n;
  if (seen == 0) return;

  const V limit = hn::Set(d, criterion.limit);
  V flux = zero;
  for (std::size_t c = 0; c < node_channels; ++c)
    flux = hn::Max(flux, hn::Mul(hn::Load(d, &b.flux[c][n]), hn::Set(d, criterion.most[c])));
  if (criterion.surveying) {
    const auto range = range_over(lobe, d, near, far);
    const V gap = hn::Sub(range.most, range.least);
    hn::Store(range.least, d, &found.least[n]);
    const auto small = hn::Lt(reach, hn::Set(d, 0.5F * float(criterion.radius)));
    found.good |= bits_of(hn::And(visible, hn::Or(small, hn::Lt(hn::Mul(gap, flux), limit)))) << n;
    return;
  }
  const V spread = hn::Load(d, &b.spread[n]), uneven = hn::Load(d, &b.uneven[n]);
  const V sine = hn::Min(one, hn::Add(distance, radius)), bend = hn::Mul(half, hn::Add(reach, spread));
  // Where X0 lies over the tile, and how far X and X0 -+ s may be from it.
  const V square = hn::Mul(half, hn::Mul(distance, distance)),
          turn = hn::Mul(radius, hn::Add(sine, hn::Mul(half, radius)));
  const V sag = hn::Mul(half, hn::Mul(spread, spread)), off = hn::Mul(reach, hn::Min(one, hn::Add(sine, reach)));
  const V lo = hn::Min(one, hn::Max(hn::Sub(near, hn::Mul(reach, reach)), hn::Sub(square, hn::Add(turn, off))));
  const V hi = hn::Add(hn::Add(square, sag), hn::Add(turn, off));
  const auto known = hn::Ge(lo, lowest(lobe));
  const V end = hn::Min(hi, one), at_lo = value(lobe, d, lo), at_hi = value(lobe, d, hi);
  const V a = hn::Mul(spread, hn::Min(one, hn::Add(sine, bend)));
  const V across = hn::Mul(bend, hn::Add(bend, hn::Mul(set(d, 4), sine)));
  const V m =
      hn::Add(hn::Min(uneven, hn::Add(hn::Mul(hn::Mul(sine, sine), uneven), hn::Mul(across, hn::Mul(spread, spread)))),
              hn::Mul(set(d, least_part), hn::Mul(a, a)));
  const auto [first, bent, twisted] = derivatives_over(lobe, d, lo, at_lo, end, at_hi);
  const V excess = hn::Sqrt(m), beyond = hn::Mul(first, excess);
  V smooth =
      hn::Add(hn::Mul(half, hn::Mul(bent, m)), hn::Mul(set(d, 1.0 / 3), hn::Mul(twisted, hn::Mul(a, hn::Mul(a, a)))));
  V any;
  if (lobe.convex()) {
    const V steep = derivatives(lobe, d, lo, at_lo).first, flat = derivatives(lobe, d, end, at_hi).first;
    const V turned = hn::Sub(steep, hn::IfThenElseZero(hn::Lt(hi, one), flat));
    const V chord = hn::Add(hn::Mul(half, hn::Mul(off, turned)), hn::Mul(steep, excess));
    any = hn::IfThenElse(known, hn::Min(at_lo, chord), at_lo);
  } else {
    smooth = hn::Add(smooth, beyond);
    const auto range = range_over(lobe, d, lo, hi);
    any = hn::Sub(range.most, range.least);
    if (!lobe.breaks_off()) {
      const V turned =
          hn::Add(hn::Mul(bent, hn::Sub(end, lo)), hn::IfThenElseZero(hn::Ge(hi, one), set(d, lobe.kink())));
      any = hn::IfThenElse(known, hn::Min(any, hn::Add(hn::Mul(a, turned), beyond)), any);
    }
  }
  // Not where a derivative is beyond what floats hold.
  const auto finite = hn::And(hn::Lt(bent, set(d, 1e36)), hn::Lt(twisted, set(d, 1e36)));
  const auto taylor = hn::And(hn::And(hn::Lt(hi, one), known), finite);
  // off is a or more, and so is hi - X0: with 0.74 a more that is 3^(1/2) s.
  const auto near_kink = hn::Ge(hn::Add(hi, hn::Mul(set(d, 0.74), a)), one);
  const V rounded = hn::IfThenElseZero(near_kink, hn::Mul(set(d, 0.0774 * lobe.kink()), a));
  const V series = hn::Add(rounded, hn::Max(zero, hn::IfThenElse(taylor, hn::Min(any, smooth), any)));
  found.bent |= bits_of(hn::Ge(series, any)) << n;
  found.crossed |= bits_of(hn::Ge(hi, one)) << n;
  const V error = hn::Mul(hn::Mul(flux, set(d, rounding)), series);
  hn::Store(error, d, &found.error[n]);
  const V unlike = hn::Mul(hn::Mul(half, bent), hn::Mul(hn::Mul(sine, sine), uneven));
  hn::Store(hn::IfThenElseZero(taylor, hn::Min(error, hn::Mul(flux, unlike))), d, &found.uneven[n]);
  found.good |= bits_of(hn::And(visible, hn::Le(error, limit))) << n;
}

template <class L>
HWY_INLINE Judged judge_group(const L& lobe, const Criterion& criterion, const NodeGroup& nodes, std::size_t count,
                              const Vec3<float>& middle, float slack) {
  Judged found;
  for (std::size_t n = 0; n < count; n += hn::Lanes(D())) judge_lanes(lobe, criterion, nodes, n, middle, slack, found);
  return found;
}

HWY_INLINE void copy(const NodeQuad& from, NodeGroup& to, std::size_t lane) {
  const hn::CappedTag<float, 4> d;
  const auto each = [&](const NodeQuad::Lanes& a, NodeGroup::Lanes& b) HWY_ATTR {
    for (std::size_t n = 0; n < 4; n += hn::Lanes(d)) hn::Store(hn::Load(d, &a[n]), d, &b[lane + n]);
  };
  for (std::size_t n = 0; n < 3; ++n) each(from.centre[n], to.centre[n]);
  each(from.reach, to.reach), each(from.spread, to.spread), each(from.uneven, to.uneven);
  for (std::size_t c = 0; c < node_channels; ++c) each(from.flux[c], to.flux[c]);
}

template <class L>
void traverse_nodes(const L& lobe, const Tree& tree, Criterion& criterion, Traversal& found) {
  constexpr float slack = 3e-7F;  // Of stored centres in float32.
  const Vec3<float> middle(criterion.middle);
  struct Entry {
    int k, face, i, j;  // The quad of blocks 2i, 2i + 1 and 2j, 2j + 1 of level k.
  };
  std::array<Entry, 512> stack;  // Twelve are left behind on each of at most 30 levels, and the faces.
  std::size_t count = 0;
  for (int face = faces(tree.source().projection()); face-- > 0;) stack[count++] = {tree.last(), face, 0, 0};
  NodeGroup group = NodeGroup::none();
  std::size_t judged = 0;
  while (count > 0 && found.count <= criterion.max_nodes) {
    // Four at a time, whatever the width of a vector: it is their order that sums depend on.
    std::array<Entry, 4> quads;
    const std::size_t several = std::min(count, quads.size());
    for (std::size_t k = 0; k < several; ++k) {
      quads[k] = stack[--count];
      copy(tree.blocks(quads[k].k).quad(quads[k].face, quads[k].i, quads[k].j), group, 4 * k);
    }
    const Judged v = judge_group(lobe, criterion, group, 4 * several, middle, slack);
    judged += 4 * several;
    for (std::size_t n = 4 * several; n-- > 0;) {
      const Entry& e = quads[n / 4];
      const int lane = int(n % 4), i = 2 * e.i + lane % 2, j = 2 * e.j + lane / 2;
      if (v.good >> n & 1) {
        if (criterion.surveying) {
          found.add_least(criterion, {group.flux[0][n], group.flux[1][n], group.flux[2][n]}, v.least[n]);
          continue;
        }
        const Node& node = tree.blocks(e.k).node(e.face, i, j);
        if (!is_uneven(v, n, criterion)) {
          found.add(node, v, n, criterion.middle);
          found.nodes.push_back(&node);
          fetch(found.nodes.back());
          continue;
        }
        if (add_channels(lobe, criterion, node, found)) continue;
      }
      if (v.visible >> n & 1) {
        if (e.k == tree.first()) {
          found.opened.push_back({e.face, i, j});
        } else {
          stack[count++] = {e.k - 1, e.face, i, j};
          fetch(&tree.blocks(e.k - 1).quad(e.face, i, j));
        }
      }
    }
  }
  envmap::prefiltering::count(Work::judged, judged);
}

void Judge(const Lobe& lobe, const Criterion& criterion, const NodeGroup& nodes, std::size_t count, Judged& out) {
  std::visit([&](const auto& l) HWY_ATTR { out = judge_group(l, criterion, nodes, count, Vec3<float>(0), 0); }, lobe);
}
void Traverse(const Lobe& lobe, const Tree& tree, Criterion& criterion, Traversal& found) {
  std::visit([&](const auto& l) HWY_ATTR { traverse_nodes(l, tree, criterion, found); }, lobe);
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace envmap::prefiltering {

HWY_EXPORT(Judge);
HWY_EXPORT(Traverse);

bool add_channels(const Lobe& lobe, const Criterion& criterion, const Node& node, Traversal& found) {
  NodeGroup group = NodeGroup::none();
  std::array<Node, node_channels> own;
  for (std::size_t c = 0; c < node_channels; ++c) {
    own[c] = channel_of(node, c);
    if (is_lit(own[c])) group.set(c, own[c], criterion.middle);
  }
  const Judged v = judge(lobe, criterion, group, node_channels);
  if ((v.visible & ~v.good) != 0) return false;
  for (std::size_t c = 0; c < node_channels; ++c) {
    if (!(v.visible >> c & 1)) continue;
    found.add(own[c], v, c, criterion.middle);
    found.channels.push_back(own[c]);
  }
  return true;
}

Judged judge(const Lobe& lobe, const Criterion& criterion, const NodeGroup& nodes, std::size_t count) {
  Judged found;
  HWY_DYNAMIC_DISPATCH(Judge)(lobe, criterion, nodes, count, found);
  return found;
}

void traverse(const Tree& tree, const Lobe& lobe, Criterion& criterion, Traversal& found) {
  const bool latlong = tree.source().projection() == Projection::latlong;
  found.clear(lobe, tree.parts() > 1, latlong && std::abs(criterion.middle.y) > near_pole);
  HWY_DYNAMIC_DISPATCH(Traverse)(lobe, tree, criterion, found);
}

}  // namespace envmap::prefiltering
#endif  // HWY_ONCE

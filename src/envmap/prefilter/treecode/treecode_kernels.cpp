// bound_nodes() and evaluate(), compiled once for every instruction set and chosen at run time.
#include "envmap/prefilter/treecode/treecode_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/prefilter/treecode/treecode_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "envmap/prefilter/treecode/lobe_bounds-inl.h"

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {

constexpr double unit_roundoff = 0x1p-24;
constexpr double unbounded = 1e30;

HWY_INLINE V load(const NodeGroup::Lanes& lanes, std::size_t n) { return hn::Load(LaneTag(), &lanes[n]); }

HWY_INLINE unsigned bits_of(hn::Mask<LaneTag> mask) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(LaneTag(), mask, bits);
  return (bits[0] | bits[1] * 256U) & ((1U << hn::Lanes(LaneTag())) - 1);
}

// ---- bounds ---------------------------------------------------------------------------------------------------------

// A node as the directions of a tile see it.
struct NodeView {
  V lo, hi;  // Range of the cosines between directions of the tile and directions of the node.
  V sine;    // Largest sine of the angle between a direction of the tile and the axis of the node.
  hn::Mask<LaneTag> visible, cut;  // Above the horizon of some direction; cut by the horizon of some direction.
};

HWY_INLINE NodeView view_of(const Tile& tile, const NodeGroup& g, std::size_t n) {
  // Rounding of the axes' floats and of the formulae below, at most.
  constexpr double slack = 2e-6, at_horizon = 1e-5;
  const LaneTag d;
  const V zero = hn::Zero(d), one = broadcast(1);
  const V x = load(g.axis[0], n) - broadcast(tile.middle.x), y = load(g.axis[1], n) - broadcast(tile.middle.y),
          z = load(g.axis[2], n) - broadcast(tile.middle.z);
  const V cosine = one - broadcast(0.5) * (x * x + y * y + z * z);
  // The cosine has lost the digits of the sine of a small angle, and of an angle near 180 degrees: the sine comes from
  // the distance to the axis, or to its opposite.
  const auto behind = hn::Lt(cosine, zero);
  const auto twice = [&](double middle) HWY_ATTR { return hn::IfThenElseZero(behind, broadcast(2 * middle)); };
  const V near_x = x + twice(tile.middle.x), near_y = y + twice(tile.middle.y), near_z = z + twice(tile.middle.z);
  const V versine = broadcast(0.5) * (near_x * near_x + near_y * near_y + near_z * near_z);
  const V sine = hn::Sqrt(hn::Max(zero, versine * (broadcast(2) - versine)));
  const V tile_cosine = broadcast(tile.cosine), tile_sine = broadcast(tile.sine);
  const V node_cosine = load(g.cosine, n), node_sine = load(g.sine, n);
  // The sum of the angles of tile and node. Where it is about a right angle or more, all cosines may occur.
  const V both_cosine = node_cosine * tile_cosine - node_sine * tile_sine;
  const V both_sine = node_sine * tile_cosine + node_cosine * tile_sine;
  const auto wide = hn::Or(hn::Lt(node_cosine, zero), hn::Lt(both_cosine, broadcast(0.02)));
  const auto around = hn::Or(wide, hn::Le(both_cosine, cosine));
  const auto opposite = hn::Or(wide, hn::Le(cosine, zero - both_cosine));
  NodeView s;
  s.hi = hn::IfThenElse(around, one, hn::Min(one, cosine * both_cosine + sine * both_sine + broadcast(slack)));
  s.lo = hn::IfThenElse(opposite, zero - one,
                        hn::Max(zero - one, cosine * both_cosine - sine * both_sine - broadcast(slack)));
  const V height = hn::Abs(cosine), most = sine * tile_cosine + height * tile_sine + broadcast(slack);
  s.sine = hn::IfThenElse(hn::Le(height, tile_sine), one, hn::Min(one, most));
  V flux = zero;
  for (std::size_t c = 0; c < channels; ++c) flux += load(g.flux[c], n);
  s.visible = hn::And(hn::Gt(flux, zero), hn::Gt(s.hi, zero));
  s.cut = hn::Lt(s.lo, broadcast(at_horizon));
  return s;
}

// The bounds of the theorem's integrals, per unit of flux.
struct Offsets {
  V t2, t4, cube;  // Bounds of E2^(1/2), E4^(1/4) and |integral of t^3|.
  V away;          // Bound of (E |d - c|^2)^(1/2).
};
HWY_INLINE Offsets offsets(const NodeGroup& g, std::size_t n, V s) {
  const V tangent2 = load(g.tangent2, n), tangent4 = load(g.tangent4, n), tangent3 = load(g.tangent3, n);
  const V radial2 = load(g.radial2, n), radial4 = load(g.radial4, n), radial44 = radial4 * radial4;
  const V three = broadcast(3);
  return {s * tangent2 + radial2, s * tangent4 + radial4,
          s * s * (s * tangent3 + three * tangent4 * tangent4 * radial2) + (three * s * tangent2 + radial2) * radial44,
          broadcast(1.5) * tangent2 + radial2};
}

// Rounding of evaluate() per unit of flux, at most: some 40 operations on a term of at most size0 + size1 t2 + size2
// t2^2, the lobe's power of two, the cosine, and the floats of moments and directions, whose products may be far
// smaller than themselves.
HWY_INLINE V rounding(double of_power, const Bounds& b, const Offsets& o, const NodeView& s, const Tile& tile) {
  const V terms = b.size0 + o.t2 * (b.size1 + o.t2 * b.size2);
  // |r - a|^2 / 2 of floats: relative to itself, and to the products of its parts.
  const V versine = broadcast(1) - s.lo, of_cosine = versine + broadcast(2 * tile.sine) * hn::Sqrt(versine);
  const V products = o.away * (b.size1 + o.away * b.size2);
  return broadcast(40 * unit_roundoff + of_power) * terms + broadcast(12 * unit_roundoff) * products +
         broadcast(moment_loss) * (b.size1 + b.size2) +
         broadcast(16 * unit_roundoff) * of_cosine * (b.size1 + o.t2 * b.size2);
}

// Bound of K + K' t for Phong's lobe of exponent below 2, whose slope has no bounded derivative at the horizon: k t2^m.
HWY_INLINE V rest_of_linear(const Phong& l, V t2) {
  const LaneTag d;
  if (l.exponent >= 2) return broadcast(unbounded);
  const V y = hn::Min(t2, broadcast(1.9));
  return broadcast(l.scale()) * exp2_small(d, broadcast(l.exponent) * log2_of(d, y, broadcast(1) - y));
}
template <class L>
HWY_INLINE V rest_of_linear(const L& /*of*/, V /*t2*/) {
  return broadcast(unbounded);
}

// The least of the theorem's three bounds of the rest. Where the horizon cuts the node, a bound holds only if its
// derivative is bounded there. @param smooth see TreecodeLobe.
HWY_INLINE V rest_of_series(const Bounds& b, const Offsets& o, int smooth, hn::Mask<LaneTag> cut) {
  const V t22 = o.t2 * o.t2, t44 = o.t4 * o.t4, sixth = broadcast(1.0 / 6), none = broadcast(unbounded);
  const V third = hn::Min(b.third, none), fourth = hn::Min(b.fourth, none);
  const auto held = [&](V bound, int order)
                        HWY_ATTR { return smooth >= order ? bound : hn::IfThenElse(cut, none, bound); };
  const V by_second = broadcast(0.5) * hn::Min(b.osc2, none) * t22;
  const V by_third = sixth * third * o.t2 * t44;
  const V by_fourth = sixth * third * o.cube + broadcast(1.0 / 24) * fourth * t44 * t44;
  return hn::Min(held(by_second, 2), hn::Min(held(by_third, 3), held(by_fourth, 4)));
}

template <class L>
void bound_lanes(const L& of, const TreecodeLobe& lobe, const Tile& tile, const NodeGroup& g, NodeBounds& out) {
  const LaneTag d;
  const Rest<L> rest(of);
  const V zero = hn::Zero(d), half = broadcast(0.5);
  const double of_power = power_rounding(of);
  out.visible = 0;
  for (std::size_t n = 0; n < 16; n += hn::Lanes(d)) {
    const NodeView s = view_of(tile, g, n);
    const unsigned visible = bits_of(s.visible);
    out.visible |= visible << n;
    if (visible == 0) continue;
    const Bounds b = rest.over(hn::Max(s.lo, zero), hn::Max(s.hi, zero), s.cut);
    const Offsets o = offsets(g, n, s.sine);
    const V rounded = rounding(of_power, b, o, s, tile);
    const V taylor = padded(rest_of_series(b, o, lobe.smooth, s.cut)) + rounded;
    const V linear = padded(rest_of_linear(of, o.t2)) + rounded;
    const V constant = padded(half * (b.most - b.least)) + broadcast(40 * unit_roundoff + of_power) * b.size0;
    const V best = hn::Min(hn::Min(taylor, linear), constant);
    hn::Store(best, d, &out.bound[n]);
    hn::Store(half * (b.most + b.least), d, &out.constant[n]);
    hn::Store(b.line, d, &out.line[n]);
    const unsigned is_taylor = bits_of(hn::Le(taylor, best)), is_linear = bits_of(hn::Le(linear, best));
    for (std::size_t k = 0; k < hn::Lanes(d); ++k)
      out.form[n + k] = is_taylor >> k & 1 ? Form::taylor : is_linear >> k & 1 ? Form::linear : Form::constant;
  }
}

// ---- sums -----------------------------------------------------------------------------------------------------------

// A node in coordinates about the middle of a tile.
struct TileNode {
  std::array<float, 3> axis;  // The axis less the middle of the tile.
  float length, sag;
  const TreeNode* node;
  float constant, line;
};

// Directions r in lanes.
struct Lanes {
  V x, y, z;     // r less the middle of the tile.
  V rx, ry, rz;  // r itself.
};

HWY_INLINE V dot(const std::array<float, 3>& a, const Lanes& l) {
  return broadcast(a[0]) * l.rx + broadcast(a[1]) * l.ry + broadcast(a[2]) * l.rz;
}
HWY_INLINE V square_form(const std::array<float, 6>& s, const Lanes& l) {
  const V along_x = broadcast(s[0]) * l.rx + broadcast(2 * s[1]) * l.ry + broadcast(2 * s[2]) * l.rz;
  const V along_y = broadcast(s[3]) * l.ry + broadcast(2 * s[4]) * l.rz;
  return along_x * l.rx + along_y * l.ry + broadcast(s[5]) * l.rz * l.rz;
}

// 1 - r.c, with the digits of small angles.
HWY_INLINE V versine(const TileNode& n, const Lanes& l) {
  const V x = l.x - broadcast(n.axis[0]), y = l.y - broadcast(n.axis[1]), z = l.z - broadcast(n.axis[2]);
  return broadcast(n.sag) + broadcast(0.5F * n.length) * (x * x + y * y + z * z);
}

// A sum of floats with its rounding error (Knuth 1997, The Art of Computer Programming 2, 4.2.2, theorem B).
struct LongSum {
  V high, low;
  HWY_INLINE void add(V x) {
    const V sum = high + x, back = sum - high;
    low += (high - (sum - back)) + (x - back);
    high = sum;
  }
};

template <Form form, class R>
HWY_INLINE void add_node(const R& rest, const TileNode& n, const Lanes& l, V (&sums)[channels]) {
  const LaneTag d;
  const V x = versine(n, l);
  Taylor k;
  if constexpr (form == Form::constant)
    k = {broadcast(n.constant) - broadcast(n.line) * (broadcast(1) - x), broadcast(-n.line), hn::Zero(d)};
  else
    k = rest.taylor(x);
  const TreeNode& node = *n.node;
  for (std::size_t c = 0; c < channels; ++c) {
    sums[c] += broadcast(node.flux[c]) * k.value + k.slope * dot(node.first[c], l);
    if constexpr (form == Form::taylor) sums[c] += k.bend * square_form(node.second[c], l);
  }
}

template <Form form, class R>
void add_nodes(const R& rest, std::span<const Accepted> nodes, const Tile& tile, TileSums& out) {
  constexpr std::size_t at_once = 8;  // Terms of a plain float sum, before it goes to a LongSum.
  const LaneTag d;
  thread_local std::vector<TileNode> seen;
  seen.clear();
  for (const Accepted& a : nodes) {
    const Direction from(a.node->axis - tile.middle);
    seen.push_back(
        {{float(from.x), float(from.y), float(from.z)}, 1 - a.node->sag, a.node->sag, a.node, a.constant, a.line});
  }
  for (std::size_t k = 0; k < tile.count; k += hn::Lanes(d)) {
    Lanes l{hn::Load(d, &tile.x[k]), hn::Load(d, &tile.y[k]), hn::Load(d, &tile.z[k]), {}, {}, {}};
    l.rx = l.x + broadcast(tile.middle.x), l.ry = l.y + broadcast(tile.middle.y), l.rz = l.z + broadcast(tile.middle.z);
    LongSum sums[channels] = {{hn::Zero(d), hn::Zero(d)}, {hn::Zero(d), hn::Zero(d)}, {hn::Zero(d), hn::Zero(d)}};
    for (std::size_t from = 0; from < seen.size(); from += at_once) {
      V part[channels] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
      for (std::size_t n = from; n < std::min(from + at_once, seen.size()); ++n) add_node<form>(rest, seen[n], l, part);
      for (std::size_t c = 0; c < channels; ++c) sums[c].add(part[c]);
    }
    for (std::size_t c = 0; c < channels; ++c) {
      alignas(64) std::array<float, 16> high, low;
      hn::Store(sums[c].high, d, high.data()), hn::Store(sums[c].low, d, low.data());
      for (std::size_t n = 0; n < hn::Lanes(d); ++n) out[c][k + n] += double(high[n]) + double(low[n]);
    }
  }
}

template <class L>
void evaluate_lanes(const L& of, const NodeSums& nodes, const Tile& tile, TileSums& out) {
  const Rest<L> rest(of);
  for (auto& sums : out) sums.fill(0);
  add_nodes<Form::taylor>(rest, nodes.of(Form::taylor), tile, out);
  add_nodes<Form::linear>(rest, nodes.of(Form::linear), tile, out);
  add_nodes<Form::constant>(rest, nodes.of(Form::constant), tile, out);
}

void BoundNodes(const TreecodeLobe& lobe, const Tile& tile, const NodeGroup& nodes, NodeBounds& out) {
  std::visit(
      [&](const auto& l) {
        if constexpr (!std::is_same_v<decltype(l), const Cosine&>) bound_lanes(l, lobe, tile, nodes, out);
      },
      lobe.lobe);
}
void Evaluate(const TreecodeLobe& lobe, const NodeSums& nodes, const Tile& tile, TileSums& out) {
  std::visit(
      [&](const auto& l) {
        if constexpr (!std::is_same_v<decltype(l), const Cosine&>) evaluate_lanes(l, nodes, tile, out);
      },
      lobe.lobe);
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace envmap::prefiltering {

HWY_EXPORT(BoundNodes);
HWY_EXPORT(Evaluate);

void bound_nodes(const TreecodeLobe& lobe, const Tile& tile, const NodeGroup& nodes, NodeBounds& out) {
  HWY_DYNAMIC_DISPATCH(BoundNodes)(lobe, tile, nodes, out);
}
void evaluate(const TreecodeLobe& lobe, const NodeSums& nodes, const Tile& tile, TileSums& out) {
  HWY_DYNAMIC_DISPATCH(Evaluate)(lobe, nodes, tile, out);
}

Tile::Tile(std::span<const Direction> directions) : count(directions.size()) {
  Direction sum(0);
  for (const Direction& r : directions) sum += r;
  const double length = glm::length(sum);
  middle = count > 1 && length > 0.1 ? sum / length : directions[0];
  double square = 0;
  for (std::size_t k = 0; k < most; ++k) {
    const Direction o = directions[std::min(k, count - 1)] - middle;
    x[k] = float(o.x), y[k] = float(o.y), z[k] = float(o.z);
    square = std::max(square, glm::dot(o, o));
  }
  cosine = std::max(-1.0, 1 - 0.5 * square);
  sine = std::sqrt(std::max(0.0, square - 0.25 * square * square)) * (1 + 1e-6);
}

}  // namespace envmap::prefiltering
#endif  // HWY_ONCE

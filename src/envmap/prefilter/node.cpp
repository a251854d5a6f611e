// unite(), compiled once for every instruction set and chosen at run time.
#include "envmap/prefilter/node.h"

#include <type_traits>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/prefilter/node.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, batch_size>;
using V = hn::Vec<D>;

HWY_INLINE V load(const Lanes& from, std::size_t k) { return hn::Load(D(), &from[k]); }
HWY_INLINE V over(V a, V b) { return hn::IfThenElseZero(hn::Gt(b, hn::Zero(D())), hn::Div(a, b)); }

HWY_INLINE V weighted(V red, V green, V blue) {
  return hn::Mul(hn::Set(D(), 1.0F / 3), hn::Add(hn::Add(red, green), blue));
}

// Cube root, of 0 to 1e30, 1e-6 above: Newton's steps from a third of the exponent.
HWY_INLINE V cube_root(V a) {
  const D d;
  const hn::RebindToSigned<D> di;
  const V third = hn::Set(d, 1.0F / 3);
  const auto guess = hn::ConvertTo(di, hn::Mul(hn::ConvertTo(d, hn::BitCast(di, a)), third));
  V y = hn::BitCast(d, hn::Add(guess, hn::Set(di, 0x2a514067)));
  for (int step = 0; step < 3; ++step) y = hn::Mul(third, hn::Add(hn::Add(y, y), hn::Div(a, hn::Mul(y, y))));
  return hn::IfThenElseZero(hn::Gt(a, hn::Set(d, 1e-36F)), hn::Mul(y, hn::Set(d, 1 + 1e-6F)));
}

HWY_INLINE V spread_of(const TexelBatch& t, std::size_t k) { return load(t.row->spread, k); }
HWY_INLINE V spread_of(const NodeBatch& n, std::size_t k) { return load(n.spread, k); }
HWY_INLINE V reach_of(const TexelBatch& t, std::size_t k) { return load(t.row->reach, k); }
HWY_INLINE V reach_of(const NodeBatch& n, std::size_t k) { return load(n.reach, k); }
HWY_INLINE V second_of(const TexelBatch& t, std::size_t /*c*/, std::size_t n, std::size_t k) {
  return load(t.row->covariance[n], k);
}
HWY_INLINE V second_of(const NodeBatch& b, std::size_t c, std::size_t n, std::size_t k) {
  return load(b.second[c][n], k);
}

struct Offset {
  V at[3], product[6];
};
template <class Part>
HWY_INLINE Offset offset(const Part& part, const NodeBatch& whole, std::size_t k) {
  Offset o;
  for (std::size_t n = 0; n < 3; ++n) o.at[n] = hn::Sub(load(part.centre[n], k), load(whole.centre[n], k));
  std::size_t to = 0;
  for (std::size_t m = 0; m < 3; ++m)
    for (std::size_t n = m; n < 3; ++n) o.product[to++] = hn::Mul(o.at[m], o.at[n]);
  return o;
}

// Flux and mean place.
template <class Part>
HWY_INLINE V middle(std::span<const Part> parts, NodeBatch& whole, std::size_t k) {
  const D d;
  V weight = hn::Zero(d), x = weight, y = weight, z = weight;
  V flux[node_channels] = {weight, weight, weight};
  for (const Part& p : parts) {
    V f[node_channels];
    for (std::size_t c = 0; c < node_channels; ++c) f[c] = load(p.flux[c], k), flux[c] = hn::Add(flux[c], f[c]);
    const V w = weighted(f[0], f[1], f[2]);
    weight = hn::Add(weight, w);
    x = hn::Add(x, hn::Mul(w, load(p.centre[0], k)));
    y = hn::Add(y, hn::Mul(w, load(p.centre[1], k)));
    z = hn::Add(z, hn::Mul(w, load(p.centre[2], k)));
  }
  for (std::size_t c = 0; c < node_channels; ++c) hn::Store(flux[c], d, &whole.flux[c][k]);
  hn::Store(over(x, weight), d, &whole.centre[0][k]);
  hn::Store(over(y, weight), d, &whole.centre[1][k]);
  hn::Store(over(z, weight), d, &whole.centre[2][k]);
  return weight;
}

// One channel's moments about the mean place of all. @param second set to its second moment x flux.
// @param cube flux x |offset|^3.
template <class Part>
HWY_INLINE void moments(std::span<const Part> parts, NodeBatch& whole, std::size_t c, std::size_t k, V (&second)[6],
                        V& cube) {
  const D d;
  V dipole[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  for (V& s : second) s = hn::Zero(d);
  cube = hn::Zero(d);
  for (const Part& p : parts) {
    const Offset o = offset(p, whole, k);
    const V f = load(p.flux[c], k), distance = hn::Sqrt(hn::Add(hn::Add(o.product[0], o.product[3]), o.product[5]));
    const V far = hn::Add(distance, spread_of(p, k));
    cube = hn::Add(cube, hn::Mul(f, hn::Mul(far, hn::Mul(far, far))));
    for (std::size_t n = 0; n < 3; ++n) dipole[n] = hn::Add(dipole[n], hn::Mul(f, o.at[n]));
    for (std::size_t n = 0; n < 6; ++n)
      second[n] = hn::Add(second[n], hn::Mul(f, hn::Add(o.product[n], second_of(p, c, n, k))));
    if constexpr (std::is_same_v<Part, NodeBatch>) {
      V own[3];
      for (std::size_t n = 0; n < 3; ++n) own[n] = load(p.dipole[c][n], k), dipole[n] = hn::Add(dipole[n], own[n]);
      std::size_t to = 0;
      for (std::size_t m = 0; m < 3; ++m)
        for (std::size_t n = m; n < 3; ++n, ++to)
          second[to] = hn::Add(second[to], hn::Add(hn::Mul(o.at[m], own[n]), hn::Mul(o.at[n], own[m])));
    }
  }
  for (std::size_t n = 0; n < 3; ++n) hn::Store(dipole[n], d, &whole.dipole[c][n][k]);
}

template <class Part>
HWY_INLINE V reach_of_all(std::span<const Part> parts, const NodeBatch& whole, std::size_t k) {
  const D d;
  V reach = hn::Zero(d);
  for (const Part& p : parts) {
    const Offset o = offset(p, whole, k);
    const V distance = hn::Sqrt(hn::Add(hn::Add(o.product[0], o.product[3]), o.product[5]));
    const auto counts = hn::Gt(weighted(load(p.flux[0], k), load(p.flux[1], k), load(p.flux[2], k)), hn::Zero(d));
    reach = hn::Max(reach, hn::IfThenElseZero(counts, hn::Add(distance, reach_of(p, k))));
  }
  return reach;
}

template <class Part>
void unite_lanes(std::span<const Part> parts, NodeBatch& whole) {
  const D d;
  for (std::size_t k = 0; k < batch_size; k += hn::Lanes(d)) {
    const V weight = middle(parts, whole, k);
    V second[node_channels][6], cube[node_channels];
    for (std::size_t c = 0; c < node_channels; ++c) moments(parts, whole, c, k, second[c], cube[c]);
    V covariance[6];
    for (std::size_t n = 0; n < 6; ++n)
      covariance[n] = over(weighted(second[0][n], second[1][n], second[2][n]), weight);
    V most_uneven = hn::Zero(d), max_cube = hn::Zero(d);
    for (std::size_t c = 0; c < node_channels; ++c) {
      const V flux = load(whole.flux[c], k);
      V square = hn::Zero(d);
      for (std::size_t n = 0; n < 6; ++n) {
        const V own = over(second[c][n], flux), off = hn::Sub(own, covariance[n]), both = hn::Mul(off, off);
        hn::Store(own, d, &whole.second[c][n][k]);
        square = hn::Add(square, n == 0 || n == 3 || n == 5 ? both : hn::Add(both, both));
      }
      most_uneven = hn::Max(most_uneven, hn::IfThenElseZero(hn::Gt(flux, hn::Zero(d)), hn::Sqrt(square)));
      max_cube = hn::Max(max_cube, over(cube[c], flux));
    }
    hn::Store(most_uneven, d, &whole.uneven[k]);
    hn::Store(cube_root(max_cube), d, &whole.spread[k]);
    hn::Store(reach_of_all(parts, whole, k), d, &whole.reach[k]);
  }
}

void UniteTexels(std::span<const TexelBatch> parts, NodeBatch& whole) { unite_lanes(parts, whole); }
void UniteLights(std::span<const NodeBatch> parts, NodeBatch& whole) { unite_lanes(parts, whole); }

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace envmap::prefiltering {

HWY_EXPORT(UniteTexels);
HWY_EXPORT(UniteLights);

void unite(std::span<const TexelBatch> parts, NodeBatch& whole) { HWY_DYNAMIC_DISPATCH(UniteTexels)(parts, whole); }
void unite(std::span<const NodeBatch> parts, NodeBatch& whole) { HWY_DYNAMIC_DISPATCH(UniteLights)(parts, whole); }

Node node_of(const Moments& patch, const Flux& radiance) {
  const double w = patch.solid_angle;
  Node node{.centre = patch.centre,
            .flux = {float(w * radiance.x), float(w * radiance.y), float(w * radiance.z)},
            .spread = float(patch.spread),
            .reach = float(patch.reach)};
  for (auto& second : node.second)
    for (std::size_t n = 0; n < 6; ++n) second[n] = float(patch.covariance.m[n]);
  return node;
}

std::array<float, 6> covariance_of(const Node& node) {
  const float whole = node.flux[0] + node.flux[1] + node.flux[2];
  std::array<float, 6> found{};
  for (std::size_t c = 0; c < node_channels && whole > 0; ++c)
    for (std::size_t n = 0; n < 6; ++n) found[n] += node.flux[c] / whole * node.second[c][n];
  return found;
}

Node channel_of(const Node& node, std::size_t channel) {
  if (!(node.flux[channel] > 0)) return {};
  const Vec3<float> d = node.dipole[channel] / node.flux[channel];
  const float apart = glm::length(d) * (1 + 1e-6F);
  Node own{.centre = node.centre + Direction(d), .spread = node.spread + apart, .reach = node.reach + apart};
  own.flux[channel] = node.flux[channel];
  own.second[channel] = node.second[channel];
  std::size_t to = 0;
  for (int m = 0; m < 3; ++m)
    for (int n = m; n < 3; ++n) own.second[channel][to++] -= d[m] * d[n];
  return own;
}

// Sixteen neighbours a lane, until one is left.
Node united(std::span<const Node> parts) {
  if (parts.empty()) return {};
  constexpr std::size_t each = 16;
  thread_local std::vector<NodeBatch> lanes(each);
  thread_local std::vector<Node> rest;
  rest.assign(parts.begin(), parts.end());
  const Direction origin = parts[0].centre;
  while (rest.size() > 1) {
    const std::size_t count = (rest.size() + each - 1) / each;
    for (std::size_t start = 0; start < count; start += batch_size) {
      std::ranges::fill(lanes, NodeBatch{});
      const std::size_t end = std::min(count, start + batch_size);
      for (std::size_t k = start * each; k < std::min(end * each, rest.size()); ++k)
        lanes[k % each].set(k / each - start, rest[k], origin);
      NodeBatch whole;
      unite(lanes, whole);
      for (std::size_t k = start; k < end; ++k) rest[k] = whole.node(k - start, origin);
    }
    rest.resize(count);
  }
  return rest[0];
}

void ShapeBatch::set(std::size_t lane, const Moments& patch) {
  for (std::size_t n = 0; n < 6; ++n) covariance[n][lane] = float(patch.covariance.m[n]);
  spread[lane] = float(patch.spread), reach[lane] = float(patch.reach);
}

void TexelBatch::set(std::size_t lane, const Direction& offset, double solid_angle, const Flux& radiance) {
  for (std::size_t n = 0; n < 3; ++n) {
    centre[n][lane] = float(offset[int(n)]);
    flux[n][lane] = float(solid_angle * radiance[int(n)]);
  }
}

void NodeBatch::set(std::size_t lane, const Node& node, const Direction& origin) {
  const Vec3<float> at(node.centre - origin);
  for (std::size_t n = 0; n < 3; ++n) centre[n][lane] = at[int(n)];
  for (std::size_t c = 0; c < node_channels; ++c) {
    flux[c][lane] = node.flux[c];
    for (std::size_t n = 0; n < 3; ++n) dipole[c][n][lane] = node.dipole[c][int(n)];
    for (std::size_t n = 0; n < 6; ++n) second[c][n][lane] = node.second[c][n];
  }
  uneven[lane] = node.uneven, spread[lane] = node.spread, reach[lane] = node.reach;
}

Node NodeBatch::node(std::size_t lane, const Direction& origin) const {
  Node node{.centre = origin + Direction(centre[0][lane], centre[1][lane], centre[2][lane]),
            .uneven = uneven[lane],
            .spread = spread[lane],
            .reach = reach[lane]};
  for (std::size_t c = 0; c < node_channels; ++c) {
    node.flux[c] = flux[c][lane];
    node.dipole[c] = {dipole[c][0][lane], dipole[c][1][lane], dipole[c][2][lane]};
    for (std::size_t n = 0; n < 6; ++n) node.second[c][n] = second[c][n][lane];
  }
  return node;
}

}  // namespace envmap::prefiltering
#endif  // HWY_ONCE

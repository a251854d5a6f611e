// The span functions of projection.h, compiled once for every instruction set and chosen at run time.
#include <algorithm>
#include <array>

#include "envmap/projection/projection.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/projection/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "envmap/projection/lanes-inl.h"

static_assert(sizeof(envmap::Direction) == 3 * sizeof(double));

HWY_BEFORE_NAMESPACE();
namespace envmap {
namespace HWY_NAMESPACE {

using Lanes = hn::ScalableTag<double>;

// Loads `count` directions; beyond them lie others, +Z.
template <class D, class V>
HWY_INLINE void load(D d, const Direction* from, std::size_t count, V& x, V& y, V& z) {
  if (count >= hn::Lanes(d)) {
    hn::LoadInterleaved3(d, &from->x, x, y, z);
  } else {
    std::array<Direction, hn::MaxLanes(D())> all;
    std::fill(std::copy_n(from, count, all.begin()), all.end(), Direction(0, 0, 1));
    hn::LoadInterleaved3(d, &all.front().x, x, y, z);
  }
}

template <class D, class V>
HWY_INLINE void store(D d, V x, V y, V z, Direction* to, std::size_t count) {
  if (count >= hn::Lanes(d)) {
    hn::StoreInterleaved3(x, y, z, d, &to->x);
  } else {
    std::array<Direction, hn::MaxLanes(D())> all;
    hn::StoreInterleaved3(x, y, z, d, &all.front().x);
    std::copy_n(all.begin(), count, to);
  }
}

// The texels of a disc whose centres lie outside it, by a point inside: half way between the innermost corner and the
// rim. a and b are whole numbers, so the comparison is exact.
template <class D, class V>
HWY_INLINE void move_inside_rim(D d, const Scale& scale, V& a, V& b) {
  const V one = hn::Set(d, 1), zero = hn::Zero(d);
  const auto outside = hn::Ge(hn::Add(hn::Mul(a, a), hn::Mul(b, b)), hn::Set(d, scale.square));
  if (hn::AllFalse(d, outside)) return;
  const V ca = hn::CopySign(hn::Max(zero, hn::Sub(hn::Abs(a), one)), a);
  const V cb = hn::CopySign(hn::Max(zero, hn::Sub(hn::Abs(b), one)), b);
  const V r = hn::Max(hn::Sqrt(hn::Add(hn::Mul(ca, ca), hn::Mul(cb, cb))), hn::Set(d, 1e-300));
  const V outwards = hn::Div(hn::Mul(hn::Set(d, 0.5), hn::Add(hn::Set(d, scale.n), r)), r);
  a = hn::IfThenElse(outside, hn::Mul(ca, outwards), a);
  b = hn::IfThenElse(outside, hn::Mul(cb, outwards), b);
}

void TexelDirections(Projection p, int size, int face, int row, int first, std::span<Direction> out) {
  visit(p, [&](auto q) HWY_ATTR {
    using P = decltype(q);
    const Lanes d;
    const Scale scale(size);
    const auto b = hn::Set(d, size - 1.0 - 2.0 * row);
    const double left = 2.0 * first + 1 - size * P::aspect;
    for (std::size_t k = 0; k < out.size(); k += hn::Lanes(d)) {
      const auto column = hn::Add(hn::Set(d, left + 2 * static_cast<double>(k)), hn::Mul(hn::Iota(d, 0), hn::Set(d, 2)));
      auto a = hn::Mul(column, hn::Set(d, 1.0 / P::aspect)), at_b = b;
      if constexpr (P::on_disc && !P::filled) move_inside_rim(d, scale, a, at_b);
      hn::Vec<Lanes> x, y, z;
      direction(q, d, scale, face, a, at_b, x, y, z);
      store(d, x, y, z, &out[k], out.size() - k);
    }
  });
}

void Directions(Projection p, int face, std::span<const Vec2<double>> points, std::span<Direction> out) {
  visit(p, [&](auto q) HWY_ATTR {
    const Lanes d;
    const std::size_t lanes = hn::Lanes(d);
    const Scale scale(1);
    const auto one = hn::Set(d, 1), two = hn::Set(d, 2);
    for (std::size_t k = 0; k < points.size(); k += lanes) {
      const std::size_t count = std::min(lanes, points.size() - k);
      std::array<Vec2<double>, hn::MaxLanes(Lanes())> all;
      const bool whole = count == lanes;
      if (!whole) std::fill(std::copy_n(&points[k], count, all.begin()), all.end(), Vec2<double>(0.5));
      hn::Vec<Lanes> u, v, x, y, z;
      hn::LoadInterleaved2(d, whole ? &points[k].x : &all.front().x, u, v);
      direction(q, d, scale, face, hn::Sub(hn::Mul(two, u), one), hn::Sub(one, hn::Mul(two, v)), x, y, z);
      store(d, x, y, z, &out[k], count);
    }
  });
}

void Locate(Projection p, std::span<const Direction> directions, std::span<Location<double>> out) {
  visit(p, [&](auto q) HWY_ATTR {
    const Lanes d;
    const std::size_t lanes = hn::Lanes(d);
    HWY_ALIGN double us[hn::MaxLanes(Lanes())], vs[hn::MaxLanes(Lanes())];
    HWY_ALIGN std::int32_t faces[hn::MaxLanes(Lanes())];
    const hn::Rebind<std::int32_t, Lanes> di;
    for (std::size_t k = 0; k < directions.size(); k += lanes) {
      const std::size_t count = std::min(lanes, directions.size() - k);
      hn::Vec<Lanes> x, y, z, face, u, v;
      load(d, &directions[k], count, x, y, z);
      locate(q, d, x, y, z, face, u, v);
      hn::Store(u, d, us);
      hn::Store(v, d, vs);
      hn::Store(hn::DemoteTo(di, face), di, faces);
      for (std::size_t i = 0; i < count; ++i) out[k + i] = {faces[i], us[i], vs[i]};
    }
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace envmap {

HWY_EXPORT(TexelDirections);
HWY_EXPORT(Directions);
HWY_EXPORT(Locate);

void texel_directions(Projection p, int size, int face, int row, int first, std::span<Direction> out) {
  HWY_DYNAMIC_DISPATCH(TexelDirections)(p, size, face, row, first, out);
}

void directions(Projection p, int face, std::span<const Vec2<double>> points, std::span<Direction> out) {
  HWY_DYNAMIC_DISPATCH(Directions)(p, face, points, out);
}

void locate(Projection p, std::span<const Direction> directions, std::span<Location<double>> out) {
  HWY_DYNAMIC_DISPATCH(Locate)(p, directions, out);
}

}  // namespace envmap
#endif  // HWY_ONCE

// The span functions of projection.h, compiled once for every instruction set and chosen at run time.
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <vector>

#include "envmap/base/bounds.h"
#include "envmap/base/check_length.h"
#include "envmap/maths/check_direction.h"
#include "envmap/projection/projection.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/projection/kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "envmap/projection/lanes-inl.h"

// What is loaded and stored as threes of doubles.
static_assert(sizeof(envmap::Direction) == 3 * sizeof(double));
static_assert(sizeof(envmap::Location<double>) == 3 * sizeof(double) && offsetof(envmap::Location<double>, u) == 8 &&
              offsetof(envmap::Location<double>, v) == 16 && std::endian::native == std::endian::little);

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
    const auto steps = hn::Mul(hn::Iota(d, 0), hn::Set(d, 2));
    for (std::size_t k = 0; k < out.size(); k += hn::Lanes(d)) {
      const auto column = hn::Add(hn::Set(d, left + 2 * double(k)), steps);
      auto a = hn::Mul(column, hn::Set(d, 1.0 / P::aspect)), at_b = b;
      if constexpr (P::on_disc && !P::filled) move_inside_rim(d, scale, a, at_b);
      hn::Vec<Lanes> x, y, z;
      direction(q, d, scale, face, a, at_b, x, y, z);
      store(d, x, y, z, &out[k], out.size() - k);
    }
  });
}

void Directions(Projection p, int face, std::span<const Point2> points, std::span<Direction> out) {
  visit(p, [&](auto q) HWY_ATTR {
    const Lanes d;
    const std::size_t lanes = hn::Lanes(d);
    const Scale scale(1);
    const auto one = hn::Set(d, 1), two = hn::Set(d, 2);
    for (std::size_t k = 0; k < points.size(); k += lanes) {
      const std::size_t count = std::min(lanes, points.size() - k);
      std::array<Point2, hn::MaxLanes(Lanes())> all;
      const bool whole = count == lanes;
      if (!whole) std::fill(std::copy_n(&points[k], count, all.begin()), all.end(), Point2(0.5));
      hn::Vec<Lanes> u, v, x, y, z;
      hn::LoadInterleaved2(d, whole ? &points[k].x : &all.front().x, u, v);
      direction(q, d, scale, face, hn::Sub(hn::Mul(two, u), one), hn::Sub(one, hn::Mul(two, v)), x, y, z);
      store(d, x, y, z, &out[k], count);
    }
  });
}

// A location is packed as three doubles, the first of them the bits of its face.
template <class D, class V>
HWY_INLINE void store(D d, V face, V u, V v, Location<double>* to, std::size_t count) {
  const hn::RebindToUnsigned<D> du;
  const auto bits = hn::And(hn::BitCast(du, hn::Add(face, hn::Set(d, 0x1p52))), hn::Set(du, 0xff));
  HWY_ALIGN double packed[3 * hn::MaxLanes(D())];
  hn::StoreInterleaved3(hn::BitCast(d, bits), u, v, d, packed);
  if (count >= hn::Lanes(d))
    std::memcpy(to, packed, hn::Lanes(d) * sizeof *to);  // Of known size on most targets, and then no call.
  else
    std::memcpy(to, packed, count * sizeof *to);
}

void Locate(Projection p, std::span<const Direction> directions, std::span<Location<double>> out) {
  visit(p, [&](auto q) HWY_ATTR {
    const Lanes d;
    for (std::size_t k = 0; k < directions.size(); k += hn::Lanes(d)) {
      const std::size_t count = directions.size() - k;
      hn::Vec<Lanes> x, y, z, face, u, v;
      load(d, &directions[k], count, x, y, z);
      locate(q, d, x, y, z, face, u, v);
      store(d, face, u, v, &out[k], count);
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

namespace {

void check_face(Projection p, int face) { check_range({"face", 0, faces(p) - 1.0}, face); }

}  // namespace

void texel_directions(Projection p, int size, int face, int row, int first, std::span<Direction> out) {
  check_face(p, face);
  check_range({"size", 1, 1e9}, size);
  check_range({"row", 0, size - 1.0}, row);
  HWY_DYNAMIC_DISPATCH(TexelDirections)(p, size, face, row, first, out);
}

void directions(Projection p, int face, std::span<const Point2> points, std::span<Direction> out) {
  check_face(p, face);
  check_length("out", out.size(), points.size());
  HWY_DYNAMIC_DISPATCH(Directions)(p, face, points, out);
}

void locate(Projection p, std::span<const Direction> directions, std::span<Location<double>> out) {
  check_length("out", out.size(), directions.size());
  std::vector<Direction> units;
  if (!std::ranges::all_of(directions, is_unit)) {
    for (const Direction& d : directions) units.push_back(checked_direction("direction", d));
    directions = units;
  }
  HWY_DYNAMIC_DISPATCH(Locate)(p, directions, out);
}

}  // namespace envmap
#endif  // HWY_ONCE

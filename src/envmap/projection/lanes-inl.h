/// @file
/// The projections once more, a vector of places at a time. The types in their own headers are the reference: the
/// formulae, their sources and the reasons are there. Branch-free, and the same bits on every target: see
/// trigonometry-inl.h.
#if defined(ENVMAP_PROJECTION_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ENVMAP_PROJECTION_LANES_INL_H_
#undef ENVMAP_PROJECTION_LANES_INL_H_
#else
#define ENVMAP_PROJECTION_LANES_INL_H_
#endif

#include <bit>

#include "envmap/maths/trigonometry-inl.h"
#include "envmap/projection/visit.h"

HWY_BEFORE_NAMESPACE();
namespace envmap {
namespace HWY_NAMESPACE {

/// A face whose places are given as a = n s and b = n t, with s = 2u - 1 and t = 1 - 2v. For the centres of texels, n
/// is the height of the face: a and b are then whole (on latlong maps, half) numbers and their squares are exact.
struct Scale {
  explicit Scale(double size)
      : n(size),
        inverse(1 / size),
        square(size * size),
        inverse_square(1 / square),
        split(0x1.8p27 * std::bit_ceil(unsigned(size))) {}

  double n, inverse, square, inverse_square;
  double split;  ///< Added and taken away again it rounds a and b to 26 bits or so.
};

// ---- place -> direction --------------------------------------------------------------------------------------------

template <class D, class V>
HWY_INLINE void direction(Latlong, D d, const Scale& scale, int /*face*/, V a, V b, V& x, V& y, V& z) {
  const V n = hn::Set(d, scale.n), inverse = hn::Set(d, scale.inverse);
  V sine, cosine, level;
  sin_cos_pi_ratio(d, hn::Mul(b, hn::Set(d, 0.5)), n, inverse, y, level);  // Latitude.
  sin_cos_pi_ratio(d, hn::Neg(a), n, inverse, sine, cosine);               // Longitude.
  x = hn::Mul(level, sine);
  z = hn::Mul(level, cosine);
}

template <class D, class V>
HWY_INLINE void direction(Cube, D d, const Scale& scale, int face, V a, V b, V& x, V& y, V& z) {
  const Cube::Axes& axes = Cube::axes[face];
  const V square = hn::Add(hn::Add(hn::Set(d, scale.square), hn::Mul(a, a)), hn::Mul(b, b));
  const V unit = hn::Div(hn::Set(d, 1), hn::Sqrt(square));
  const auto component = [&](int k) HWY_ATTR {  // Two of the three terms are 0.
    const V forward = hn::Set(d, scale.n * axes.forward[k]);
    const V right = hn::Mul(a, hn::Set(d, axes.right[k])), up = hn::Mul(b, hn::Set(d, axes.up[k]));
    return hn::Mul(hn::Add(hn::Add(forward, right), up), unit);
  };
  x = component(0);
  y = component(1);
  z = component(2);
}

template <class D, class V>
HWY_INLINE void direction(Sphere, D d, const Scale& scale, int /*face*/, V a, V b, V& x, V& y, V& z) {
  const V n = hn::Set(d, scale.n), square = hn::Set(d, scale.square);
  // Beyond the rim: the point opposite, at radius 2n - r.
  const V r = hn::Sqrt(hn::Add(hn::Mul(a, a), hn::Mul(b, b)));
  const auto beyond = hn::Gt(r, n);
  if (!hn::AllFalse(d, beyond)) {
    const V turned = hn::Div(hn::Sub(r, hn::Add(n, n)), hn::IfThenElse(beyond, r, n));
    a = hn::IfThenElse(beyond, hn::Mul(a, turned), a);
    b = hn::IfThenElse(beyond, hn::Mul(b, turned), b);
  }
  // rest = n^2 - a^2 - b^2 decides how far from -Z we are. a = head + tail: the squares of the heads are exact, what
  // remains of a^2 is tail (a + head).
  const V split = hn::Set(d, scale.split), zero = hn::Zero(d);
  const V a_head = hn::Sub(hn::Add(a, split), split), a_rest = hn::Mul(hn::Sub(a, a_head), hn::Add(a, a_head));
  const V b_head = hn::Sub(hn::Add(b, split), split), b_rest = hn::Mul(hn::Sub(b, b_head), hn::Add(b, b_head));
  const V heads = hn::Sub(hn::Sub(square, hn::Mul(a_head, a_head)), hn::Mul(b_head, b_head));
  const V rest = hn::Max(zero, hn::Sub(heads, hn::Add(a_rest, b_rest)));
  const V unit = hn::Set(d, scale.inverse_square), k = hn::Mul(hn::Set(d, 2 * scale.inverse_square), hn::Sqrt(rest));
  x = hn::Mul(k, a);
  y = hn::Mul(k, b);
  z = hn::Mul(unit, hn::Sub(hn::Add(rest, rest), square));
}

template <class D, class V>
HWY_INLINE void direction(Paraboloid, D d, const Scale& scale, int face, V a, V b, V& x, V& y, V& z) {
  const V square = hn::Set(d, scale.square), rr = hn::Add(hn::Mul(a, a), hn::Mul(b, b));
  const V unit = hn::Div(hn::Set(d, 1), hn::Add(square, rr)), k = hn::Mul(hn::Set(d, 2 * scale.n), unit);
  x = hn::Mul(k, a);
  y = hn::Mul(k, b);
  z = hn::Mul(hn::Sub(square, rr), face == 0 ? unit : hn::Neg(unit));
}

template <class D, class V>
HWY_INLINE void direction(Angular, D d, const Scale& scale, int /*face*/, V a, V b, V& x, V& y, V& z) {
  const V r = hn::Sqrt(hn::Add(hn::Mul(a, a), hn::Mul(b, b)));
  V sine;
  sin_cos_pi(d, hn::Div(r, hn::Set(d, scale.n)), sine, z);
  const V k = hn::Div(sine, hn::Max(r, hn::Set(d, 1e-300)));  // At the middle sine and a are 0 themselves.
  x = hn::Neg(hn::Mul(k, a));
  y = hn::Mul(k, b);
}

/// octahedron::folded() of a place in the square, or beyond its sides; a and b change as octahedron::wrapped() says.
/// All of the net is exact where a, b and n are whole.
template <class V, class M>
struct Folded {
  V a, b;
  M below;
};

template <class D, class V>
HWY_INLINE auto folded(D d, const Scale& scale, V& a, V& b) {
  const V n = hn::Set(d, scale.n), twice = hn::Add(n, n);
  if (const auto beyond = hn::Gt(hn::Max(hn::Abs(a), hn::Abs(b)), n); !hn::AllFalse(d, beyond)) {
    const V period = hn::Set(d, 4 * scale.n), turns = hn::Set(d, 0.25 * scale.inverse);
    a = hn::Sub(a, hn::Mul(period, nearest_whole(d, hn::Mul(a, turns))));
    b = hn::Sub(b, hn::Mul(period, nearest_whole(d, hn::Mul(b, turns))));
    const auto over_side = hn::Gt(hn::Abs(a), n);
    a = hn::IfThenElse(over_side, hn::Sub(hn::CopySign(twice, a), a), a);
    b = hn::IfThenElse(over_side, hn::Neg(b), b);
    const auto over_top = hn::Gt(hn::Abs(b), n);
    b = hn::IfThenElse(over_top, hn::Sub(hn::CopySign(twice, b), b), b);
    a = hn::IfThenElse(over_top, hn::Neg(a), a);
  }
  const V x = hn::Abs(a), z = hn::Abs(b);
  const auto below = hn::Gt(hn::Add(x, z), n);
  return Folded<V, decltype(below)>{hn::IfThenElse(below, hn::Sub(n, z), x), hn::IfThenElse(below, hn::Sub(n, x), z),
                                    below};
}

template <class D, class V>
HWY_INLINE void direction(Octahedral, D d, const Scale& scale, int /*face*/, V a, V b, V& x, V& y, V& z) {
  const auto f = folded(d, scale, a, b);
  const V up = hn::Sub(hn::Sub(hn::Set(d, scale.n), f.a), f.b);
  const V square = hn::Add(hn::Add(hn::Mul(f.a, f.a), hn::Mul(up, up)), hn::Mul(f.b, f.b));
  const V unit = hn::Div(hn::Set(d, 1), hn::Sqrt(square)), height = hn::Mul(up, unit);
  x = hn::CopySign(hn::Mul(f.a, unit), a);
  y = hn::IfThenElse(f.below, hn::Neg(height), height);
  z = hn::CopySign(hn::Mul(f.b, unit), b);
}

template <class D, class V>
HWY_INLINE void direction(EqualArea, D d, const Scale& scale, int /*face*/, V a, V b, V& x, V& y, V& z) {
  const auto f = folded(d, scale, a, b);
  const V n = hn::Set(d, scale.n), r = hn::Add(f.a, f.b), unit = hn::Set(d, scale.inverse_square);
  const V divisor = hn::Max(r, hn::Set(d, 1e-300));  // In the middle b is 0 itself.
  V sine, cosine;
  sin_cos_pi_ratio(d, hn::Mul(f.b, hn::Set(d, 0.5)), divisor, hn::Div(hn::Set(d, 1), divisor), sine, cosine);
  const V level = hn::Mul(hn::Mul(r, hn::Sqrt(hn::Sub(hn::Set(d, 2 * scale.square), hn::Mul(r, r)))), unit);
  const V height = hn::Mul(hn::Mul(hn::Sub(n, r), hn::Add(n, r)), unit);
  x = hn::CopySign(hn::Mul(level, cosine), a);
  y = hn::IfThenElse(f.below, hn::Neg(height), height);
  z = hn::CopySign(hn::Mul(level, sine), b);
}

// ---- direction -> place --------------------------------------------------------------------------------------------

/// Multiplies x and y by 2^600 where their squares would underflow. @return what brings them back.
template <class D, class V>
HWY_INLINE V lift(D d, V& x, V& y) {
  const auto tiny = hn::Lt(hn::Max(hn::Abs(x), hn::Abs(y)), hn::Set(d, 0x1p-500));
  const V one = hn::Set(d, 1), up = hn::IfThenElse(tiny, hn::Set(d, 0x1p600), one);
  x = hn::Mul(x, up);
  y = hn::Mul(y, up);
  return hn::IfThenElse(tiny, hn::Set(d, 0x1p-600), one);
}

template <class D, class V>
HWY_INLINE void locate(Latlong, D d, V x, V y, V z, V& face, V& u, V& v) {
  const V half = hn::Set(d, 0.5), across = hn::Sqrt(hn::Add(hn::Mul(x, x), hn::Mul(z, z)));
  face = hn::Zero(d);
  u = hn::Sub(half, hn::Mul(half, atan2_pi(d, x, z)));
  v = hn::Sub(half, atan2_pi(d, y, across));
}

/// On an edge or corner the first of X, Y, Z wins.
template <class D, class V>
HWY_INLINE void locate(Cube, D d, V x, V y, V z, V& face, V& u, V& v) {
  const V ax = hn::Abs(x), ay = hn::Abs(y), az = hn::Abs(z), zero = hn::Zero(d), half = hn::Set(d, 0.5);
  const auto on_x = hn::And(hn::Ge(ax, ay), hn::Ge(ax, az)), on_y = hn::Ge(ay, az);
  const V major = hn::IfThenElse(on_x, x, hn::IfThenElse(on_y, y, z));
  const V sign = hn::And(major, hn::SignBit(d));
  const V axis = hn::IfThenElse(on_x, zero, hn::IfThenElse(on_y, hn::Set(d, 2), hn::Set(d, 4)));
  face = hn::Add(axis, hn::IfThenElseZero(hn::Lt(major, zero), hn::Set(d, 1)));
  // Right: +-Z, +X, -+X on X, Y, Z; up: +Y, +-Z, +Y.
  const V signed_z = hn::Xor(z, sign), signed_x = hn::Neg(hn::Xor(x, sign));
  const V right = hn::IfThenElse(on_x, signed_z, hn::IfThenElse(on_y, x, signed_x));
  const V up = hn::IfThenElse(hn::AndNot(on_x, on_y), signed_z, y);
  const V k = hn::Div(half, hn::Abs(major));
  u = hn::Add(half, hn::Mul(k, right));
  v = hn::Sub(half, hn::Mul(k, up));
}

template <class D, class V>
HWY_INLINE void locate(Sphere, D d, V x, V y, V z, V& face, V& u, V& v) {
  const V zero = hn::Zero(d), one = hn::Set(d, 1), half = hn::Set(d, 0.5), next = hn::Add(z, one);
  const auto front = hn::Gt(z, zero);
  V lifted_x = x, lifted_y = y;
  lift(d, lifted_x, lifted_y);
  x = hn::IfThenElse(front, x, lifted_x);
  y = hn::IfThenElse(front, y, lifted_y);
  // In front x / m; behind, where 1+z cancels, x / h sqrt((1-z)/2).
  const V hh = hn::Add(hn::Mul(x, x), hn::Mul(y, y));
  const auto nowhere = hn::AndNot(front, hn::Eq(hh, zero));
  const V length = hn::Sqrt(hn::IfThenElse(front, hn::Add(hh, hn::Mul(next, next)), hh));
  const V radius = hn::IfThenElse(front, one, hn::Sqrt(hn::Mul(half, hn::Sub(one, z))));
  const V divisor = hn::IfThenElse(nowhere, one, length);
  // -Z itself: the right of the rim.
  const V s = hn::IfThenElse(nowhere, one, hn::Mul(hn::Div(x, divisor), radius));
  face = zero;
  u = hn::Add(half, hn::Mul(half, s));
  v = hn::Sub(half, hn::Mul(half, hn::Mul(hn::Div(y, divisor), radius)));
}

template <class D, class V>
HWY_INLINE void locate(Paraboloid, D d, V x, V y, V z, V& face, V& u, V& v) {
  const V half = hn::Set(d, 0.5), one = hn::Set(d, 1), k = hn::Div(half, hn::Add(one, hn::Abs(z)));
  face = hn::IfThenElseZero(hn::Lt(z, hn::Zero(d)), one);
  u = hn::Add(half, hn::Mul(k, x));
  v = hn::Sub(half, hn::Mul(k, y));
}

template <class D, class V>
HWY_INLINE void locate(Angular, D d, V x, V y, V z, V& face, V& u, V& v) {
  const V zero = hn::Zero(d), one = hn::Set(d, 1), half = hn::Set(d, 0.5), down = lift(d, x, y);
  const V h = hn::Sqrt(hn::Add(hn::Mul(x, x), hn::Mul(y, y)));
  const auto nowhere = hn::Eq(h, zero);
  const V r = atan2_pi(d, hn::Mul(h, down), z), k = hn::Div(r, hn::IfThenElse(nowhere, one, h));
  // -Z itself: the right of the rim.
  const V s = hn::IfThenElse(nowhere, hn::IfThenZeroElse(hn::Gt(z, zero), one), hn::Neg(hn::Mul(x, k)));
  face = zero;
  u = hn::Add(half, hn::Mul(half, s));
  v = hn::Sub(half, hn::Mul(half, hn::Mul(y, k)));
}

/// octahedron::unfolded().
template <class D, class V>
HWY_INLINE void unfold(D d, V a, V b, V x, V y, V z, V& face, V& u, V& v) {
  const V one = hn::Set(d, 1), half = hn::Set(d, 0.5);
  const auto below = hn::Lt(y, hn::Zero(d));
  const V s = hn::CopySign(hn::IfThenElse(below, hn::Sub(one, b), a), x);
  const V t = hn::CopySign(hn::IfThenElse(below, hn::Sub(one, a), b), z);
  face = hn::Zero(d);
  u = hn::Add(half, hn::Mul(half, s));
  v = hn::Sub(half, hn::Mul(half, t));
}

template <class D, class V>
HWY_INLINE void locate(Octahedral, D d, V x, V y, V z, V& face, V& u, V& v) {
  const V ax = hn::Abs(x), az = hn::Abs(z), k = hn::Div(hn::Set(d, 1), hn::Add(hn::Add(ax, hn::Abs(y)), az));
  unfold(d, hn::Mul(ax, k), hn::Mul(az, k), x, y, z, face, u, v);
}

template <class D, class V>
HWY_INLINE void locate(EqualArea, D d, V x, V y, V z, V& face, V& u, V& v) {
  const V level = hn::Add(hn::Mul(x, x), hn::Mul(z, z));
  const V r = hn::Sqrt(hn::Div(level, hn::Add(hn::Set(d, 1), hn::Abs(y))));
  const V b = hn::Mul(r, hn::Mul(hn::Set(d, 2), atan2_pi(d, hn::Abs(z), hn::Abs(x))));
  unfold(d, hn::Sub(r, b), b, x, y, z, face, u, v);
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap
HWY_AFTER_NAMESPACE();

#endif  // ENVMAP_PROJECTION_LANES_INL_H_

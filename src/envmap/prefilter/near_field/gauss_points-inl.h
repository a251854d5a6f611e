// Points of a source as an output's direction sees them, for lanes: x = 1 - cos of the angle between them, and solid
// angles. Included once a target. Coordinates are differences from the direction, and each formula is a sum of products
// of such differences, so that x of a thousandth of a texel has all digits of a float.
#include "envmap/prefilter/multilevel/level_kernel-inl.h"
#include "envmap/prefilter/near_field/gauss_points.h"

#if defined(ENVMAP_PREFILTER_GAUSS_POINTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ENVMAP_PREFILTER_GAUSS_POINTS_INL_H_
#undef ENVMAP_PREFILTER_GAUSS_POINTS_INL_H_
#else
#define ENVMAP_PREFILTER_GAUSS_POINTS_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {

constexpr std::size_t vectors = 2 * parts;  // Vectors of sixteen points.

// The sixteen points of a piece: x, and the weight in steradians over the product of the piece's sides.
struct PiecePoints {
  V x[vectors], weight[vectors];
  double size;  // The longer side, an upper bound of its angle.
};

// Coordinates of the points in vector k. @param node from -1 to 1.
HWY_INLINE V place(const float* node, std::size_t k, double from, double to) {
  const D d;
  return broadcast(0.5 * (from + to)) + broadcast(0.5 * (to - from)) * hn::Load(d, node + k * lanes);
}

HWY_INLINE float largest(V v) { return hn::GetLane(hn::MaxOfLanes(D(), v)); }

// A latlong map: longitude across, polar angle down. With y the difference of polar angles and s, S the sines of both,
// x = (1 - cos y) + s S (1 - cos(longitude)): points across are known by 1 - cos(longitude).
struct OnLatlong {
  double exact_sine, exact_cosine;  // Sine and cosine of the output's polar angle.
  float sine, cosine;
  float sine_top = 0, cosine_top = 0;  // Sine and cosine at the upper side of a row.
  double least_sine = 0;               // Least sine over a row.

  // The border of two rows.
  struct Side {
    SmallAngle angle;  // Difference of its polar angle from the output's.
    double sine;       // Sine of its polar angle.
  };

  explicit OnLatlong(const GridView& view)
      : exact_sine(view.sine),
        exact_cosine(2 * view.half_cosine * view.half_cosine - 1),
        sine(float(exact_sine)),
        cosine(float(exact_cosine)) {}

  HWY_INLINE Side side(double y) const {
    const SmallAngle angle(y);
    return {angle, std::max(0.0, exact_sine - exact_sine * angle.versine + exact_cosine * angle.sine)};
  }
  HWY_INLINE OnLatlong of_row(const Side& top, double least) const {
    OnLatlong row = *this;
    row.sine_top = float(top.sine), row.least_sine = least;
    row.cosine_top = float(exact_cosine - exact_cosine * top.angle.versine - exact_sine * top.angle.sine);
    return row;
  }

  // Near a pole two points do not follow the sine of the polar angle.
  HWY_INLINE std::size_t first_rule(const Piece& p) const { return least_sine < 8 * (p.y1 - p.y0) ? 1 : 0; }

  // Points down a row: x = c + g (1 - cos(longitude)).
  struct Row {
    double size;  // See PiecePoints.
    alignas(32) float c[SideRule::most], g[SideRule::most], weight[SideRule::most];
  };
  HWY_INLINE void set(const Piece& p, const SideRule& rule, Row& row) const {
    const D d;
    const double high = p.y1 - p.y0;
    // Sines are expanded about the upper side: near a pole, differences from the output would lose their digits.
    const V sine_here = broadcast(sine), zero = hn::Zero(d), at_top = broadcast(sine_top),
            falls = broadcast(cosine_top), top = broadcast(p.y0), side = broadcast(high);
    V widest = zero;
    for (std::size_t k = 0; k < rule.count; k += lanes) {
      const V t = side * hn::Load(d, rule.at_lanes + k), tt = t * t, y = top + t, yy = y * y;
      const V at = hn::Max(zero, at_top * polynomial(d, tt, 1, -1.0 / 2, 1.0 / 24) +
                                     falls * (t * polynomial(d, tt, 1, -1.0 / 6, 1.0 / 120)));
      hn::Store(broadcast(0.5) * yy * polynomial(d, yy, 1, -1.0 / 12, 1.0 / 360, -1.0 / 20160), d, row.c + k);
      hn::Store(at * sine_here, d, row.g + k);
      hn::Store(at * hn::Load(d, rule.weight_lanes + k), d, row.weight + k);
      widest = hn::Max(widest, at);
    }
    row.size = std::max((p.x1 - p.x0) * std::min(1.0, 1.2 * double(largest(widest))), high);
  }
  HWY_INLINE V versine(const Row& row, std::size_t k, V x) const {
    return broadcast(row.c[k]) + broadcast(row.g[k]) * x;
  }
  HWY_INLINE V weight(const Row& row, std::size_t k, V /*x*/) const { return broadcast(row.weight[k]); }

  HWY_INLINE PiecePoints points_of(const Piece& p) const {
    const D d;
    const V one = broadcast(1), half = broadcast(0.5);
    PiecePoints s;
    V widest = hn::Zero(d);
    for (std::size_t k = 0; k < vectors; ++k) {
      const V x = half * place(points.x, k, p.x0, p.x1), y = half * place(points.y, k, p.y0, p.y1);
      const V xx = x * x, yy = y * y, across = x * sine_series(xx), down = y * sine_series(yy);
      const V c = broadcast(2) * (down * down), v = broadcast(2) * (across * across);
      const V twice = broadcast(2) * (down * cosine_series(yy));
      const V at = hn::Max(hn::Zero(d), broadcast(sine) * (one - c) + broadcast(cosine) * twice);
      s.x[k] = c + at * broadcast(sine) * v;
      s.weight[k] = at * hn::Load(d, points.weight + k * lanes);
      widest = hn::Max(widest, at);
    }
    s.size = std::max((p.x1 - p.x0) * std::min(1.0, 1.2 * double(largest(widest))), p.y1 - p.y0);
    return s;
  }

 private:
  // sin(t) / t and cos(t), of t^2 up to (pi / 2)^2.
  static HWY_INLINE V sine_series(V tt) {
    return polynomial(D(), tt, 1, -1.0 / 6, 1.0 / 120, -1.0 / 5040, 1.0 / 362880, -1.0 / 39916800);
  }
  static HWY_INLINE V cosine_series(V tt) {
    return polynomial(D(), tt, 1, -0.5, 1.0 / 24, -1.0 / 720, 1.0 / 40320, -1.0 / 3628800, 1.0 / 479001600);
  }
};

// A cube's face, with coordinates from -1 to 1. With p = (s, t, 1) the point and q the output's place on the face, x =
// |p x q|^2 / (|p| |q| (|p| |q| + p.q)), and |p x q|^2 is a sum of squares of differences.
struct OnCube {
  double exact_s, exact_t;  // q
  float s, t, length;       // In float, and its length.

  OnCube(double at_s, double at_t)
      : exact_s(at_s),
        exact_t(at_t),
        s(float(at_s)),
        t(float(at_t)),
        length(float(std::sqrt(1 + at_s * at_s + at_t * at_t))) {}

  HWY_INLINE PiecePoints points_of(const Piece& p) const {
    PiecePoints out;
    for (std::size_t k = 0; k < vectors; ++k) {
      const V ds = place(points.x, k, p.x0, p.x1), dt = place(points.y, k, p.y0, p.y1);
      out.x[k] = versine(ds, dt);
      out.weight[k] = hn::Load(D(), points.weight + k * lanes) * area(ds, dt);
    }
    out.size = std::max(p.x1 - p.x0, p.y1 - p.y0);
    return out;
  }

  HWY_INLINE std::size_t first_rule(const Piece&) const { return 0; }

  struct Row {
    double size;
    float down[SideRule::most], weight[SideRule::most];
  };
  HWY_INLINE void set(const Piece& p, const SideRule& rule, Row& row) const {
    row.size = p.y1 - p.y0;
    for (std::size_t k = 0; k < rule.count; ++k)
      row.down[k] = float(p.y0 + rule.at[k] * row.size), row.weight[k] = float(rule.weight[k]);
  }
  HWY_INLINE V versine(const Row& row, std::size_t k, V x) const { return versine(x, broadcast(row.down[k])); }
  HWY_INLINE V weight(const Row& row, std::size_t k, V x) const {
    return broadcast(row.weight[k]) * area(x, broadcast(row.down[k]));
  }

  // x of a point beside q.
  HWY_INLINE V versine(V ds, V dt) const {
    const V s0 = broadcast(s), t0 = broadcast(t), s1 = s0 + ds, t1 = t0 + dt;
    const V turn = ds * t0 - dt * s0;
    const V cross = turn * turn + (ds * ds + dt * dt);
    const V dot = broadcast(1) + (s1 * s0 + t1 * t0);
    const V both = hn::Sqrt(square(s1, t1)) * broadcast(length);
    return cross / (both * (both + dot));
  }
  [[nodiscard]] double exact_versine(double ds, double dt) const {
    const double s1 = exact_s + ds, t1 = exact_t + dt, turn = ds * exact_t - dt * exact_s;
    const double both = std::sqrt((1 + s1 * s1 + t1 * t1) * (1 + exact_s * exact_s + exact_t * exact_t));
    return (turn * turn + (ds * ds + dt * dt)) / (both * (both + 1 + s1 * exact_s + t1 * exact_t));
  }
  // Its solid angle over that in the middle of the face.
  HWY_INLINE V area(V ds, V dt) const {
    const V all = square(broadcast(s) + ds, broadcast(t) + dt);
    return broadcast(1) / (all * hn::Sqrt(all));
  }

 private:
  HWY_INLINE V square(V s1, V t1) const { return broadcast(1) + (s1 * s1 + t1 * t1); }
};

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();
#endif

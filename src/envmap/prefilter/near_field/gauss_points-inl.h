// Where points of a source lie as an output's direction sees them, for lanes: 1 - cos of the angle, and solid angles.
// Included once a target.
#include "envmap/prefilter/multilevel/level_kernel-inl.h"
#include "envmap/prefilter/near_field/gauss_points.h"

#if defined(ENVMAP_PREFILTER_CORE_PLACES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ENVMAP_PREFILTER_CORE_PLACES_INL_H_
#undef ENVMAP_PREFILTER_CORE_PLACES_INL_H_
#else
#define ENVMAP_PREFILTER_CORE_PLACES_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {

constexpr std::size_t vectors = 2 * parts;  // Of sixteen points.

// The points of a piece: x = 1 - cos of each, and its weight in steradians but for the piece's sides.
struct Seen {
  V x[vectors], weight[vectors];
  double size;  // The longer side, as an angle at most.
};

HWY_INLINE V place(const float* node, std::size_t k, double from, double to) {
  const D d;
  return hn::Add(hn::Set(d, float(0.5 * (from + to))),
                 hn::Mul(hn::Set(d, float(0.5 * (to - from))), hn::Load(d, node + k * lanes)));
}

HWY_INLINE float largest(V v) { return hn::GetLane(hn::MaxOfLanes(D(), v)); }

// Longitude across, polar angle down. Points across are known by 1 - cos(longitude).
struct OnLatlong {
  double exact_sine, exact_cosine;  // Of the output's polar angle.
  float sine, cosine;
  float sine_top = 0, cosine_top = 0;  // Of a row's upper side.
  double least_sine = 0;               // Of the row.

  // Where rows meet.
  struct Side {
    SmallAngle off;  // From the output.
    double sine;
  };

  explicit OnLatlong(const GridView& view)
      : exact_sine(view.sine),
        exact_cosine(2 * view.half_cosine * view.half_cosine - 1),
        sine(float(exact_sine)),
        cosine(float(exact_cosine)) {}

  HWY_INLINE Side side(double y) const {
    const SmallAngle off(y);
    return {off, std::max(0.0, exact_sine - exact_sine * off.versine + exact_cosine * off.sine)};
  }
  HWY_INLINE OnLatlong of_row(const Side& top, double least) const {
    OnLatlong row = *this;
    row.sine_top = float(top.sine), row.least_sine = least;
    row.cosine_top = float(exact_cosine - exact_cosine * top.off.versine - exact_sine * top.off.sine);
    return row;
  }

  // Two points do not follow the sine of the polar angle near a pole.
  HWY_INLINE std::size_t first_rule(const Piece& p) const { return least_sine < 8 * (p.y1 - p.y0) ? 1 : 0; }

  struct Row {
    double size;                                                         // As Seen's.
    alignas(32) float c[Rule::most], g[Rule::most], weight[Rule::most];  // x = c + g (1 - cos(longitude)).
  };
  HWY_INLINE void set(const Piece& p, const Rule& rule, Row& row) const {
    const D d;
    const double high = p.y1 - p.y0;
    // Sines by the upper side, or those near a pole would be differences of large numbers.
    const V sine_here = hn::Set(d, sine), zero = hn::Zero(d), at_top = hn::Set(d, sine_top),
            falls = hn::Set(d, cosine_top), top = hn::Set(d, float(p.y0)), side = hn::Set(d, float(high));
    V widest = zero;
    for (std::size_t k = 0; k < rule.count; k += lanes) {
      const V t = hn::Mul(side, hn::Load(d, rule.at_lanes + k)), tt = hn::Mul(t, t), y = hn::Add(top, t),
              yy = hn::Mul(y, y);
      const V at = hn::Max(zero, hn::Add(hn::Mul(at_top, series(d, tt, 1, -1.0 / 2, 1.0 / 24)),
                                         hn::Mul(falls, hn::Mul(t, series(d, tt, 1, -1.0 / 6, 1.0 / 120)))));
      hn::Store(hn::Mul(hn::Mul(hn::Set(d, 0.5F), yy), series(d, yy, 1, -1.0 / 12, 1.0 / 360, -1.0 / 20160)), d,
                row.c + k);
      hn::Store(hn::Mul(at, sine_here), d, row.g + k);
      hn::Store(hn::Mul(at, hn::Load(d, rule.weight_lanes + k)), d, row.weight + k);
      widest = hn::Max(widest, at);
    }
    row.size = std::max((p.x1 - p.x0) * std::min(1.0, 1.2 * double(largest(widest))), high);
  }
  HWY_INLINE V versine(const Row& row, std::size_t k, V x) const {
    return hn::Add(hn::Set(D(), row.c[k]), hn::Mul(hn::Set(D(), row.g[k]), x));
  }
  HWY_INLINE V weight(const Row& row, std::size_t k, V /*x*/) const { return hn::Set(D(), row.weight[k]); }

  HWY_INLINE Seen seen(const Piece& p) const {
    const D d;
    const V one = hn::Set(d, 1), half = hn::Set(d, 0.5F);
    Seen s;
    V widest = hn::Zero(d);
    for (std::size_t k = 0; k < vectors; ++k) {
      const V x = hn::Mul(half, place(points.x, k, p.x0, p.x1)), y = hn::Mul(half, place(points.y, k, p.y0, p.y1));
      const V xx = hn::Mul(x, x), yy = hn::Mul(y, y), across = hn::Mul(x, sine_series(xx)),
              down = hn::Mul(y, sine_series(yy));
      const V c = hn::Mul(hn::Set(d, 2), hn::Mul(down, down)), v = hn::Mul(hn::Set(d, 2), hn::Mul(across, across));
      const V twice = hn::Mul(hn::Set(d, 2), hn::Mul(down, cosine_series(yy)));
      const V at =
          hn::Max(hn::Zero(d), hn::Add(hn::Mul(hn::Set(d, sine), hn::Sub(one, c)), hn::Mul(hn::Set(d, cosine), twice)));
      s.x[k] = hn::Add(c, hn::Mul(hn::Mul(at, hn::Set(d, sine)), v));
      s.weight[k] = hn::Mul(at, hn::Load(d, points.weight + k * lanes));
      widest = hn::Max(widest, at);
    }
    s.size = std::max((p.x1 - p.x0) * std::min(1.0, 1.2 * double(largest(widest))), p.y1 - p.y0);
    return s;
  }

 private:
  // sin(t) / t and cos(t), of t^2 up to (pi / 2)^2.
  static HWY_INLINE V sine_series(V tt) {
    return series(D(), tt, 1, -1.0 / 6, 1.0 / 120, -1.0 / 5040, 1.0 / 362880, -1.0 / 39916800);
  }
  static HWY_INLINE V cosine_series(V tt) {
    return series(D(), tt, 1, -0.5, 1.0 / 24, -1.0 / 720, 1.0 / 40320, -1.0 / 3628800, 1.0 / 479001600);
  }
};

// Coordinates of a cube's face, from -1 to 1. With p = (s, t, 1) and q the output's place on the face,
// 1 - cos = |p x q|^2 / (|p| |q| (|p| |q| + p.q)), which is a sum of squares of differences.
struct OnCube {
  float s, t, length;  // q, and its length.

  HWY_INLINE Seen seen(const Piece& p) const {
    Seen out;
    for (std::size_t k = 0; k < vectors; ++k) {
      const V ds = place(points.x, k, p.x0, p.x1), dt = place(points.y, k, p.y0, p.y1);
      out.x[k] = versine(ds, dt);
      out.weight[k] = hn::Mul(hn::Load(D(), points.weight + k * lanes), area(ds, dt));
    }
    out.size = std::max(p.x1 - p.x0, p.y1 - p.y0);
    return out;
  }

  HWY_INLINE std::size_t first_rule(const Piece&) const { return 0; }

  struct Row {
    double size;
    float down[Rule::most], weight[Rule::most];
  };
  HWY_INLINE void set(const Piece& p, const Rule& rule, Row& row) const {
    row.size = p.y1 - p.y0;
    for (std::size_t k = 0; k < rule.count; ++k)
      row.down[k] = float(p.y0 + rule.at[k] * row.size), row.weight[k] = float(rule.weight[k]);
  }
  HWY_INLINE V versine(const Row& row, std::size_t k, V x) const { return versine(x, hn::Set(D(), row.down[k])); }
  HWY_INLINE V weight(const Row& row, std::size_t k, V x) const {
    return hn::Mul(hn::Set(D(), row.weight[k]), area(x, hn::Set(D(), row.down[k])));
  }

 private:
  HWY_INLINE V square(V s1, V t1) const { return hn::Add(hn::Set(D(), 1), hn::Add(hn::Mul(s1, s1), hn::Mul(t1, t1))); }
  HWY_INLINE V versine(V ds, V dt) const {
    const D d;
    const V s0 = hn::Set(d, s), t0 = hn::Set(d, t), s1 = hn::Add(s0, ds), t1 = hn::Add(t0, dt);
    const V turn = hn::Sub(hn::Mul(ds, t0), hn::Mul(dt, s0));
    const V cross = hn::Add(hn::Mul(turn, turn), hn::Add(hn::Mul(ds, ds), hn::Mul(dt, dt)));
    const V dot = hn::Add(hn::Set(d, 1), hn::Add(hn::Mul(s1, s0), hn::Mul(t1, t0)));
    const V both = hn::Mul(hn::Sqrt(square(s1, t1)), hn::Set(d, length));
    return hn::Div(cross, hn::Mul(both, hn::Add(both, dot)));
  }
  // Steradians, over those of the face's middle.
  HWY_INLINE V area(V ds, V dt) const {
    const V all = square(hn::Add(hn::Set(D(), s), ds), hn::Add(hn::Set(D(), t), dt));
    return hn::Div(hn::Set(D(), 1), hn::Mul(all, hn::Sqrt(all)));
  }
};

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();
#endif

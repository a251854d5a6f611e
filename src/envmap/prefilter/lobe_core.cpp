// Cores of lobes, compiled once for every instruction set and chosen at run time.
#include "envmap/prefilter/lobe_core.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "envmap/projection/cube.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/prefilter/lobe_core.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "envmap/prefilter/level_kernel-inl.h"

#ifndef ENVMAP_PREFILTER_LOBE_CORE_ONCE
#define ENVMAP_PREFILTER_LOBE_CORE_ONCE
namespace envmap::prefiltering {
namespace {

// A texel or part of one in two coordinates that are 0 at the output's direction: small numbers keep their digits.
struct Piece {
  double x0, x1, y0, y1;
};

// Gauss's rule of four points each way (Abramowitz and Stegun 1964, table 25.4), point 4 row + column.
struct SixteenPoints {
  alignas(64) float x[16], y[16], weight[16];
  constexpr SixteenPoints() : x(), y(), weight() {
    constexpr double node[] = {-0.861136311594052575, -0.339981043584856265, 0.339981043584856265,
                               0.861136311594052575};
    constexpr double of[] = {0.347854845137453857, 0.652145154862546143, 0.652145154862546143, 0.347854845137453857};
    for (int k = 0; k < 16; ++k)
      x[k] = float(node[k % 4]), y[k] = float(node[k / 4]), weight[k] = float(of[k % 4] * of[k / 4]);
  }
};
constexpr SixteenPoints points;

}  // namespace
}  // namespace envmap::prefiltering
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

HWY_INLINE float largest(V v) {
  float of[lanes];
  hn::StoreU(v, D(), of);
  return *std::max_element(of, of + lanes);
}

// Longitude across, polar angle down.
struct OnLatlong {
  float sine, cosine;  // Of the output's polar angle.

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
    const D d;
    const V one = hn::Set(d, 1), s0 = hn::Set(d, s), t0 = hn::Set(d, t);
    Seen out;
    for (std::size_t k = 0; k < vectors; ++k) {
      const V ds = place(points.x, k, p.x0, p.x1), dt = place(points.y, k, p.y0, p.y1);
      const V s1 = hn::Add(s0, ds), t1 = hn::Add(t0, dt);
      const V square = hn::Add(one, hn::Add(hn::Mul(s1, s1), hn::Mul(t1, t1))), l = hn::Sqrt(square);
      const V turn = hn::Sub(hn::Mul(ds, t0), hn::Mul(dt, s0));
      const V cross = hn::Add(hn::Mul(turn, turn), hn::Add(hn::Mul(ds, ds), hn::Mul(dt, dt)));
      const V dot = hn::Add(one, hn::Add(hn::Mul(s1, s0), hn::Mul(t1, t0))), both = hn::Mul(l, hn::Set(d, length));
      out.x[k] = hn::Div(cross, hn::Mul(both, hn::Add(both, dot)));
      out.weight[k] = hn::Div(hn::Load(d, points.weight + k * lanes), hn::Mul(square, l));
    }
    out.size = std::max(p.x1 - p.x0, p.y1 - p.y0);
    return out;
  }
};

// Whether sixteen points do: pieces small beside their distance from where the kernel has its pole, or is steep.
template <class K>
bool is_even(const K& kernel, double size, double nearest) {
  if (kernel.k.kind == LevelKernel::Kind::ggx)
    return size * size <= 0.16 * (nearest * nearest + 2 * double(kernel.k.a));
  return size * (nearest + size) * double(kernel.k.power * kernel.k.part) <= 3;
}

template <class Place, class K>
double over(const Place& place, const K& kernel, const Piece& p, int depth) {
  const Seen s = place.seen(p);
  V nearest = s.x[0];
  for (std::size_t k = 1; k < vectors; ++k) nearest = hn::Min(nearest, s.x[k]);
  // No place is farther from a point than half the largest gap each way.
  const double near = std::sqrt(2 * double(-largest(hn::Neg(nearest)))) - 0.25 * s.size, end = double(kernel.k.end);
  if (near > 0 && near * near > 2 * end) return 0;
  if (depth < 40 && !(s.size < 0.3 && is_even(kernel, s.size, std::max(0.0, near)))) {
    const double x = 0.5 * (p.x0 + p.x1), y = 0.5 * (p.y0 + p.y1);
    const auto part = [&](double x0, double x1, double y0, double y1) {
      return over(place, kernel, {x0, x1, y0, y1}, depth + 1);
    };
    return (part(p.x0, x, p.y0, y) + part(x, p.x1, p.y0, y)) + (part(p.x0, x, y, p.y1) + part(x, p.x1, y, p.y1));
  }
  V sum[parts];
  for (std::size_t k = 0; k < parts; ++k) {
    const V inside = hn::Mul(kernel(s.x[k]), s.weight[k]);
    sum[k] = hn::Add(inside, hn::Mul(kernel(s.x[k + parts]), s.weight[k + parts]));
  }
  return 0.25 * (p.x1 - p.x0) * (p.y1 - p.y0) * sum_of(sum);
}

template <class Place>
double Over(const Place& place, const LevelKernel& k, const Piece& p) {
  if (k.kind == LevelKernel::Kind::power)
    return k.cosine ? over(place, OfPower<true>{k}, p, 0) : over(place, OfPower<false>{k}, p, 0);
  return k.quartic ? over(place, OfGgx<false, true, true>{k}, p, 0) : over(place, OfGgx<false, true, false>{k}, p, 0);
}

Flux OfLatlong(const Level& source, const Colour& darkest, const LevelKernel& k, const GridView& view) {
  const double reach = 2 * portable::asin(std::sqrt(0.5 * double(k.end))), step = pi / source.height();
  const int columns = source.width(), low = std::max(0, int((view.angle - reach) / step)),
            high = std::min(source.height() - 1, int((view.angle + reach) / step));
  const OnLatlong place{float(view.sine), float(2 * view.half_cosine * view.half_cosine - 1)};
  const double at = view.longitude * columns / (2 * pi), wide = 2 * pi / columns;
  Flux sum(0);
  for (int row = low; row <= high; ++row) {
    const double sine =
        std::min(portable::sin_pi(double(row) / source.height()), portable::sin_pi((row + 1.0) / source.height()));
    const double away = std::max({0.0, row * step - view.angle, view.angle - (row + 1) * step});
    const double c = 2 * portable::sin_pi(0.5 * away / pi) * portable::sin_pi(0.5 * away / pi);
    const double versine = (double(k.end) - c) / std::max(1e-30, sine * view.sine);
    if (versine <= 0) continue;
    const double half = versine >= 2 ? columns : half_width(versine, columns);
    int first = int(std::floor(at - half)), last = int(std::floor(at + half));
    if (last - first + 1 > columns) first = int(std::floor(at)) - columns / 2, last = first + columns - 1;
    const std::span<const Colour> texels = source.row(0, row);
    for (int i = first; i <= last; ++i) {
      const Flux light(texels[std::size_t((i + 2 * columns) % columns)] - darkest);
      if (light == Flux(0)) continue;
      const double x = (i - at) * wide, y = row * step - view.angle;
      sum += Over(place, k, {x, x + wide, y, y + step}) * light;
    }
  }
  return sum;
}

// Which of a face's rows or columns reach to within `reach` of a direction, whose part in front is `ahead`, whose part
// to the side `aside`.
struct Cells {
  int first, last;
};
Cells cells_of(double ahead, double aside, double reach, int size) {
  const double angle = portable::atan2(aside, ahead);
  const double wide =
      portable::asin(std::min(1.0, portable::sin_pi(reach / pi) / portable::hypot(ahead, aside))) + 1e-9;
  const auto cell = [&](double a) {
    const double turn = std::clamp(a / pi, -0.25, 0.25);
    return int(std::floor(0.5 * size * (1 + portable::sin_pi(turn) / portable::cos_pi(turn))));
  };
  return {std::max(0, cell(angle - wide)), std::min(size - 1, cell(angle + wide))};
}

Flux OfCube(const Level& source, const Colour& darkest, const LevelKernel& k, const Direction& n) {
  const double reach = 2 * portable::asin(std::sqrt(0.5 * double(k.end)));
  const int size = source.height();
  const double wide = 2.0 / size;
  Flux sum(0);
  for (int face = 0; face < 6; ++face) {
    const Cube::Axes& a = Cube::axes[std::size_t(face)];
    const double ahead = glm::dot(n, a.forward), right = glm::dot(n, a.right), up = glm::dot(n, a.up);
    if (ahead < 0.3) continue;  // Beyond a corner by more than widest_core.
    const Cells across = cells_of(ahead, right, reach, size), down = cells_of(ahead, -up, reach, size);
    const double s = right / ahead, t = -up / ahead;
    const OnCube place{float(s), float(t), float(std::sqrt(1 + s * s + t * t))};
    for (int row = down.first; row <= down.last; ++row)
      for (int i = across.first; i <= across.last; ++i) {
        const Flux light(*source.texel(face, i, row) - darkest);
        if (light == Flux(0)) continue;
        const double x = i * wide - 1 - s, y = row * wide - 1 - t;
        sum += Over(place, k, {x, x + wide, y, y + wide}) * light;
      }
  }
  return sum;
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace envmap::prefiltering {
HWY_EXPORT(OfLatlong);
HWY_EXPORT(OfCube);

Flux core_sum(const Level& source, const Colour& darkest, const LevelKernel& kernel, const Direction& direction) {
  if (source.projection() == Projection::cube)
    return kernel.scale * HWY_DYNAMIC_DISPATCH(OfCube)(source, darkest, kernel, direction);
  return kernel.scale * HWY_DYNAMIC_DISPATCH(OfLatlong)(source, darkest, kernel, GridView(direction));
}

}  // namespace envmap::prefiltering
#endif  // HWY_ONCE

/// @file
/// Gauss-Legendre integrals over rectangles of the (s,t) plane and over their part inside the unit disc.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "envmap/maths/portable.h"
#include "envmap/maths/vector.h"

namespace envmap::legendre {

inline double first() { return std::sqrt(0.25 / pi); }

inline double diagonal(int m) { return std::sqrt((2 * m + 3) / (2.0 * m + 2)); }

struct Step {
  double a, b;
};
/// @param l above m.
inline Step step(int l, int m) {
  const double ll = 1.0 * l * l, mm = 1.0 * m * m, k = 1.0 * (l - 1) * (l - 1);
  return {std::sqrt((4 * ll - 1) / (ll - mm)), l > m + 1 ? std::sqrt((k - mm) / (4 * k - 1)) : 0};
}

}  // namespace envmap::legendre

namespace envmap {

/// A rectangle; u runs right and v down, or s right and t up: whatever the caller integrates over.
struct Rect {
  double u0, v0, u1, v1;
};

/// Texel (i,j) of a face w texels wide and h high, in its u and v from 0 to 1.
inline Rect texel_rect(int i, int j, double w, double h) { return {i / w, j / h, (i + 1) / w, (j + 1) / h}; }

namespace quadrature {

template <int N>
struct Rule {
  std::array<double, N> node, weight;  ///< On [-1,1].
};

/// Nodes by Newton's method on the Legendre polynomial (Abramowitz and Stegun 1964, 25.4.29).
template <int N>
Rule<N> make_rule() {
  Rule<N> rule{};
  for (int k = 0; k < N; ++k) {
    double x = portable::cos_pi((k + 0.75) / (N + 0.5)), slope = 1;
    for (int step = 0; step < 100; ++step) {
      double p0 = 1, p1 = x;
      for (int n = 2; n <= N; ++n) {
        const double p2 = ((2 * n - 1) * x * p1 - (n - 1) * p0) / n;
        p0 = p1;
        p1 = p2;
      }
      slope = N * (x * p1 - p0) / (x * x - 1);
      const double move = p1 / slope;
      x -= move;
      if (std::abs(move) < 1e-16) break;
    }
    rule.node[k] = x;
    rule.weight[k] = 2 / ((1 - x * x) * slope * slope);
  }
  return rule;
}

template <int N>
const Rule<N>& rule() {
  static const Rule<N> made = make_rule<N>();
  return made;
}

/// The rules of two, three and four points as constants, for tables made at compile time (Abramowitz and Stegun 1964,
/// table 25.4). Their nodes rise; those of rule() fall.
inline constexpr Rule<2> gauss_2{{-0.577350269189625765, 0.577350269189625765}, {1, 1}};
inline constexpr Rule<3> gauss_3{{-0.774596669241483377, 0, 0.774596669241483377}, {5.0 / 9, 8.0 / 9, 5.0 / 9}};
inline constexpr Rule<4> gauss_4{{-0.861136311594052575, -0.339981043584856265, 0.339981043584856265,
                                  0.861136311594052575},
                                 {0.347854845137453857, 0.652145154862546143, 0.652145154862546143,
                                  0.347854845137453857}};

/// Integral of f over [a,b] by N points; exact for polynomials of degree 2N-1.
template <int N, class F>
double line(double a, double b, F&& f) {
  const Rule<N>& r = rule<N>();
  const double half = 0.5 * (b - a), middle = 0.5 * (a + b);
  double sum = 0;
  for (int k = 0; k < N; ++k) sum += r.weight[k] * f(middle + half * r.node[k]);
  return half * sum;
}

template <int N, class F>
double rectangle(const Rect& r, F&& f) {
  return line<N>(r.u0, r.u1, [&](double s) { return line<N>(r.v0, r.v1, [&](double t) { return f(s, t); }); });
}

/// Rectangle cut by the unit circle. s = sin(a) turns the circle's edge into cos(a): smooth even where the rim is
/// vertical. The integral breaks where the circle crosses the rectangle's lower and upper edge.
template <int N, class F>
double cut_by_disc(const Rect& r, F&& f) {
  const double a0 = portable::asin(std::max(r.u0, -1.0)), a1 = portable::asin(std::min(r.u1, 1.0));
  std::array<double, 6> breaks{a0, a1, a1, a1, a1, a1};
  int count = 1;
  for (const double t : {std::abs(r.v0), std::abs(r.v1)}) {
    if (t >= 1) continue;
    for (const double a : {-portable::acos(t), portable::acos(t)})
      if (a > a0 && a < a1) breaks[count++] = a;
  }
  std::sort(breaks.begin(), breaks.end());
  double sum = 0;
  for (int k = 0; k + 1 < int(breaks.size()); ++k) {
    if (breaks[k] >= breaks[k + 1]) continue;
    sum += line<N>(breaks[k], breaks[k + 1], [&](double a) {
      const double s = portable::sin(a), edge = portable::cos(a);
      const double lo = std::max(r.v0, -edge), hi = std::min(r.v1, edge);
      return lo < hi ? edge * line<N>(lo, hi, [&](double t) { return f(s, t); }) : 0.0;
    });
  }
  return sum;
}

/// Integral of a density over the part of a rectangle inside the unit disc.
///
/// The densities of this project are analytic with their nearest pole at distance 1 or more, so N points on an interval
/// of length h err by about (h/4)^(2N): the orders below keep every texel within 1e-15 of its true value (tested
/// against sums of 4 pi and against finer subdivision).
/// @param r rectangle in (s,t). @param f density per ds dt.
template <class F>
double inside_disc(const Rect& r, F&& f) {
  const double near_s = std::clamp(0.0, r.u0, r.u1), near_t = std::clamp(0.0, r.v0, r.v1);
  if (near_s * near_s + near_t * near_t >= 1) return 0;
  const double side = std::max(r.u1 - r.u0, r.v1 - r.v0);
  if (side > 0.25) {
    const double s = 0.5 * (r.u0 + r.u1), t = 0.5 * (r.v0 + r.v1);
    return inside_disc({r.u0, r.v0, s, t}, f) + inside_disc({s, r.v0, r.u1, t}, f) +
           inside_disc({r.u0, t, s, r.v1}, f) + inside_disc({s, t, r.u1, r.v1}, f);
  }
  const double far_s = std::max(std::abs(r.u0), std::abs(r.u1)), far_t = std::max(std::abs(r.v0), std::abs(r.v1));
  if (far_s * far_s + far_t * far_t > 1) return cut_by_disc<12>(r, f);
  if (side > 0.02) return rectangle<8>(r, f);
  return side > 0.001 ? rectangle<3>(r, f) : rectangle<2>(r, f);
}

}  // namespace quadrature
}  // namespace envmap

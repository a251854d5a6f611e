// The integral of brdf(), for as many angles at once as a vector has lanes; compiled once for every instruction set and
// chosen at run time.
#include "envmap/prefilter/brdf_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "envmap/base/bounds.h"
#include "envmap/base/parallel.h"
#include "envmap/base/run_operation.h"
#include "envmap/base/without_avx512.h"
#include "envmap/maths/portable.h"
#include "envmap/maths/quadrature.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/prefilter/brdf_table.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "envmap/prefilter/lobe_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace envmap::prefiltering {
namespace HWY_NAMESPACE {

using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;

template <class T>
HWY_INLINE V broadcast(T c) {
  return broadcast(D(), c);
}
HWY_INLINE V square(V x) { return x * x; }
HWY_INLINE V cube_of(V x) { return x * square(x); }

// end x sinh(range x) of x in [0,1] and its derivative, for range = asinh(end / scale): nodes that lie as densely at 0
// as `scale` asks for, and ever sparser beyond, which suits what falls by powers of distance / scale.
struct Stretched {
  V scale, range;  // The range over ln 2.

  Stretched(V least, V end) : scale(least) {
    const V y = end / scale, root = hn::Sqrt(square(y) + broadcast(1));
    range = hn::Neg(log2_one_minus(D(), broadcast(1) - broadcast(1) / (y + root)));
  }
  HWY_INLINE void at(double x, V& value, V& slope) const {
    const V falling = exp2_small(D(), hn::Neg(range * broadcast(x))), rising = broadcast(1) / falling;
    const V half = scale * broadcast(0.5);
    value = half * (rising - falling);
    slope = half * broadcast(std::numbers::ln2) * (range * (rising + falling));
  }
};

// Directions of view with one roughness, and what is reflected.
struct Views {
  V cosine, sine, white, fresnel;
  double a2;

  // sqrt(a^2 + (1 - a^2) cos^2) of Smith's G: cos (1 + 2 lambda).
  [[nodiscard]] HWY_INLINE V smith(V c) const { return hn::Sqrt(broadcast(a2) + broadcast(1 - a2) * square(c)); }
  // All azimuths of light whose polar angle is that of the view + 2 atan(tangent), with a weight.
  HWY_INLINE void add_circle(V tangent, V weight) {
    const V one = broadcast(1), t2 = square(tangent), near = one / (one + t2);  // cos^2 d
    const V cos2d = (one - t2) * near, sin2d = (tangent + tangent) * near;
    const V light_cosine = hn::Max(hn::Zero(D()), cosine * cos2d - sine * sin2d);
    const V light_sine = hn::Max(hn::Zero(D()), sine * cos2d + cosine * sin2d);
    const V far = square(cosine - sine * tangent) * near;                      // cos^2 s
    const V least = broadcast(4) * (far * near * (t2 + broadcast(a2)));        // A - B
    const V most = broadcast(4) * (near * (one - far + broadcast(a2) * far));  // A + B
    const V both = broadcast(2) * (sine * light_sine), twice_far = far + far, two_both = both + both;
    // t = tan(psi / 4), whose peak at 0 is half as wide as that of tan(psi / 2).
    const Stretched azimuth(broadcast(0.5) * hn::Sqrt(least / most), one);
    const auto& rule = quadrature::rule<24>();
    V all = hn::Zero(D()), part = hn::Zero(D());
    for (std::size_t n = 0; n < rule.node.size(); ++n) {
      V t, slope;
      azimuth.at(0.5 + 0.5 * rule.node[n], t, slope);
      const V inverse = one / (one + square(t));
      const V h2 = square((t + t) * inverse);  // sin^2(psi / 2)
      const V vl = twice_far + both * h2, q = least + two_both * h2;
      const V value = broadcast(rule.weight[n]) * (slope * inverse) * square(vl / q);
      const V rest = hn::Max(hn::Zero(D()), one - hn::Sqrt(broadcast(0.5) * vl));  // 1 - cos(v,h)
      all += value;
      part += value * (square(rest) * cube_of(rest));
    }
    // G / (4 cos(n,v)), and 4 a^2 / pi of D; 4 x 2 x 1/2 of d psi, of both its signs and of the rule's [-1,1].
    const V masked = light_cosine / (cosine * smith(light_cosine) + light_cosine * smith(cosine));
    const V whole = weight * broadcast(8 * a2 / pi) * (light_sine * masked);
    white += whole * all;
    fresnel += whole * part;
  }
  // Light nearer to the normal (sign -1) or farther from it (1) than the view, to the tangent `end` of half its way.
  HWY_INLINE void add_side(V scale, V end, double sign) {
    const Stretched angle(scale, end);
    const auto& rule = quadrature::rule<20>();
    for (std::size_t n = 0; n < rule.node.size(); ++n) {
      V t, slope;
      angle.at(0.5 + 0.5 * rule.node[n], t, slope);
      add_circle(broadcast(sign) * t, broadcast(rule.weight[n]) * slope / (broadcast(1) + square(t)));
    }
  }
};

void BrdfRow(std::span<const double> cosines, double roughness, std::span<ScaleBias> out) {
  const D d;
  const double alpha = std::max(1e-6, roughness * roughness);
  alignas(64) std::array<double, 8> from{}, white{}, fresnel{};
  for (std::size_t first = 0; first < cosines.size(); first += hn::Lanes(d)) {
    const std::size_t count = std::min(hn::Lanes(d), cosines.size() - first);
    for (std::size_t k = 0; k < hn::Lanes(d); ++k) from[k] = cosines[first + std::min(k, count - 1)];
    const V c = hn::Load(d, from.data()), one = broadcast(1), s = hn::Sqrt(hn::Max(hn::Zero(d), one - square(c)));
    Views views{c, s, hn::Zero(d), hn::Zero(d), alpha * alpha};
    // G bends where light is as low as the view is.
    const V scale = one / (broadcast(1 / alpha) + broadcast(0.1) / c);
    views.add_side(scale, c / (one + s), 1);
    views.add_side(scale, s / (one + c), -1);
    hn::Store(views.white, d, white.data());
    hn::Store(views.fresnel, d, fresnel.data());
    for (std::size_t k = 0; k < count; ++k) out[first + k] = {white[k] - fresnel[k], fresnel[k]};
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap::prefiltering
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace envmap {
namespace prefiltering {

HWY_EXPORT(BrdfRow);

}  // namespace prefiltering

// With theta the polar angles of view and light, s and d half their sum and difference, psi the azimuth between light
// and the mirror direction:
//   1 + v.l = 2 cos^2 s + sin(v) sin(l) (1 - cos psi),  cos(n,h)^2 = (cos(v) + cos(l))^2 / (2 (1 + v.l)),
//   D(h) = 4 a^2 / pi x ((1 + v.l) / (A - B cos psi))^2,  A - B = 4 cos^2 s cos^2 d (tan^2 d + a^2),
//   A + B = 4 cos^2 d (sin^2 s + a^2 cos^2 s):
// a peak about d = 0 of the width a, and about psi = 0 of sqrt((A - B) / (A + B)). Light above the horizon is all that
// is integrated over: nothing breaks off within the range of the rules.
std::vector<ScaleBias> brdf(std::span<const double> cosines, double roughness) {
  for (const double cosine : cosines) check_range(limits::cosine, cosine);
  check_range(limits::roughness, roughness);
  std::vector<ScaleBias> found(cosines.size());
  HWY_DYNAMIC_DISPATCH(prefiltering::BrdfRow)(cosines, roughness, found);
  return found;
}

std::vector<Colour> brdf_table(int size, const Run& run) {
  check_range(limits::table_size, size);
  const auto n = std::size_t(size);
  std::vector<double> cosines;
  for (int i = 0; i < size; ++i) cosines.push_back((i + 0.5) / size);
  std::vector<Colour> table(n * n);
  run_operation(run, [&](const Progress& progress) {
    for_each_row(1, size, progress, [&](int, int j) {
      const std::vector<ScaleBias> row = brdf(cosines, (j + 0.5) / size);
      for (std::size_t i = 0; i < n; ++i) table[std::size_t(j) * n + i] = Colour(row[i].scale, row[i].bias, 0);
    });
  });
  return table;
}

namespace {

// Light from one direction: log2 of sin(n,h)^2, of which D is a power, and V cos(n,l) times the weight of the rule.
struct Sample {
  double log2_sine2, weight;
};

// Directions of light. Their cosines l lie in panels that grow by 4 from that of the view, as V bends there; l = high -
// w t^2 takes the square root out of sin(n,l). Their azimuths pi (1 - u^2) lie closest opposite the view, where h turns
// fastest.
std::vector<Sample> samples_for(double view) {
  const auto& lights = quadrature::rule<16>();
  const auto& azimuths = quadrature::rule<32>();
  std::vector<Sample> samples;
  for (double low = 0, high = view; low < 1; low = std::exchange(high, std::min(1.0, 4 * high)))
    for (std::size_t i = 0; i < lights.node.size(); ++i) {
      const double t = 0.5 + 0.5 * lights.node[i], light = high - (high - low) * t * t;
      const double sines = std::sqrt((1 - view * view) * (1 - light * light));
      const double seen = lights.weight[i] * (high - low) * t * light / (4 * (light + view - light * view));
      for (std::size_t k = 0; k < azimuths.node.size(); ++k) {
        const double u = 0.5 + 0.5 * azimuths.node[k];
        const double twice = 2 * (1 + view * light + sines * portable::cos_pi(1 - u * u));  // |v + l|^2
        const double cosine2 = std::min(1.0, (view + light) * (view + light) / twice);
        samples.push_back({portable::log1p(-cosine2) / std::numbers::ln2, seen * azimuths.weight[k] * u});
      }
    }
  return samples;
}

}  // namespace

std::vector<double> sheen_albedo(double cosine, std::span<const double> roughnesses) {
  check_range(limits::cosine, cosine);
  for (const double roughness : roughnesses) check_range(limits::roughness, roughness);
  const std::vector<Sample> samples = samples_for(cosine);
  std::vector<double> albedos;
  for (const double roughness : roughnesses) {
    const double power = 1 / std::max(9e-4, roughness * roughness);
    double sum = 0;
    for (const Sample& s : samples)
      if (const double x = 0.5 * power * s.log2_sine2; x > -200) sum += s.weight * portable::exp2(x);
    albedos.push_back((2 + power) * sum);
  }
  return albedos;
}

std::vector<Colour> sheen_table(int size, const Run& run) {
  check_range(limits::table_size, size);
  const auto n = std::size_t(size);
  std::vector<double> roughnesses;
  for (int j = 0; j < size; ++j) roughnesses.push_back((j + 0.5) / size);
  std::vector<Colour> table(n * n);
  run_operation(run, [&](const Progress& progress) {
    for_each_row(1, size, progress, [&](int, int i) {
      const std::vector<double> column = sheen_albedo((i + 0.5) / size, roughnesses);
      for (std::size_t j = 0; j < n; ++j) table[j * n + std::size_t(i)] = Colour(float(column[j]));
    });
  });
  return table;
}

}  // namespace envmap
#endif  // HWY_ONCE

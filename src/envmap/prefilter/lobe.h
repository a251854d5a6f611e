/// @file
/// Lobes: the kernels of a prefilter, radially symmetric about the direction asked for.
///
/// A lobe is a small type over x = 1 - cos(angle to the middle), x in [0,2], so that narrow lobes keep their digits. All
/// are 0 below the horizon (x >= 1) and integrate to 1 over the sphere: white stays white. Each has
///   value(x)            per steradian, never rising with x
///   share(x)            part of the lobe within x, in [0,1]; missing(x) = 1 - share(x) with its own digits
///   rate(x)             -d ln(value) / dx: how fast it falls
///   width()             x at which it has fallen to about 1/e
/// and, for vectors of floats in lanes-inl.h, the same value and the size of its 2nd and 3rd derivative, which are monotonic.
#pragma once

#include <algorithm>
#include <cmath>
#include <variant>

#include "envmap/base/export.h"
#include "envmap/maths/vector.h"

namespace ENVMAP_EXPORT envmap {

/// Lambert's cosine: value = cos / pi. A diffuse map is the irradiance over pi of a plane that faces the direction.
struct Cosine {
  [[nodiscard]] double value(double x) const { return std::max(0.0, 1 - x) / pi; }
  [[nodiscard]] double share(double x) const { return x >= 1 ? 1 : x * (2 - x); }
  [[nodiscard]] double missing(double x) const { return x >= 1 ? 0 : (1 - x) * (1 - x); }
  [[nodiscard]] double rate(double x) const { return x < 1 ? 1 / (1 - x) : 0; }
  [[nodiscard]] double width() const { return 0.63; }
};

/// Phong's lobe: value = (m+1) / (2 pi) cos^m, m >= 0 (Phong 1975; normalised as Lafortune and Willems 1994).
struct Phong {
  double exponent;

  [[nodiscard]] double scale() const { return (exponent + 1) / (2 * pi); }
  [[nodiscard]] double value(double x) const { return x < 1 ? scale() * std::exp(exponent * std::log1p(-x)) : 0; }
  [[nodiscard]] double share(double x) const { return x < 1 ? -std::expm1((exponent + 1) * std::log1p(-x)) : 1; }
  [[nodiscard]] double missing(double x) const { return x < 1 ? std::exp((exponent + 1) * std::log1p(-x)) : 0; }
  [[nodiscard]] double rate(double x) const { return x < 1 ? exponent / (1 - x) : 0; }
  [[nodiscard]] double width() const { return 0.63 * std::min(1.0, 2 / (exponent + 1)); }
};

/// Trowbridge and Reitz's distribution (1975; "GGX": Walter et al. 2007) as the split sum wants it (Karis 2013, "Real
/// shading in Unreal Engine 4"): n = v = r and weights cos(n, l). The half vector leans half as far as l does, so with
/// cos(n,h)^2 = (2 - x) / 2 and the Jacobian 1 / (4 cos(v,h)), sampling D(h) cos(n,h) gives l the density D / 4:
///   value ~ cos / (A + B x)^2,  A = 2 a^2,  B = 1 - a^2,  a = roughness^2 (Burley 2012).
struct Ggx {
  double a, b, scale;  ///< A, B and what makes the integral 1.

  /// @param roughness perceptual, 0 to 1; below 1e-3 as 1e-3, which is narrower than a texel of any map.
  explicit Ggx(double roughness) {
    const double alpha = std::max(1e-6, roughness * roughness);
    a = 2 * alpha * alpha;
    b = (1 - alpha) * (1 + alpha);
    scale = 1 / (2 * pi * whole(1));
  }
  [[nodiscard]] double value(double x) const {
    const double q = a + b * x;
    return x < 1 ? scale * (1 - x) / (q * q) : 0;
  }
  [[nodiscard]] double share(double x) const { return x < 1 ? 2 * pi * scale * whole(x) : 1; }
  [[nodiscard]] double missing(double x) const {
    if (x >= 1) return 0;
    const double q = a + b * x, t = b * (1 - x) / q;
    return 2 * pi * scale * (1 - x) * (1 - x) / (q * q) * shape(t);
  }
  [[nodiscard]] double rate(double x) const { return x < 1 ? 1 / (1 - x) + 2 * b / (a + b * x) : 0; }
  [[nodiscard]] double width() const { return std::min(0.63, 0.65 * a); }

 private:
  /// (t - ln(1+t)) / t^2 = integral of (1-w)/(1+tw)^2 over [0,1]; 1/2 at t = 0.
  static double shape(double t) {
    if (t > 0.05) return (t - std::log1p(t)) / (t * t);
    double sum = 0;
    for (int k = 12; k >= 2; --k) sum = 1.0 / k - t * sum;
    return sum;
  }
  /// Integral of (1-w)/(A+Bw)^2 from 0 to x.
  [[nodiscard]] double whole(double x) const {
    // 1-w = (1-x) + (x-w): two terms above 0.
    return (1 - x) * x / (a * (a + b * x)) + x * x / (a * a) * shape(b * x / a);
  }
};

using Lobe = std::variant<Cosine, Phong, Ggx>;

/// The lobe just above its horizon, over its peak: 1 where it is a step (an exponent of 0), 0.03 for an exponent of 0.5.
inline double at_horizon(const Lobe& lobe) {
  return std::visit([](const auto& l) { return l.value(0.999) / l.value(0); }, lobe);
}
inline constexpr double broken = 0.4, bent = 0.1, steep = 0.005;  ///< Above that: exponents below 0.13, 0.33 and 0.77.

}  // namespace envmap

/// @file
/// The lobes' formulae: kernels of a prefilter, radially symmetric about the output's direction.
///
/// Each is a small type over x = 1 - cos(angle to the middle), x in [0,2], so that narrow lobes keep their digits.
/// lobe_lanes-inl.h has its formula for vectors of lanes.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <variant>

#include "envmap/maths/vector.h"
#include "envmap/prefilter/lobe.h"

namespace envmap {

/// Every lobe is 0 below the horizon (x >= 1), rises with x up to a peak and falls from there. Its integral over the
/// sphere is 1, so that white stays white. The methods rely on all of this.
template <class L>
concept RadialLobe = requires(const L& l, double x) {
  { l.value(x) } -> std::same_as<double>;    ///< Per steradian.
  { l.share(x) } -> std::same_as<double>;    ///< Integral of the lobe within x (its cdf), in [0,1].
  { l.missing(x) } -> std::same_as<double>;  ///< 1 - share(x) (its ccdf), with its own digits.
  { l.peak() } -> std::same_as<double>;      ///< x at which it is largest; 0 but for sheen.
  { l.rate(x) } -> std::same_as<double>;     ///< Upper bound of |d ln(value) / dx|.
  { l.width() } -> std::same_as<double>;     ///< About the x at which it has fallen to 1/e.
  { l.kink() } -> std::same_as<double>;      ///< The jump of its slope at the horizon, where the lobe is continuous.
};

/// Lambert's cosine: value = cos / pi. A diffuse map is the irradiance over pi of a plane that faces the direction.
struct Cosine {
  [[nodiscard]] double value(double x) const { return std::max(0.0, 1 - x) / pi; }
  [[nodiscard]] double share(double x) const { return x >= 1 ? 1 : x * (2 - x); }
  [[nodiscard]] double missing(double x) const { return x >= 1 ? 0 : (1 - x) * (1 - x); }
  [[nodiscard]] double rate(double x) const { return x < 1 ? 1 / (1 - x) : 0; }
  [[nodiscard]] double peak() const { return 0; }
  [[nodiscard]] double width() const { return 0.63; }
  [[nodiscard]] double kink() const { return 1 / pi; }
};

/// Phong's lobe: value = (m+1) / (2 pi) cos^m, m >= 0 (Phong 1975; normalised as Lafortune and Willems 1994).
struct Phong {
  double exponent;

  [[nodiscard]] double scale() const { return (exponent + 1) / (2 * pi); }
  [[nodiscard]] double value(double x) const;
  [[nodiscard]] double share(double x) const;
  [[nodiscard]] double missing(double x) const;
  [[nodiscard]] double rate(double x) const { return x < 1 ? exponent / (1 - x) : 0; }
  [[nodiscard]] double peak() const { return 0; }
  [[nodiscard]] double width() const { return 0.63 * std::min(1.0, 2 / (exponent + 1)); }
  [[nodiscard]] double kink() const { return 0; }  ///< Exponent 1 is Cosine.
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
  [[nodiscard]] double peak() const { return 0; }
  [[nodiscard]] double width() const { return std::min(0.63, 0.65 * a); }
  [[nodiscard]] double kink() const { return scale / ((a + b) * (a + b)); }

 private:
  /// (t - ln(1+t)) / t^2 = integral of (1-w)/(1+tw)^2 over [0,1]; 1/2 at t = 0.
  static double shape(double t);
  /// Integral of (1-w)/(A+Bw)^2 from 0 to x.
  [[nodiscard]] double whole(double x) const {
    // 1-w = (1-x) + (x-w): two terms above 0.
    return (1 - x) * x / (a * (a + b * x)) + x * x / (a * a) * shape(b * x / a);
  }
};

/// Blinn's distribution (1977, "Models of light reflection for computer synthesized pictures"), D(h) ~ cos(n,h)^m, m >=
/// 0, in the place of Trowbridge and Reitz's: value ~ cos (1 - x/2)^(m/2). About as wide as Phong's of m / 4, and
/// without its step at the horizon.
struct BlinnPhong {
  double power, scale;  ///< m / 2, and what makes the integral 1.
  double at_horizon;    ///< D there, over that in the middle.

  explicit BlinnPhong(double exponent);
  [[nodiscard]] double value(double x) const;
  [[nodiscard]] double share(double x) const;
  [[nodiscard]] double missing(double x) const { return x < 1 ? 2 * pi * scale * rest(std::max(0.0, x)) : 0; }
  [[nodiscard]] double rate(double x) const { return x < 1 ? 1 / (1 - x) + power / (2 - x) : 0; }
  [[nodiscard]] double peak() const { return 0; }
  [[nodiscard]] double width() const { return 0.63 * std::min(1.0, 4 / (power + 2)); }
  [[nodiscard]] double kink() const { return scale * at_horizon; }

 private:
  /// Integral of (1-x) (1-x/2)^power from x to 1.
  [[nodiscard]] double rest(double x) const;
};

/// Sheen of cloth, of Estevez and Kulla's distribution ("Charlie": 2017, "Production friendly microfacet sheen BRDF"),
/// D(h) ~ sin(n,h)^(1/a), a = roughness^2, in the place of Trowbridge and Reitz's, as the sheen of glTF is prefiltered:
/// sin(n,h)^2 = x/2 makes it value ~ cos x^p, p = 1 / (2 a). It rises from 0 in the middle.
struct Charlie {
  double power;

  /// @param roughness perceptual, 0 to 1; below 0.03 as 0.03, a ring a third of a degree wide.
  explicit Charlie(double roughness) : power(0.5 / std::max(9e-4, roughness * roughness)) {}
  [[nodiscard]] double scale() const { return (power + 1) * (power + 2) / (2 * pi); }
  [[nodiscard]] double value(double x) const;
  [[nodiscard]] double share(double x) const;
  [[nodiscard]] double missing(double x) const;
  [[nodiscard]] double peak() const { return power / (power + 1); }
  [[nodiscard]] double rate(double x) const { return x < 1 ? power / std::max(1e-300, x) + 1 / (1 - x) : 0; }
  [[nodiscard]] double width() const { return 0.63 / (power + 1); }
  [[nodiscard]] double kink() const { return scale(); }
};

/// The formula of a lobe that is no mirror's.
using LobeFormula = std::variant<Cosine, Phong, Ggx, BlinnPhong, Charlie>;
static_assert(RadialLobe<Cosine> && RadialLobe<Phong> && RadialLobe<Ggx> && RadialLobe<BlinnPhong> &&
              RadialLobe<Charlie>);

/// Lobes that are the diffuse one, such as phong of exponent 1, are Cosine. Tables have no formula, but tabulated/.
LobeFormula formula_of(const Lobe& lobe);

}  // namespace envmap

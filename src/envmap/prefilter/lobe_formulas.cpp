// Closed forms of the lobes and of their integrals. Where a closed form loses digits to cancellation, its series takes
// over.
#include "envmap/prefilter/lobe_formulas.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "envmap/maths/portable.h"

namespace envmap {

namespace {

constexpr double max_factors = 8;  // Small whole powers are products.

bool is_product(double power) { return power <= max_factors && power == std::floor(power); }

// (1 - x)^power.
double power_of(double x, double power) {
  if (!is_product(power)) return portable::exp(power * portable::log1p(-x));
  double product = 1;
  for (int k = 0; k < int(power); ++k) product *= 1 - x;
  return product;
}

}  // namespace

double Phong::value(double x) const { return x < 1 ? scale() * power_of(x, exponent) : 0; }
double Phong::missing(double x) const { return x < 1 ? power_of(x, exponent + 1) : 0; }
double Phong::share(double x) const {
  if (x >= 1) return 1;
  if (!is_product(exponent)) return -portable::expm1((exponent + 1) * portable::log1p(-x));
  double sum = 1;  // 1 - t^(m+1) = (1 - t) (1 + t + ... + t^m)
  for (int k = 0; k < int(exponent); ++k) sum = 1 + (1 - x) * sum;
  return x * sum;
}

BlinnPhong::BlinnPhong(double exponent)
    : power(0.5 * exponent), scale(1 / (2 * pi * rest(0))), at_horizon(portable::exp(-power * std::numbers::ln2)) {}
double BlinnPhong::value(double x) const {
  return x < 1 ? scale * (1 - x) * portable::exp(power * portable::log1p(-0.5 * x)) : 0;
}
// With q = 1 - x/2: the integral of (2q - 1) q^p 2 dq.
double BlinnPhong::share(double x) const {
  if (x >= 1) return 1;
  const double log = portable::log1p(-0.5 * x);
  return 4 * pi * scale *
         (portable::expm1((power + 1) * log) / (power + 1) - 2 * portable::expm1((power + 2) * log) / (power + 2));
}
// With w = 1 - x: the integral of w ((1+w)/2)^p dw.
double BlinnPhong::rest(double x) const {
  const double w = 1 - x, log = portable::log1p(w), half = portable::exp(-power * std::numbers::ln2);
  // The closed form loses what w^2 is below 1, and beyond floats is no more than its largest terms.
  if ((power + 2) * w < 1e-4) return half * w * w * (0.5 + power * w * (1.0 / 3 + (power - 1) * w / 8));
  if (power * log > 40)
    return portable::exp(power * portable::log1p(-0.5 * x)) * (1 + w) * ((1 + w) / (power + 2) - 1 / (power + 1));
  return half * (portable::expm1((power + 2) * log) / (power + 2) - portable::expm1((power + 1) * log) / (power + 1));
}

double Charlie::value(double x) const {
  return x > 0 && x < 1 ? scale() * (1 - x) * portable::exp(power * portable::log(x)) : 0;
}
double Charlie::share(double x) const {
  if (x <= 0) return 0;
  return x < 1 ? portable::exp((power + 1) * portable::log(x)) * (1 + (power + 1) * (1 - x)) : 1;
}
// With y = 1 - x and n = p + 1: 1 - (1-y)^n (1 + n y), the integral of n (n+1) w (1-w)^(n-1) from 0 to y.
double Charlie::missing(double x) const {
  const double y = std::min(1.0, 1 - x), n = power + 1;
  if (y <= 0) return 0;
  if (n * y > 0.1) return 1 - (y < 1 ? portable::exp(n * portable::log1p(-y)) : 0) * (1 + n * y);
  double sum = 0, term = n * (n + 1) * y * y;
  for (int k = 0; k < 12; ++k) {
    sum += term / (k + 2);
    term *= -y * (n - 1 - k) / (k + 1);
  }
  return sum;
}

double Ggx::shape(double t) {
  if (t > 0.05) return (t - portable::log1p(t)) / (t * t);
  double sum = 0;
  for (int k = 12; k >= 2; --k) sum = 1.0 / k - t * sum;
  return sum;
}

LobeFormula formula_of(const Lobe& lobe) {
  const double parameter = lobe.parameter();
  switch (lobe.shape()) {
    case LobeShape::diffuse: return Cosine{};
    case LobeShape::phong: return parameter == 1 ? LobeFormula(Cosine{}) : LobeFormula(Phong{parameter});
    case LobeShape::blinn_phong: return parameter == 0 ? LobeFormula(Cosine{}) : LobeFormula(BlinnPhong(parameter));
    case LobeShape::ggx: return Ggx(parameter);
    case LobeShape::table: throw std::logic_error("a table has no formula: tabulated/ sums it");
    case LobeShape::charlie: break;
  }
  return Charlie(parameter);
}

}  // namespace envmap

#include "envmap/prefilter/lobe.h"

#include "envmap/maths/portable.h"

namespace envmap {

double Phong::value(double x) const { return x < 1 ? scale() * portable::exp(exponent * portable::log1p(-x)) : 0; }
double Phong::share(double x) const { return x < 1 ? -portable::expm1((exponent + 1) * portable::log1p(-x)) : 1; }
double Phong::missing(double x) const { return x < 1 ? portable::exp((exponent + 1) * portable::log1p(-x)) : 0; }

double Ggx::shape(double t) {
  if (t > 0.05) return (t - portable::log1p(t)) / (t * t);
  double sum = 0;
  for (int k = 12; k >= 2; --k) sum = 1.0 / k - t * sum;
  return sum;
}

}  // namespace envmap

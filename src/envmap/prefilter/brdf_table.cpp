#include "envmap/prefilter/brdf_table.h"

#include <algorithm>
#include <cmath>

#include "envmap/maths/quadrature.h"
#include "envmap/base/parallel.h"
#include "envmap/maths/portable.h"

namespace envmap {
namespace {

// Of Smith's G: (-1 + sqrt(1 + alpha^2 tan^2)) / 2.
double lambda(double cosine, double alpha) {
  const double c2 = cosine * cosine;
  return 0.5 * (std::sqrt(1 + alpha * alpha * (1 - c2) / c2) - 1);
}

}  // namespace

ScaleBias brdf(double cosine, double roughness, int azimuths) {
  const double alpha = std::max(1e-6, roughness * roughness), a2 = alpha * alpha;
  const Direction v(std::sqrt(std::max(0.0, 1 - cosine * cosine)), 0, cosine);
  const double masked = lambda(cosine, alpha);
  // Half vectors by D(h) cos(n,h): u = share of them nearer to the normal. What D G F / (4 cos(n,v)) has more than that
  // density, 1 / (4 cos(v,h)) of it, is G cos(v,h) / (cos(n,v) cos(n,h)).
  const auto inner = [&](double u, double phi, double& fresnel) {
    const double h2 = (1 - u) / (1 + (a2 - 1) * u), hz = std::sqrt(h2), hx = std::sqrt(std::max(0.0, 1 - h2));
    const Direction h(hx * portable::cos(phi), hx * portable::sin(phi), hz);
    const double vh = glm::dot(v, h), nl = 2 * vh * hz - cosine;
    fresnel = 0;
    if (nl <= 0 || vh <= 0) return 0.0;
    fresnel = portable::pow(1 - std::min(1.0, vh), 5);
    return vh / (cosine * hz * (1 + masked + lambda(nl, alpha)));
  };
  // u near 1 is where the tail is: panels that halve towards it.
  const auto& rule = quadrature::rule<8>();
  const int panels = azimuths * 3 / 8;
  ScaleBias sum{0, 0};
  double lo = 0;
  for (int panel = 1; panel <= panels; ++panel) {
    const double hi = panel == panels ? 1 : 1 - std::ldexp(1.0, -panel);
    for (std::size_t n = 0; n < 8; ++n) {
      const double u = 0.5 * (lo + hi) + 0.5 * (hi - lo) * rule.node[n];
      for (int k = 0; k < azimuths; ++k) {
        double fresnel = 0;
        const double value = inner(u, pi * (k + 0.5) / azimuths, fresnel);
        const double weight = 0.5 * (hi - lo) * rule.weight[n] / azimuths * value;
        sum.scale += weight * (1 - fresnel);
        sum.bias += weight * fresnel;
      }
    }
    lo = hi;
  }
  return sum;
}

std::vector<Colour> brdf_table(int size, const Progress& progress, int azimuths) {
  std::vector<Colour> table(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  for_each_row(1, size, progress, [&](int, int j) {
    for (int i = 0; i < size; ++i) {
      const ScaleBias found = brdf((i + 0.5) / size, (j + 0.5) / size, azimuths);
      table[static_cast<std::size_t>(j) * static_cast<std::size_t>(size) + static_cast<std::size_t>(i)] =
          Colour(found.scale, found.bias, 0);
    }
  });
  return table;
}

}  // namespace envmap

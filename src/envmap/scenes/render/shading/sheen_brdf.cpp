#include "envmap/scenes/render/shading/sheen_brdf.h"

#include <algorithm>
#include <cmath>

#include "envmap/base/parallel.h"
#include "envmap/maths/quadrature.h"

namespace envmap {
namespace {

double alpha_of(double roughness) { return std::pow(std::max(least_sheen_roughness, roughness), 2); }

// Lambda of Smith's masking, fitted by Estevez and Kulla to what they simulated.
double lambda(double cosine, double alpha) {
  const double t = (1 - alpha) * (1 - alpha);
  const double a = 21.5473 + (25.3245 - 21.5473) * t, b = 3.82987 + (3.32435 - 3.82987) * t,
               c = 0.19823 + (0.16801 - 0.19823) * t, d = -1.97760 + (-1.27393 + 1.97760) * t,
               e = -4.32054 + (-4.85967 + 4.32054) * t;
  const auto l = [&](double x) { return a / (1 + b * std::pow(x, c)) + d * x + e; };
  return std::exp(cosine < 0.5 ? l(cosine) : 2 * l(0.5) - l(std::max(0.0, 1 - cosine)));
}

// White light from all round: over x, cos(n,l) = x^2, and half the azimuths. Off by 1e-5.
double albedo(double nv, double roughness) {
  const auto along = [](double cosine) { return std::sqrt(std::max(0.0, 1 - cosine * cosine)); };
  return quadrature::line<24>(0, 1, [&](double x) {
    const double nl = x * x;
    return 4 * x * nl * quadrature::line<24>(0, pi, [&](double azimuth) {
             const double vl = nv * nl + along(nv) * along(nl) * std::cos(azimuth);
             return sheen((nv + nl) / std::sqrt(2 + 2 * vl), nv, nl, roughness);
           });
  });
}

}  // namespace

double sheen(double nh, double nv, double nl, double roughness) {
  const double alpha = alpha_of(roughness), sine2 = std::max(0.0, 1 - nh * nh);
  const double distribution = (2 + 1 / alpha) * std::pow(sine2, 0.5 / alpha) / (2 * pi);
  return distribution / ((1 + lambda(nv, alpha) + lambda(nl, alpha)) * 4 * nv * nl);
}

const std::vector<float>& sheen_table() {
  static const std::vector<float> table = [] {
    constexpr int n = sheen_table_size;
    std::vector<float> made;
    for (const auto& row : map_rows<std::vector<float>>(n, [&](int j) {
           std::vector<float> of_row;
           for (int i = 0; i < n; ++i) of_row.push_back(float(std::min(1.0, albedo((i + 0.5) / n, (j + 0.5) / n))));
           return of_row;
         }))
      made.insert(made.end(), row.begin(), row.end());
    return made;
  }();
  return table;
}

double sheen_albedo(double nv, double roughness) {
  constexpr int n = sheen_table_size;
  const std::vector<float>& table = sheen_table();
  const double x = std::clamp(nv * n - 0.5, 0.0, n - 1.0), y = std::clamp(roughness * n - 0.5, 0.0, n - 1.0);
  const int i = std::min(int(x), n - 2), j = std::min(int(y), n - 2);
  const float* a = &table[j * n + i];
  return std::lerp(std::lerp(a[0], a[1], x - i), std::lerp(a[n], a[n + 1], x - i), y - j);
}

}  // namespace envmap

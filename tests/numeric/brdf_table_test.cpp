// The split sum's table against limits and an integral over directions of light.
#include "envmap/prefilter/brdf_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "envmap/maths/vector.h"

namespace envmap {
namespace {

TEST(BrdfTable, SmoothIsFresnelAndAllReflectNoMoreThanThereIs) {
  for (const double c : {0.1, 0.5, 0.9}) {
    const ScaleBias smooth = brdf(c, 0.01);
    EXPECT_NEAR(smooth.bias, std::pow(1 - c, 5), 1e-3);
    EXPECT_NEAR(smooth.scale, 1 - std::pow(1 - c, 5), 1e-3);
    for (const double r : {0.2, 0.6, 1.0}) {
      const ScaleBias b = brdf(c, r);
      EXPECT_GT(b.scale, 0);
      EXPECT_GE(b.bias, 0);
      EXPECT_LE(b.scale + b.bias, 1 + 1e-6);
    }
  }
}

TEST(BrdfTable, AgreesWithAnIntegralOverDirectionsOfLight) {
  for (const auto& [cosine, roughness] : {std::pair{0.3, 0.5}, {0.8, 0.7}, {0.5, 1.0}}) {
    const double a2 = std::pow(roughness, 4);
    const Direction v(std::sqrt(1 - cosine * cosine), 0, cosine);
    const auto smith = [&](double c) { return std::sqrt(a2 + (1 - a2) * c * c); };
    double scale = 0, bias = 0;
    constexpr int n = 700;
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) {
        const double z = (j + 0.5) / n, s = std::sqrt(1 - z * z), phi = 2 * pi * (k + 0.5) / n;
        const Direction l(s * std::cos(phi), s * std::sin(phi), z), h = glm::normalize(l + v);
        const double nh = h.z * h.z * (a2 - 1) + 1, d = a2 / (pi * nh * nh);
        const double g = 2 * z * cosine / (cosine * smith(z) + z * smith(cosine));
        const double f = std::pow(1 - glm::dot(v, h), 5), value = d * g / (4 * cosine) * 2 * pi / (1.0 * n * n);
        scale += value * (1 - f);
        bias += value * f;
      }
    EXPECT_NEAR(brdf(cosine, roughness).scale, scale, 2e-4);
    EXPECT_NEAR(brdf(cosine, roughness).bias, bias, 2e-4);
  }
}

}  // namespace
}  // namespace envmap

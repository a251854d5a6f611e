// The split sum's table against limits, an integral over half vectors and one over directions of light.
#include "envmap/prefilter/brdf_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "envmap/maths/quadrature.h"
#include "envmap/maths/vector.h"

namespace envmap::brdf_table_test {
namespace {

ScaleBias one(double cosine, double roughness) { return brdf(std::span(&cosine, 1), roughness)[0]; }

// By half vectors that follow D(h) cos(n,h), u = share of them nearer to the normal, in panels that halve towards the
// tail. What D G F / (4 cos(n,v)) has more than that density, 1 / (4 cos(v,h)) of it, is G cos(v,h) / (cos(n,v)
// cos(n,h)). The horizon of light cuts through the range: it takes so many azimuths to be right to 1e-6.
ScaleBias over_half_vectors(double cosine, double roughness) {
  constexpr int azimuths = 4096, panels = 40;
  const double a2 = std::pow(roughness, 4), sine = std::sqrt(1 - cosine * cosine);
  const auto lambda = [&](double c) { return 0.5 * (std::sqrt(1 + a2 * (1 - c * c) / (c * c)) - 1); };
  ScaleBias sum{0, 0};
  const auto over_azimuths = [&](double u, double weight) {
    const double h2 = (1 - u) / (1 + (a2 - 1) * u), hz = std::sqrt(h2), hx = std::sqrt(1 - h2);
    for (int k = 0; k < azimuths; ++k) {
      const double vh = sine * hx * std::cos(pi * (k + 0.5) / azimuths) + cosine * hz, nl = 2 * vh * hz - cosine;
      if (nl <= 0 || vh <= 0) continue;
      const double value = weight / azimuths * vh / (cosine * hz * (1 + lambda(cosine) + lambda(nl)));
      const double fresnel = std::pow(1 - std::min(1.0, vh), 5);
      sum.scale += value * (1 - fresnel), sum.bias += value * fresnel;
    }
  };
  double lo = 0;
  for (int panel = 1; panel <= panels; ++panel) {
    const double hi = panel == panels ? 1 : 1 - std::ldexp(1.0, -panel);
    for (int part = 0; part < 8; ++part) {  // The horizon's start is a kink in u.
      const double from = lo + (hi - lo) * part / 8, to = lo + (hi - lo) * (part + 1) / 8;
      const auto& rule = quadrature::rule<8>();
      for (std::size_t n = 0; n < 8; ++n)
        over_azimuths(0.5 * (from + to) + 0.5 * (to - from) * rule.node[n], 0.5 * (to - from) * rule.weight[n]);
    }
    lo = hi;
  }
  return sum;
}

TEST(BrdfTable, IsRightTo1e5AgainstTheIntegralOverHalfVectors) {
  for (const auto& [cosine, roughness] : {std::pair{1 / 256.0, 255 / 256.0},
                                          {1 / 256.0, 0.5},
                                          {1 / 256.0, 0.1},
                                          {0.02, 0.3},
                                          {0.1, 0.05},
                                          {0.3, 0.7},
                                          {0.6, 0.2},
                                          {0.9, 0.9},
                                          {255 / 256.0, 0.4}}) {
    const ScaleBias found = one(cosine, roughness), truth = over_half_vectors(cosine, roughness);
    EXPECT_NEAR(found.scale, truth.scale, 1e-5) << cosine << " " << roughness;
    EXPECT_NEAR(found.bias, truth.bias, 1e-5) << cosine << " " << roughness;
  }
}

TEST(BrdfTable, SmoothIsFresnelAndAllReflectNoMoreThanThereIs) {
  for (const double c : {1 / 2048.0, 0.1, 0.5, 0.9, 1.0}) {
    for (const double r : {0.0, 1 / 2048.0, 0.01}) {
      // A mirror, whose masking is all there is to change it: of a slope beyond 1 / tan, about alpha / (2 cos).
      const double tolerance = 1e-5 + r * r / c;
      EXPECT_NEAR(one(c, r).bias, std::pow(1 - c, 5), tolerance) << c << " " << r;
      EXPECT_NEAR(one(c, r).scale, 1 - std::pow(1 - c, 5), tolerance) << c << " " << r;
    }
    for (const double r : {0.2, 0.6, 1.0}) {
      const ScaleBias b = one(c, r);
      EXPECT_GT(b.scale, 0);
      EXPECT_GE(b.bias, 0);
      EXPECT_LE(b.scale + b.bias, 1 + 1e-6);
    }
  }
}

// Of alpha = 1 D is 1 / pi and G 2 l v / (v + l) with l and v the cosines: what is reflected of F = 1 is the integral
// of l / (v + l), 1 - v ln((1 + v) / v).
TEST(BrdfTable, RoughnessOneHasAClosedForm) {
  for (const double v : {1 / 2048.0, 1 / 256.0, 0.1, 0.5, 1.0})
    EXPECT_NEAR(one(v, 1).scale + one(v, 1).bias, 1 - v * std::log((1 + v) / v), 1e-5) << v;
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
    EXPECT_NEAR(one(cosine, roughness).scale, scale, 2e-4);
    EXPECT_NEAR(one(cosine, roughness).bias, bias, 2e-4);
  }
}

double one_sheen(double cosine, double roughness) { return sheen_albedo(cosine, std::span(&roughness, 1))[0]; }

// By half vectors that follow D(h) cos(n,h), whose share u nearer to the normal is sin(n,h)^(p + 2): midpoints in
// azimuth and in x, u = 1 - x^3, which lie closest at the horizon.
double sheen_over_half_vectors(double cosine, double roughness) {
  constexpr int n = 1500;
  const double power = 1 / std::max(9e-4, roughness * roughness), sine = std::sqrt(1 - cosine * cosine);
  double sum = 0;
  for (int j = 0; j < n; ++j) {
    const double x = (j + 0.5) / n, hx = std::pow(1 - x * x * x, 1 / (power + 2)), hz = std::sqrt(1 - hx * hx);
    for (int k = 0; k < n; ++k) {
      const double vh = sine * hx * std::cos(pi * (k + 0.5) / n) + cosine * hz, nl = 2 * vh * hz - cosine;
      if (nl > 0 && vh > 0)  // 4 (v.h) V cos(n,l) / cos(n,h)
        sum += 3 * x * x * vh * nl / ((nl + cosine - nl * cosine) * hz);
    }
  }
  return sum / n / n;
}

TEST(SheenTable, AgreesWithTheIntegralOverHalfVectors) {
  for (const auto& [cosine, roughness] : {std::pair{1 / 256.0, 0.5},
                                          {1 / 256.0, 1.0},
                                          {0.02, 0.1},
                                          {0.1, 0.3},
                                          {0.5, 0.5},
                                          {0.9, 1.0},
                                          {0.7, 0.2},
                                          {1.0, 0.6}}) {
    const double truth = sheen_over_half_vectors(cosine, roughness);
    EXPECT_NEAR(one_sheen(cosine, roughness), truth, 2e-5 * (1 + truth)) << cosine << " " << roughness;
  }
}

// Of a view along the normal, sin(n,h)^2 = (1 - l) / 2 and V = 1/4: an integral over l alone, (p + 2) 2^(-p/2) / 4 of
// (1 - l)^(p/2) l, which is 1 / ((p/2 + 1) (p/2 + 2)) over [0,1].
TEST(SheenTable, StraightAheadHasAClosedForm) {
  for (const double r : {0.4, 0.7, 1.0}) {
    const double half = 0.5 / (r * r), truth = (2 * half + 2) * std::pow(2, -half) / 4 / ((half + 1) * (half + 2));
    EXPECT_NEAR(one_sheen(1, r), truth, 1e-9) << r;
  }
}

TEST(SheenTable, HoldsTheAlbedoInAllChannels) {
  const std::vector<Colour> table = sheen_table(8);
  EXPECT_EQ(table[2 * 8 + 5], Colour(float(one_sheen(5.5 / 8, 2.5 / 8))));
}

}  // namespace
}  // namespace envmap::brdf_table_test

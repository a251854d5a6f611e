// Nine colours of a map, put through the formulae that engines' shaders have, against irradiance in closed form.
#include "envmap/prefilter/shader_sh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "envmap/base/error.h"
#include "envmap/operate/generate.h"
#include "envmap/prefilter/harmonics_window.h"

namespace shader_sh_test {
namespace {

using namespace envmap;

// shGetIrradianceAt() of three.js, src/renderers/shaders/ShaderChunk/lights_pars_begin.glsl.js.
double three(const ShaderSh& c, const Direction& n) {
  const double x = n.x, y = n.y, z = n.z;
  return c[0].x * 0.886227 + c[1].x * 2 * 0.511664 * y + c[2].x * 2 * 0.511664 * z + c[3].x * 2 * 0.511664 * x +
         c[4].x * 2 * 0.429043 * x * y + c[5].x * 2 * 0.429043 * y * z + c[6].x * (0.743125 * z * z - 0.247708) +
         c[7].x * 2 * 0.429043 * x * z + c[8].x * 0.429043 * (x * x - y * y);
}

// Ramamoorthi and Hanrahan 2001, equation 13.
double ramamoorthi(const ShaderSh& l, const Direction& n) {
  constexpr double c1 = 0.429043, c2 = 0.511664, c3 = 0.743125, c4 = 0.886227, c5 = 0.247708;
  return c1 * l[8].x * (n.x * n.x - n.y * n.y) + c3 * l[6].x * n.z * n.z + c4 * l[0].x - c5 * l[6].x +
         2 * c1 * (l[4].x * n.x * n.y + l[7].x * n.x * n.z + l[5].x * n.y * n.z) +
         2 * c2 * (l[3].x * n.x + l[1].x * n.y + l[2].x * n.z);
}

// Irradiance_SphericalHarmonics() of Filament, shaders/src/surface_light_indirect.fs: irradiance / pi.
double filament(const ShaderSh& c, const Direction& n) {
  return pi * (c[0].x + c[1].x * n.y + c[2].x * n.z + c[3].x * n.x + c[4].x * n.y * n.x + c[5].x * n.y * n.z +
               c[6].x * (3 * n.z * n.z - 1) + c[7].x * n.z * n.x + c[8].x * (n.x * n.x - n.y * n.y));
}

// Light probes of Godot, scene_forward_clustered.glsl: irradiance / pi.
double godot(const ShaderSh& c, const Direction& n) {
  return pi * (0.886227 * c[0].x + 1.023327 * (c[1].x * n.y + c[2].x * n.z + c[3].x * n.x) +
               0.858086 * (c[4].x * n.x * n.y + c[5].x * n.y * n.z + c[7].x * n.x * n.z) +
               0.247708 * c[6].x * (3 * n.z * n.z - 1) + 0.429043 * c[8].x * (n.x * n.x - n.y * n.y));
}

struct Shader {
  ShBasis basis;
  std::function<double(const ShaderSh&, const Direction&)> irradiance;
};
const Shader shaders[] = {{ShBasis::three, three},
                          {ShBasis::ramamoorthi, ramamoorthi},
                          {ShBasis::filament, filament},
                          {ShBasis::godot, godot}};

// L = 2 + 0.6 x - 0.3 y + 0.5 z + 0.4 x y - 0.2 y z + 0.3 z x + 0.25 (x^2 - y^2) + 0.15 (3 z^2 - 1).
double radiance(const Direction& d, double linear, double quadratic) {
  return 2 + linear * (0.6 * d.x - 0.3 * d.y + 0.5 * d.z) +
         quadratic * (0.4 * d.x * d.y - 0.2 * d.y * d.z + 0.3 * d.z * d.x + 0.25 * (d.x * d.x - d.y * d.y) +
                      0.15 * (3 * d.z * d.z - 1));
}

EnvironmentMap polynomial() {
  EnvironmentMap map = blank_map(Projection::cube, 128);
  std::vector<Direction> row(128);
  for (int face = 0; face < 6; ++face)
    for (int j = 0; j < 128; ++j) {
      texel_directions(Projection::cube, 128, face, j, 0, row);
      for (std::size_t i = 0; i < row.size(); ++i)
        map.base().row(face, j)[i] = Colour(float(radiance(row[i], 1, 1)), 1, 0);
    }
  return map;
}

// The cosine multiplies degree 1 by 2/3 and degree 2 by 1/4 of what it does to a constant.
TEST(ShaderSh, ShadersFindTheIrradiance) {
  const EnvironmentMap map = polynomial();
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (const Shader& shader : shaders) {
    const ShaderSh nine = shader_sh(map, shader.basis, ShWindow::none);
    for (int k = 0; k < 20; ++k) {
      const Direction n = glm::normalize(Direction(normal(random), normal(random), normal(random)));
      EXPECT_NEAR(shader.irradiance(nine, n), pi * radiance(n, 2.0 / 3, 0.25), 1e-3)
          << sh_basis_names[std::size_t(shader.basis)];
    }
  }
}

// Colours keep their channels, and white is white.
TEST(ShaderSh, WhiteHasOneColour) {
  const EnvironmentMap white = generate(Constant{.radiance = {1, 2, 0}}, Projection::latlong, 64);
  const double first[] = {std::sqrt(4 * pi), std::sqrt(4 * pi), 1, std::sqrt(4 / pi)};
  for (const Shader& shader : shaders) {
    const ShaderSh nine = shader_sh(white, shader.basis);
    const double wanted = first[std::size_t(shader.basis)];
    EXPECT_NEAR(nine[0].x, wanted, 1e-6 * wanted);
    EXPECT_NEAR(nine[0].y, 2 * wanted, 1e-6 * wanted);
    EXPECT_EQ(nine[0].z, 0);
    for (std::size_t k = 1; k < 9; ++k) EXPECT_NEAR(nine[k].x, 0, 1e-6);
  }
}

// A small sun makes irradiance fall below 0 opposite; the window lifts it, and no more than it must.
TEST(ShaderSh, TheWindowKeepsLightAboveZero) {
  const EnvironmentMap sun = generate(Sun{.radius_degrees = 2, .sky = {}}, Projection::latlong, 128);
  const auto least = [&](ShWindow window) {
    const ShaderSh nine = shader_sh(sun, ShBasis::filament, window);
    double lowest = 1e30;
    for (int k = 0; k <= 180; ++k) {
      const double angle = k * pi / 180;
      lowest = std::min(lowest, filament(nine, {std::sin(angle), 0, std::cos(angle)}));
    }
    return lowest / filament(nine, {0, 0, 1});
  };
  EXPECT_LT(least(ShWindow::none), -0.01);
  EXPECT_GT(least(ShWindow::automatic), -1e-6);
  EXPECT_LT(least(ShWindow::automatic), 1e-3);
}

TEST(ShaderSh, OfASeriesAsOfItsMap) {
  const EnvironmentMap map = polynomial();
  const Harmonics h = project(map, 4);
  for (const Shader& shader : shaders) {
    const ShaderSh of_map = shader_sh(map, shader.basis, ShWindow::none), of_series = shader_sh(h, shader.basis);
    for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(of_map[k].x, of_series[k].x, 1e-9);
  }
  EXPECT_THROW((void)shader_sh(project(map, 1)), UsageError);
  EXPECT_THROW((void)shader_sh(map, ShBasis(17)), UsageError);
  EXPECT_THROW((void)shader_sh(map, ShBasis::three, ShWindow(17)), UsageError);
}

}  // namespace
}  // namespace shader_sh_test

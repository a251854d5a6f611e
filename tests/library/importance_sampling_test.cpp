// Directions drawn from maps against the densities that they are drawn by, and those against the light of the map.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "envmap/envmap.h"

namespace importance_sampling_test {
namespace {

using namespace envmap;

EnvironmentMap scene(const Frame& frame) {
  return convert(generate(Sun{.towards = Direction(1, 2, -0.5), .radius_degrees = 12}, Projection::latlong, 64),
                 {.to = frame, .size = frame.projection == Projection::cube ? 24 : 48});
}

// Where a direction lies among cells of equal solid angle: 8 bands of height, 16 of azimuth.
std::size_t cell_of(const Direction& d) {
  const int band = std::min(7, int((d.y + 1) * 4)),
            sector = std::min(15, int((std::atan2(d.x, d.z) + pi) / (2 * pi) * 16));
  return std::size_t(band * 16 + sector);
}

const Frame frames[] = {{Projection::latlong, Forward::plus_x},
                        {Projection::cube},
                        {Projection::octahedral},
                        {Projection::sphere}};

TEST(ImportanceSampling, DensityIntegratesToOneAndFollowsTheLight) {
  for (const Frame& frame : frames) {
    const ImportanceSampler sampler(scene(frame));
    // By midpoints of a fine latlong grid.
    double all = 0;
    constexpr int rows = 1024;
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < 2 * rows; ++i) {
        const double polar = pi * (j + 0.5) / rows, azimuth = pi * (i + 0.5) / rows;
        all +=
            sampler.pdf({std::sin(polar) * std::sin(azimuth), std::cos(polar), std::sin(polar) * std::cos(azimuth)}) *
            std::sin(polar) * (pi / rows) * (pi / rows);
      }
    EXPECT_NEAR(all, 1, 2e-3) << name(frame.projection);
    EXPECT_GT(sampler.pdf({2, 4, -1}), 0.5 / (4 * pi * std::pow(std::sin(pi / 180 * 6), 2))) << name(frame.projection);
  }
}

// Pearson's chi-square over 128 cells: drawn against integrated.
TEST(ImportanceSampling, DrawsByItsDensity) {
  constexpr int draws = 200000;
  for (const Frame& frame : frames) {
    const ImportanceSampler sampler(scene(frame));
    std::array<double, 128> wanted{}, found{};
    constexpr int rows = 1024;
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < 2 * rows; ++i) {
        const double polar = pi * (j + 0.5) / rows, azimuth = pi * (i + 0.5) / rows;
        const Direction d(std::sin(polar) * std::sin(azimuth), std::cos(polar), std::sin(polar) * std::cos(azimuth));
        wanted[cell_of(d)] += draws * sampler.pdf(d) * std::sin(polar) * (pi / rows) * (pi / rows);
      }
    std::mt19937 random(7);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int k = 0; k < draws; ++k) {
      const double first = unit(random);
      const auto s = sampler.sample({first, unit(random)});
      ASSERT_NEAR(glm::dot(s.direction, s.direction), 1, 1e-12);
      found[cell_of(s.direction)] += 1;
      if (k % 1000 == 0) {
        ASSERT_NEAR(sampler.pdf(s.direction) / s.pdf, 1, 0.02);
      }
    }
    double square = 0;
    int cells = 0;
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      if (wanted[k] < 5) continue;
      square += (found[k] - wanted[k]) * (found[k] - wanted[k]) / wanted[k];
      ++cells;
    }
    // Five standard deviations of chi-square, and what the grid of the integral is off by.
    EXPECT_LT(square, cells + 5 * std::sqrt(2.0 * cells) + 30) << name(frame.projection);
    EXPECT_GT(cells, 3);
  }
}

TEST(ImportanceSampling, EstimatesTheFluxWithoutVariance) {
  // Radiance over density is the flux in luminance, whichever direction was drawn, but for what varies in a texel.
  const EnvironmentMap map = generate(Constant{Rgb<double>(2)}, Projection::latlong, 16);
  const ImportanceSampler sampler(map);
  for (const double u : {0.0, 0.3, 0.71, 0.999}) EXPECT_NEAR(2 / sampler.sample({u, 0.4}).pdf, 8 * pi, 1e-3);
}

TEST(ImportanceSampling, RefusesWhatItCannotDraw) {
  EXPECT_THROW(ImportanceSampler{generate(Constant{Rgb<double>(0)}, Projection::cube, 4)}, InputError);
  EnvironmentMap negative = generate(Constant{}, Projection::cube, 4);
  *negative.base().texel(0, 0, 0) = Colour(-1);
  EXPECT_THROW(ImportanceSampler{negative}, InputError);
  const ImportanceSampler sampler(generate(Constant{}, Projection::cube, 4));
  EXPECT_THROW((void)sampler.sample({std::nan(""), 0}), UsageError);
  EXPECT_THROW((void)sampler.sample({0, 1.5}), UsageError);
  EXPECT_THROW((void)sampler.pdf({0, 0, 0}), UsageError);
}

}  // namespace
}  // namespace importance_sampling_test

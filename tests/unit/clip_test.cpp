// What the horizon leaves of a texel, as a parallelogram, against the exact sum, which goes round the texel's border.
#include "envmap/prefilter/clip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "envmap/prefilter/exact.h"

namespace envmap::prefiltering::clip_test {
namespace {

class EachExponent : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(, EachExponent, testing::Values(0.0, 0.01, 0.125, 0.5, 0.93));

// Directions whose horizon crosses a texel, or passes by within its size; now and then along a side.
Direction at_horizon_of(std::mt19937& random, const Direction& texel, const Direction& side, double reach) {
  std::uniform_real_distribution<double> even(-1, 1);
  const Direction across =
      even(random) < 0.8 ? Direction(even(random), even(random), even(random)) : glm::cross(texel, side);
  const Direction r = glm::normalize(across - glm::dot(across, texel) * texel);
  return glm::normalize(r + 2 * reach * even(random) * texel);
}

template <class P>
void hold_bound(double exponent) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> even;
  const Phong lobe{exponent};
  double worst = 0;
  for (int n = 0; n < 1000; ++n) {
    const int size = 2 << int(6 * even(random));
    Level level(P::id, size);
    const int face = int(level.faces() * even(random)), i = int(level.width() * even(random)),
              j = n % 5 == 0 ? 0 : int(level.height() * even(random));
    *level.texel(face, i, j) = Colour(1);
    const Rect rect = texel_rect(i, j, level.width(), level.height());
    const Direction middle = P::direction(face, 0.5 * (rect.u0 + rect.u1), 0.5 * (rect.v0 + rect.v1));
    const Direction corner = P::direction(face, rect.u0, rect.v0), side = P::direction(face, rect.u0, rect.v1) - corner;
    const std::vector<Direction> r{at_horizon_of(random, middle, side, glm::length(corner - middle))};
    const ClippedMean found = clipped_mean(lobe, flat_piece<P>(r[0], face, rect));
    if (!std::isfinite(found.error)) continue;
    const double truth = exact_prefilter(level, lobe, r, {})[0].x / P::solid_angle(rect);
    const double off = std::abs(found.value - truth);
    ASSERT_LE(off, found.error + 3e-8) << size << " face " << face << " (" << i << ", " << j << "), map " << n;
    worst = std::max(worst, off / (found.error + 3e-8));
    // A step over a point would be off by half.
    if (size == 64 && j > size / 8 && j < size - size / 8) {
      ASSERT_LT(found.error, 0.08 * lobe.scale()) << size;
    }
  }
  EXPECT_GT(worst, 0.1) << "an idle bound";
}

TEST_P(EachExponent, NoClippedTexelIsFartherOffThanItsBound) {
  hold_bound<Cube>(GetParam());
  hold_bound<Latlong>(GetParam());
}

}  // namespace
}  // namespace envmap::prefiltering::clip_test

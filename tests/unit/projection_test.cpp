// Directions and locations: against the plain formulae, in float and double, at poles, seams, rims and -Z.
#include <gtest/gtest.h>

#include <random>

#include "envmap/projection/matching_size.h"
#include "envmap/projection/visit.h"
#include "formulae.h"

namespace envmap::projection_test {
namespace {

class EachProjection : public testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(, EachProjection, testing::ValuesIn(all_projections),
                         [](const auto& p) { return identifier(p.param); });

template <class F>
void for_points(Projection p, int size, F&& f) {
  for (int face = 0; face < faces(p); ++face)
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < size * aspect(p); ++i)
        if (formulae::in_image(p, size, i, j)) f(face, (i + 0.5) / (size * aspect(p)), (j + 0.5) / size);
}

TEST_P(EachProjection, DirectionIsTheFormula) {
  visit(GetParam(), [&](auto q) {
    for_points(GetParam(), 33, [&](int face, double u, double v) {
      const Direction d = decltype(q)::direction(face, u, v);
      EXPECT_NEAR(glm::length(d), 1, 4e-16);
      EXPECT_LT(formulae::angle(formulae::direction(GetParam(), face, u, v), d), 1e-14);
    });
  });
}

TEST_P(EachProjection, LocateUndoesDirection) {
  visit(GetParam(), [&](auto q) {
    for_points(GetParam(), 64, [&](int face, double u, double v) {
      const auto at = decltype(q)::locate(decltype(q)::direction(face, u, v));
      EXPECT_EQ(at.face, face);
      EXPECT_NEAR(at.u, u, 1e-13);
      EXPECT_NEAR(at.v, v, 1e-13);
    });
  });
}

// Texels of the largest maps, mostly where formulae lose digits.
std::vector<Location<double>> hard_places(Projection p) {
  std::vector<Location<double>> places;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(0, 1);
  const int size = 32768;
  const auto centre = [&](int face, double i, double j) {
    places.push_back({face, (std::floor(i) + 0.5) / (size * aspect(p)), (std::floor(j) + 0.5) / size});
  };
  for (int k = 0; k < 20000; ++k) {
    const int face = k % faces(p);
    const double w = size * aspect(p), turn = 2 * pi * any(random);
    centre(face, any(random) * w, any(random) * size);
    centre(face, any(random) * 4, any(random) * size);  // The left edge, the meridian of -Z.
    centre(face, any(random) * w, any(random) * 4);     // The top edge, the pole.
    const double r = 0.5 - 3 * any(random) / size;      // Within three texels of the rim.
    centre(face, (0.5 + r * std::cos(turn)) * size, (0.5 + r * std::sin(turn)) * size);
    const double c = 3 * any(random) / size;  // Within three texels of the middle.
    centre(face, (0.5 + c * std::cos(turn)) * size, (0.5 + c * std::sin(turn)) * size);
  }
  std::erase_if(places, [&](const auto& at) { return on_disc(p) && std::hypot(2 * at.u - 1, 2 * at.v - 1) > 1; });
  return places;
}

// Two units in the last place of a number near 1, as an angle: 2 x 2^-23 rad.
constexpr double float_bound = 2.4e-7;

TEST_P(EachProjection, FloatDirectionsAreWithinTwoUlp) {
  visit(GetParam(), [&](auto q) {
    double worst = 0;
    for (const auto& at : hard_places(GetParam())) {
      const auto u = float(at.u), v = float(at.v);
      const Vec3<float> f = decltype(q)::direction(at.face, u, v);
      const Direction d = decltype(q)::direction(at.face, double(u), double(v));
      worst = std::max(worst, angle_between(Direction(f), d));
    }
    EXPECT_LT(worst, float_bound);
    EXPECT_GT(worst, 0);  // It is float that was tested.
  });
}

TEST_P(EachProjection, DoubleDirectionsHoldAtTheRim) {
  visit(GetParam(), [&](auto q) {
    for (const auto& at : hard_places(GetParam())) {
      // The plain formula in long double has three digits more; where it needs sqrt(1 - r^2) it loses half of all.
      const double bound = GetParam() == Projection::sphere ? 1e-11 : 1e-15;
      const Direction d = decltype(q)::direction(at.face, at.u, at.v);
      ASSERT_LT(formulae::angle(formulae::direction(GetParam(), at.face, at.u, at.v), d), bound) << at.u << " " << at.v;
    }
  });
}

// A float direction located in float, against the same direction located in double: two units of the location, which
// as an angle is 2 x 2^-24 of the face times how far the direction moves with it.
TEST_P(EachProjection, FloatLocationsAreWithinTwoUlp) {
  visit(GetParam(), [&](auto q) {
    using P = decltype(q);
    for (const auto& at : hard_places(GetParam())) {
      const Vec3<float> f(P::direction(at.face, at.u, at.v));
      const auto a = P::locate(f);
      const auto b = P::locate(Direction(f));
      ASSERT_EQ(a.face, b.face);
      ASSERT_LE(std::abs(a.u - b.u), 2 * 0x1p-24) << at.u << " " << at.v;
      ASSERT_LE(std::abs(a.v - b.v), 2 * 0x1p-24);
    }
  });
}

TEST_P(EachProjection, LocatesEveryDirectionInsideItsFace) {
  visit(GetParam(), [&](auto q) {
    using P = decltype(q);
    const double tiny[] = {0, -0.0, 1e-308, -1e-308, 1e-160, 1e-30, -1e-16, 1e-8, 0.5, 1, -1};
    for (const double x : tiny)
      for (const double y : tiny)
        for (const double z : tiny) {
          if (std::hypot(x, y, z) < 0.4) continue;
          const Direction d = glm::normalize(Direction(x, y, z));
          const auto at = P::locate(d);
          ASSERT_GE(at.face, 0);
          ASSERT_LT(at.face, P::faces);
          ASSERT_TRUE(at.u >= 0 && at.u <= 1 && at.v >= 0 && at.v <= 1) << d.x << " " << d.y << " " << d.z;
          if (P::on_disc) {
            ASSERT_LE(std::hypot(2 * at.u - 1, 2 * at.v - 1), 1 + 1e-15);
          }
          // And back: the rim of a sphere map turns a rounding of 1e-16 into 1e-8.
          ASSERT_LT(angle_between(P::direction(at.face, at.u, at.v), d),
                    GetParam() == Projection::sphere ? 3e-8 : 1e-15);
        }
  });
}

// Beyond an edge the direction goes on as it came: no step, no turn; on octahedral maps, no step.
TEST_P(EachProjection, ContinuesSmoothlyOverItsEdges) {
  visit(GetParam(), [&](auto q) {
    using P = decltype(q);
    const double h = 1e-4;
    for (double along = 0.05; along < 1; along += 0.1) {
      const double turn = 2 * pi * along, c = std::cos(turn), s = std::sin(turn);
      const auto over = [&](double t) {  // Across the rim of a disc, or across the left edge of a square.
        return P::on_disc ? P::direction(0, 0.5 + (0.5 + t) * c, 0.5 + (0.5 + t) * s) : P::direction(0, -t, along);
      };
      if (is_octahedral(GetParam())) {
        // A crease: a step beyond the side is as long as one before it. In the middle of the side it goes back.
        const Direction before = over(0) - over(-h), after = over(h) - over(0);
        EXPECT_GT(glm::length(before), 1e-4);
        EXPECT_NEAR(glm::length(after) / glm::length(before), 1, 1e-3);
      } else if (GetParam() == Projection::sphere) {
        // The radius goes with a square root there: equal steps either side are opposite about -Z.
        EXPECT_LT(glm::length(over(h) + over(-h) - 2.0 * glm::dot(over(h), {0, 0, -1}) * Direction(0, 0, -1)), 1e-12);
      } else {
        EXPECT_LT(glm::length(over(h) - 2.0 * over(0) + over(-h)), 1e-5);
        EXPECT_GT(glm::length(over(h) - over(-h)), 1e-4);
      }
    }
  });
}

TEST(Projection, KnownPlaces) {
  const auto at = [](Projection p, const Direction& d) {
    return visit(p, [&](auto q) { return decltype(q)::locate(d); });
  };
  const auto expect = [](const Location<double>& l, int face, double u, double v) {
    EXPECT_EQ(l.face, face);
    EXPECT_NEAR(l.u, u, 1e-15);
    EXPECT_NEAR(l.v, v, 1e-15);
  };
  expect(at(Projection::latlong, {0, 0, 1}), 0, 0.5, 0.5);
  expect(at(Projection::latlong, {1, 0, 0}), 0, 0.25, 0.5);  // +X lies left of the centre.
  expect(at(Projection::latlong, {0, 1, 0}), 0, 0.5, 0);
  expect(at(Projection::cube, {0, 0, -1}), 5, 0.5, 0.5);
  expect(at(Projection::cube, glm::normalize(Direction(1, 0.5, 0.25))), 0, 0.625, 0.25);
  expect(at(Projection::sphere, {1, 0, 0}), 0, 0.5 + 0.25 * std::numbers::sqrt2, 0.5);
  expect(at(Projection::paraboloid, {0, 1, 0}), 0, 0.5, 0);
  expect(at(Projection::paraboloid, {0, 0, -1}), 1, 0.5, 0.5);
  expect(at(Projection::angular, {1, 0, 0}), 0, 0.25, 0.5);
  for (const Projection p : {Projection::octahedral, Projection::equal_area}) {
    expect(at(p, {0, 1, 0}), 0, 0.5, 0.5);
    expect(at(p, {1, 0, 0}), 0, 1, 0.5);
    expect(at(p, {0, 0, 1}), 0, 0.5, 0);
    expect(at(p, {0, 0, -1}), 0, 0.5, 1);
    expect(at(p, {0, -1, 0}), 0, 1, 0);
    expect(at(p, glm::normalize(Direction(1, 0, 1))), 0, 0.75, 0.25);
  }
  expect(at(Projection::octahedral, glm::normalize(Direction(-1, -1, 1))), 0, 1.0 / 6, 1.0 / 6);
  // 30 degrees up: r^2 = 1/2. A third of the way from +X to +Z.
  const double r = std::sqrt(0.5), level = std::sqrt(0.75);
  expect(at(Projection::equal_area, {level * std::cos(pi / 6), 0.5, level * std::sin(pi / 6)}), 0, 0.5 + r / 3,
         0.5 - r / 6);
}

// pbrt-v4's EqualAreaSquareToSphere (util/math.cpp) as one looks it up in its ImageInfiniteLight: x right and y down in
// the image, +Z in the middle. Without --rotate our +Y is its +Z, our +X its +X and our -Z its +Y.
TEST(Projection, EqualAreaIsWhatPbrtReads) {
  for (int j = 0; j < 40; ++j)
    for (int i = 0; i < 40; ++i) {
      const double px = (i + 0.5) / 40, py = (j + 0.5) / 40, u = 2 * px - 1, v = 2 * py - 1;
      const double d = 1 - (std::abs(u) + std::abs(v)), r = 1 - std::abs(d);
      const double phi = (r == 0 ? 1 : (std::abs(v) - std::abs(u)) / r + 1) * pi / 4, level = r * std::sqrt(2 - r * r);
      const Direction pbrt(std::copysign(std::cos(phi), u) * level, std::copysign(std::sin(phi), v) * level,
                           std::copysign(1 - r * r, d));
      const Direction ours = EqualArea::direction(0, px, py);
      EXPECT_LT(glm::length(pbrt - Direction(ours.x, -ours.z, ours.y)), 1e-14) << i << "," << j;
    }
}

TEST(Projection, MatchingSizesKeepDegreesPerTexel) {
  EXPECT_EQ(matching_size(Projection::latlong, 2048, Projection::cube), 1024);
  EXPECT_EQ(matching_size(Projection::cube, 1024, Projection::sphere), 4096);
  EXPECT_EQ(matching_size(Projection::angular, 1, Projection::cube), 1);
}

TEST(Projection, NamesAreUnderstood) {
  for (const Projection p : all_projections) EXPECT_EQ(projection_named(name(p)), p);
  EXPECT_FALSE(projection_named("octagonal"));
}

}  // namespace
}  // namespace envmap::projection_test

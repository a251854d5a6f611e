// Sizes, directions and turns at their ends.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "envmap/operate/convert.h"
#include "envmap/operate/generate.h"
#include "envmap/operate/levels.h"
#include "envmap/operate/measure.h"
#include "envmap/prefilter/harmonics.h"
#include "envmap/prefilter/prefilter.h"

namespace envmap::shapes_test {
namespace {

constexpr double half_ulp = 0x1p-24;

// ---- sizes ----------------------------------------------------------------------------------------------------------

// One texel a face: whatever is done, the mean of a constant is that constant, rounded some times in float32 (filters)
// or to the method's own 1e-3 (prefilter, where the lobe's weight over texels of 2 sr is the sum's).
TEST(Sizes, OneTexelAFace) {
  for (const Projection from : all_projections) {
    SCOPED_TRACE(name(from));
    EnvironmentMap map = generate(Constant{Rgb<double>(0.7)}, from, 1);
    EXPECT_NEAR(flux(map.base()).x, 4 * pi * 0.7F, 1e-6);
    EXPECT_FALSE(has_next(map.base()) && from != Projection::latlong && from != Projection::paraboloid);
    for (const Projection to : all_projections)
      for (const FilterInfo& filter : filters())
        for (const int size : {1, 3}) {
          const EnvironmentMap made =
              convert(map, {.to = to, .size = size, .filter = filter.filter, .rotation = rotation(10, 20, 30)});
          for (const Texel& t : texels_of(made.base()))
            EXPECT_NEAR(made.base().texel(t.face, t.i, t.j)->y, 0.7, 0.7 * 16 * half_ulp)
                << name(to) << ", " << filter.name;
        }
    for (const auto& [shape, parameter] :
         {std::pair(LobeShape::diffuse, unset_parameter), {LobeShape::phong, 1.0}, {LobeShape::ggx, 1.0}}) {
      const Prefiltered made = Prefilterer(map).make({.lobe = Lobe(shape, parameter), .size = 1});
      for (const Texel& t : texels_of(made.map.base()))
        EXPECT_NEAR(made.map.base().texel(t.face, t.i, t.j)->y, 0.7, 1e-3 * 0.7);
    }
    EXPECT_NEAR(project(map, 2).coefficients[0].x, 0.7F * std::sqrt(4 * pi), 1e-6);
    add_levels(map.levels);
    EXPECT_NEAR(map.levels.back().texel(0, 0, 0)->x, 0.7, 0.7 * half_ulp);
  }
}

// Solid angles of a map of 32768: texels along a row of a latlong map are equal, and the row's band is 2 pi (sin a -
// sin b). At the pole that is 2 pi (1 - cos(pi / 32768 / 2 x ...)), of which float64 keeps 9 digits if written so; 4 pi
// sin^2(h / 2) keeps all, and so must ours: 1e-12.
TEST(Sizes, TexelsOf32768AtThePole) {
  const int n = 16384;
  std::vector<double> row(2 * n);
  solid_angles(Projection::latlong, n, 0, row);
  const double h = pi / n, band = 4 * pi * std::pow(std::sin(h / 2), 2);
  EXPECT_NEAR(row[0] * 2 * n / band, 1, 1e-12);
  EXPECT_GT(std::abs(2 * pi * (1 - std::cos(h)) / band - 1), 1e-10) << "the naive form would do";
}

// A small texel's solid angle is density x area, to (side)^2: 1e-8 at 32768.
// At a cube's corner the density is 4 x 3^(-3/2).
TEST(Sizes, TexelsOf32768AtTheCorner) {
  const int n = 32768;
  std::vector<double> row(n);
  solid_angles(Projection::cube, n, 0, row);
  EXPECT_NEAR(row[0] * n * n / (4 * std::pow(3, -1.5)), 1, 1e-4);  // The centre is half a texel from the corner.
  EXPECT_NEAR(row[0] / row[std::size_t(n) - 1], 1, 1e-12);
  for (const Projection p : {Projection::sphere, Projection::angular, Projection::paraboloid}) {
    std::vector<double> middle(static_cast<std::size_t>(n));
    solid_angles(p, n, n / 2, middle);
    const Point2 at[1] = {{0.5 + 0.5 / n, 0.5 + 0.5 / n}};
    double density[1];
    densities(p, at, density);
    EXPECT_NEAR(middle[n / 2] * n * n / density[0], 1, 1e-8) << name(p);
  }
}

// ---- directions -----------------------------------------------------------------------------------------------------

constexpr double tiny = std::numeric_limits<double>::denorm_min();

// Every direction has one place in the map, and that looks back within rounding: 1e-7 of the face is 1e-7 rad but at
// the singular point of a sphere map, where the rim is one direction (error sqrt(ulp)).
TEST(Directions, OfZerosAndSubnormalsHaveAPlace) {
  std::vector<Direction> all;
  for (const double small : {0.0, -0.0, tiny, -tiny, 1e-310, 1e-160, -1e-16})
    for (const double sign : {1.0, -1.0}) {
      all.insert(all.end(),
                 {{sign, small, 0}, {small, sign, -0.0}, {0, small, sign}, {small, small, sign}, {small, sign, small}});
      all.push_back(glm::normalize(Direction(sign, sign, small)));
    }
  for (const Projection p : all_projections) {
    std::vector<Location<double>> places(all.size());
    locate(p, all, places);
    for (std::size_t k = 0; k < all.size(); ++k) {
      SCOPED_TRACE(std::string(name(p)) + ": " + std::to_string(all[k].x) + " " + std::to_string(all[k].y) + " " +
                   std::to_string(all[k].z));
      const Location<double>& at = places[k];
      ASSERT_TRUE(at.face >= 0 && at.face < faces(p));
      ASSERT_TRUE(at.u >= 0 && at.u <= 1 && at.v >= 0 && at.v <= 1) << at.u << " " << at.v;
      const Point2 place[1] = {{at.u, at.v}};
      Direction back[1];
      directions(p, at.face, place, back);
      EXPECT_LT(angle_between(back[0], all[k]), p == Projection::sphere && all[k].z < -0.99 ? 1e-6 : 1e-14);
    }
  }
}

// ---- turns ----------------------------------------------------------------------------------------------------------

// Whole turns are no turn, however many: degrees are reduced by std::remainder, which is exact. Multiplied by pi / 180
// first, a million turns would be off by 1e-10.
TEST(Turns, AMillionAreNone) {
  for (const double degrees : {0.0, 90.0, 33.0, -0.125})
    for (const double turns : {1.0, 1e6, -1e6}) {
      EXPECT_EQ(rotation(degrees + 360 * turns, 0, 0), rotation(degrees, 0, 0));
      EXPECT_EQ(rotation(0, degrees + 360 * turns, 0), rotation(0, degrees, 0));
      EXPECT_EQ(rotation(1, 2, degrees + 360 * turns), rotation(1, 2, degrees));
    }
  EXPECT_GT(std::abs(std::sin(360e6 * (pi / 180))), 1e-11) << "the naive form would do";
}

// By 1e-300 degrees nothing moves by as much as a rounding: the result is that of no turn, within a float's ulp at the
// steepest place (a sun in one texel: the slope is sun x size a face, the turn 1e-14 of a face at most).
TEST(Turns, TinyOnesChangeNothing) {
  const EnvironmentMap map = generate(Sun{}, Projection::latlong, 32);
  for (const Projection to : all_projections)
    for (const double degrees : {1e-300, 1e-30, 1e-13, -1e-13}) {
      const EnvironmentMap still = convert(map, {.to = to, .size = 16, .filter = Filter::bilinear});
      const EnvironmentMap turned =
          convert(map,
                  {.to = to, .size = 16, .filter = Filter::bilinear, .rotation = rotation(degrees, degrees, degrees)});
      // Texels right beside a sun fall from 1e5 to 1 over one texel: 1e5 x 32 x 1e-15 against a mean of some 10.
      EXPECT_LT(compare(turned.base(), still.base()).maximum, 1e-6) << name(to) << " by " << degrees;
    }
}

}  // namespace
}  // namespace envmap::shapes_test

// Texel solid angles: sums, independent integrals, symmetry.
#include <gtest/gtest.h>

#include "envmap/maths/compensated_sum.h"
#include "envmap/projection/visit.h"
#include "formulae.h"

namespace envmap::solid_angle_test {
namespace {

double total(Projection p, int size) {
  CompensatedSum sum;
  std::vector<double> row(std::size_t(size * aspect(p)));
  for (int j = 0; j < size; ++j) {
    solid_angles(p, size, j, row);
    for (const double w : row) sum.add(w);
  }
  return sum.value() * faces(p);
}

class EachSize : public testing::TestWithParam<std::tuple<Projection, int>> {};
INSTANTIATE_TEST_SUITE_P(, EachSize,
                         testing::Combine(testing::ValuesIn(all_projections), testing::Values(1, 2, 3, 7, 64, 1024)),
                         [](const auto& p) {
                           return identifier(std::get<0>(p.param)) + "_" + std::to_string(std::get<1>(p.param));
                         });

TEST_P(EachSize, SumsToFourPi) { EXPECT_NEAR(total(std::get<0>(GetParam()), std::get<1>(GetParam())), 4 * pi, 1e-12); }

class EachSolidAngle : public testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(, EachSolidAngle, testing::ValuesIn(all_projections),
                         [](const auto& p) { return identifier(p.param); });

// The area that the directions themselves span, by differences of the plain formula: nothing in common with the
// library's closed forms and densities.
TEST_P(EachSolidAngle, TexelsHaveTheAreaTheirDirectionsSpan) {
  const Projection p = GetParam();
  const int size = 16, fine = 400;
  std::vector<double> row(std::size_t(size * aspect(p)));
  for (const auto& [i, j] : {std::pair{7, 7}, {5, 10}, {4, 4}, {8, 2}}) {
    solid_angles(p, size, j, row);
    const double du = 1.0 / (size * aspect(p) * fine), dv = 1.0 / (size * fine);
    CompensatedSum area;
    for (int b = 0; b < fine; ++b)
      for (int a = 0; a < fine; ++a) {
        const double u = i / double(size * aspect(p)) + (a + 0.5) * du, v = j / double(size) + (b + 0.5) * dv;
        const auto d = [&](double x, double y) { return formulae::rounded(formulae::direction(p, 0, x, y)); };
        area.add(glm::length(glm::cross(d(u + du / 2, v) - d(u - du / 2, v), d(u, v + dv / 2) - d(u, v - dv / 2))));
      }
    EXPECT_NEAR(row[i] / area.value(), 1, 1e-5) << i << "," << j;
  }
}

TEST_P(EachSolidAngle, RowsAreSymmetric) {
  const int size = 37;
  std::vector<double> top(std::size_t(size * aspect(GetParam()))), bottom(top.size());
  for (int j = 0; j < size; ++j) {
    solid_angles(GetParam(), size, j, top);
    solid_angles(GetParam(), size, size - 1 - j, bottom);
    for (std::size_t i = 0; i < top.size(); ++i) {
      EXPECT_NEAR(top[i], bottom[i], 1e-14);
      EXPECT_NEAR(top[i], top[top.size() - 1 - i], 1e-14);
    }
  }
}

TEST_P(EachSolidAngle, ColumnsHoldAllTheWeight) {
  for (const int size : {1, 2, 3, 5, 64, 101}) {
    std::vector<double> row(std::size_t(size * aspect(GetParam())));
    for (int j = 0; j < size; ++j) {
      solid_angles(GetParam(), size, j, row);
      const Columns in = columns(GetParam(), size, j);
      for (int i = 0; i < int(row.size()); ++i) {
        const double w = row[i];
        EXPECT_GE(w, 0);
        if (i < in.first || i >= in.end) {
          EXPECT_EQ(w, 0) << size << ": " << i << "," << j;
        }
      }
    }
  }
}

TEST(SolidAngle, OfEqualAreaTexelsIsOne) {
  std::vector<double> row(100);
  for (const int j : {0, 13, 50, 99}) {
    solid_angles(Projection::equal_area, 100, j, row);
    for (const double w : row) EXPECT_EQ(w, 4 * pi / 10000);
  }
}

// A facet is an eighth of the sphere; a strip along an axis is a lune's part, whose closed form is Girard's: the
// triangle with corners +Y, +X and the direction at (s, t) = (0, c) has a right angle at +Y,
// and the others by its sides.
TEST(SolidAngle, OfOctahedralMapsIsThatOfSphericalTriangles) {
  EXPECT_NEAR(Octahedral::solid_angle({0.5, 0, 1, 0.5}), pi, 1e-14);
  const double c = 0.3, y = 0.7, side = std::atan2(c, y);  // From +Y towards +Z.
  // Legs of `side` and a quarter turn: the angle at +X is `side`, that at the other end a right angle.
  const double triangle = side + pi / 2 + pi / 2 - pi;
  // The same from texels: columns under the line from (1,0) to (0,c).
  double sum = 0;
  const int n = 4000;
  for (int k = 0; k < n; ++k) {
    const double s = (k + 0.5) / n, t = c * (1 - s);
    sum += Octahedral::solid_angle({0.5 + 0.5 * k / n, 0.5 - 0.5 * t, 0.5 + 0.5 * (k + 1) / n, 0.5});
  }
  EXPECT_NEAR(sum, triangle, 1e-6);
}

TEST(SolidAngle, OfTinyTexelsKeepsItsDigits) {
  // One texel of a 32k cube at a corner and at the centre against the density there.
  const double side = 1.0 / 32768;
  const Rect centre{0.5, 0.5, 0.5 + side, 0.5 + side}, corner{0, 0, side, side};
  EXPECT_NEAR(Cube::solid_angle(centre) / (4 * side * side), 1, 1e-8);
  EXPECT_NEAR(Cube::solid_angle(corner) / (4 * side * side / std::pow(3.0, 1.5)), 1, 1e-4);
  EXPECT_NEAR(Cube::solid_angle(corner) / (Cube::density(0.5 * side, 0.5 * side) * side * side), 1, 1e-8);
  EXPECT_NEAR(Latlong::solid_angle({0, 0, side, side}) / (pi * pi * pi * side * side * side), 1, 1e-8);
}

}  // namespace
}  // namespace envmap::solid_angle_test

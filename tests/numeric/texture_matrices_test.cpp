// The texture matrices that envmap.glsl gives in its comments, read from its text, against the projections.
#include <gtest/gtest.h>

#include <array>
#include <sstream>
#include <string>

#include "envmap/engine/lookup_shaders.h"
#include "envmap/projection/projection.h"

namespace texture_matrices_test {
namespace {

using namespace envmap;

using Rows = std::array<std::array<double, 4>, 4>;

// The four rows below the line that begins with `name`.
Rows matrix(const std::string& name) {
  std::istringstream text{std::string(glsl_lookups())};
  std::string line;
  while (std::getline(text, line) && !line.starts_with("// " + name + " (u, v, -, w) = M ")) {
  }
  Rows rows{};
  for (auto& row : rows) {
    std::string word;
    std::getline(text, line);
    std::istringstream words(line);
    words >> word >> word;  // Of the comment and the bar.
    for (double& x : row) words >> x;
    EXPECT_TRUE(bool(words)) << line;
  }
  return rows;
}

Point2 place(const Rows& m, const Direction& d) {
  const auto row = [&](int k) { return m[k][0] * d.x + m[k][1] * d.y + m[k][2] * d.z + m[k][3]; };
  return Point2(row(0), row(1)) / row(3);
}

TEST(TextureMatrices, LookWhereTheProjectionsDo) {
  const Rows front = matrix("front"), back = matrix("back"), sphere = matrix("sphere");
  int tried = 0;
  for (double x = -1; x <= 1; x += 0.23)
    for (double y = -1; y <= 1; y += 0.19)
      for (double z = -1; z <= 1; z += 0.21) {
        const Direction d = glm::normalize(Direction(x, y, z) + 1e-3), h = glm::normalize(d + Direction(0, 0, 1));
        const Location<double> half = locate(Projection::paraboloid, d), ball = locate(Projection::sphere, d);
        EXPECT_LT(glm::length(place(half.face == 0 ? front : back, d) - Point2(half.u, half.v)), 1e-12);
        EXPECT_LT(glm::length(place(sphere, h) - Point2(ball.u, ball.v)), 1e-9);
        ++tried;
      }
  EXPECT_GT(tried, 500);
}

}  // namespace
}  // namespace texture_matrices_test

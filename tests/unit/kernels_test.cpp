// The vector code of every target: against long double, against the scalar types, to the end of every span, and bit for
// bit against each other.
#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

#include "envmap/projection/visit.h"
#include "every_target.h"
#include "formulae.h"

namespace envmap::kernels_test {
namespace {

using formulae::Real;

class EachKernel : public testing::TestWithParam<Projection> {};
INSTANTIATE_TEST_SUITE_P(, EachKernel, testing::ValuesIn(all_projections),
                         [](const auto& p) { return identifier(p.param); });

// The direction at a = n s, b = n t. On a sphere map 1 - s^2 - t^2 would cancel even in long double.
formulae::Vector exact_direction(Projection p, int face, Real n, Real a, Real b) {
  const Real u = (1 + a / n) / 2, v = (1 - b / n) / 2;
  if (p != Projection::sphere) return formulae::direction(p, face, u, v);
  const Real rest = n * n - a * a - b * b, k = 2 * std::sqrt(std::max(Real(0), rest)) / (n * n);
  return {k * a, k * b, (2 * rest - n * n) / (n * n)};
}

// The centre of a texel, or of one that only its inner corner brings into the disc, half way from there to the rim.
formulae::Vector texel_direction(Projection p, int size, int face, int i, int j) {
  const Real n = size;
  Real a = (2 * Real(i) + 1 - n * aspect(p)) / aspect(p), b = n - 1 - 2 * Real(j);
  if (on_disc(p) && p != Projection::paraboloid && a * a + b * b > n * n) {
    const Real ca = a - (a > 0) + (a < 0), cb = b - (b > 0) + (b < 0), r = std::sqrt(ca * ca + cb * cb);
    a = ca * (n + r) / (2 * r), b = cb * (n + r) / (2 * r);
  }
  return exact_direction(p, face, n, a, b);
}

struct Piece {
  int size, face, row, first;
  std::size_t count;
};

// Every texel of small maps; of large ones pieces at either end and the middle of rows at the edges and in between.
std::vector<Piece> pieces(Projection p) {
  std::vector<Piece> found;
  for (const int size : {1, 2, 3, 4, 5, 7, 16, 33, 256, 1000, 4096, 32768})
    for (int face = 0; face < faces(p); ++face)
      for (const int row : {0, 1, 2, 3, 4, size / 7, size / 3, size / 2, size - 2, size - 1}) {
        if (row < 0 || row >= size) continue;
        const Columns in = columns(p, size, row);
        const int length = std::min(in.end - in.first, 61);
        for (const int first : {in.first, (in.first + in.end - length) / 2, in.end - length})
          found.push_back({size, face, row, first, std::size_t(length)});
      }
  return found;
}

TEST_P(EachKernel, TexelDirectionsAreTheFormula) {
  on_every_target([&](const char* target) {
    double worst = 0;
    for (const Piece& r : pieces(GetParam())) {
      std::vector<Direction> d(r.count);
      texel_directions(GetParam(), r.size, r.face, r.row, r.first, d);
      for (std::size_t k = 0; k < r.count; ++k) {
        const int i = r.first + int(k);
        const double off = formulae::angle(texel_direction(GetParam(), r.size, r.face, i, r.row), d[k]);
        if (!formulae::in_image(GetParam(), r.size, i, r.row)) {
          // A point computed, not given: its rounding counts, which a sphere map magnifies near the rim.
          ASSERT_LT(off, GetParam() == Projection::sphere ? 1e-11 : 1e-15) << target;
          continue;
        }
        worst = std::max(worst, off);
        ASSERT_LT(off, 6e-16) << target << " size " << r.size << " texel " << i << "," << r.row;
      }
    }
    RecordProperty(std::string("radians_") + target, std::to_string(worst * 1e16) + "e-16");
  });
}

// Points anywhere, for discs also a little beyond the rim.
std::vector<Point2> points(Projection p) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> any(0, 1);
  std::vector<Point2> found{{0, 0}, {1, 1}, {0.5, 0.5}, {0, 0.5}, {1, 0.5}, {0.5, 0}, {0.5, 1}};
  for (int k = 0; k < 20000; ++k) found.emplace_back(any(random), any(random));
  for (double tiny = 0.1; tiny > 1e-17; tiny *= 0.3) {
    const double turn = 2 * pi * any(random);
    for (const double r : {tiny, 0.5 - tiny, on_disc(p) ? 0.5 + tiny : tiny})
      found.emplace_back(0.5 + r * std::cos(turn), 0.5 + r * std::sin(turn));
  }
  return found;
}

TEST_P(EachKernel, DirectionsOfPointsAreTheFormula) {
  const auto uv = points(GetParam());
  std::vector<Direction> d(uv.size());
  on_every_target([&](const char* target) {
    for (int face = 0; face < faces(GetParam()); ++face) {
      directions(GetParam(), face, uv, d);
      for (std::size_t k = 0; k < uv.size(); ++k) {
        ASSERT_NEAR(glm::length(d[k]), 1, 5e-16) << target;
        const Real a = 2 * uv[k].x - 1, b = 1 - 2 * uv[k].y, rest = 1 - a * a - b * b;
        if (GetParam() == Projection::sphere && rest < 0) {
          // The point opposite is computed: its rounding counts, magnified.
          const Direction plain = Sphere::direction(face, uv[k].x, uv[k].y);
          ASSERT_LT(glm::length(d[k] - plain), 1e-15 / std::sqrt(1e-15 - rest)) << target;
        } else {
          // 1e-19 is long double's own rounding, magnified near the rim of a sphere map.
          const double bound = 8e-16 + (GetParam() == Projection::sphere ? double(1e-19 / std::sqrt(1e-19 + rest)) : 0);
          ASSERT_LT(formulae::angle(exact_direction(GetParam(), face, 1, a, b), d[k]), bound)
              << target << " " << uv[k].x << " " << uv[k].y;
        }
      }
    }
  });
}

std::vector<Direction> hard_directions() {
  std::vector<Direction> found;
  const double some[] = {0, -0.0, 5e-324, 1e-308, -1e-308, 1e-160, 1e-30, -1e-16, 1e-8, 0.5, 1, -1};
  for (const double x : some)
    for (const double y : some)
      for (const double z : some)
        if (std::hypot(x, y, z) > 0.4) found.push_back(glm::normalize(Direction(x, y, z)));
  std::mt19937_64 random(13);
  std::normal_distribution<double> bell;
  for (int k = 0; k < 20000; ++k) found.push_back(glm::normalize(Direction(bell(random), bell(random), bell(random))));
  for (double tiny = 1e-3; tiny > 1e-17; tiny *= 0.1)
    for (int k = 0; k < 8; ++k) {
      const double x = tiny * std::cos(0.8 * k), y = tiny * std::sin(0.8 * k);
      found.push_back(glm::normalize(Direction(x, y, -1)));
      found.push_back(glm::normalize(Direction(x, y, 1)));
      found.push_back(glm::normalize(Direction(x, k & 1 ? 1 : -1, y)));
      found.push_back(glm::normalize(Direction(k & 1 ? 1 : -1, x, y)));
    }
  return found;
}

// From the conventions, in long double; x/m of a sphere map in a form that does not cancel.
Vec2<Real> exact_place(Projection p, const Direction& d) {
  const Real x = d.x, y = d.y, z = d.z, h = std::hypot(x, y);
  Real s = 0, t = 0;
  switch (p) {
    case Projection::latlong:
      return {Real(0.5) - std::atan2(x, z) / (2 * formulae::pi),
              Real(0.5) - std::atan2(y, std::hypot(x, z)) / formulae::pi};
    case Projection::cube: {
      const auto at = Cube::locate(Vec3<double>(d));
      const Cube::Axes& axes = Cube::axes[at.face];
      const Vec3<Real> wide(d);
      const Real major = glm::dot(wide, Vec3<Real>(axes.forward));
      s = glm::dot(wide, Vec3<Real>(axes.right)) / major, t = glm::dot(wide, Vec3<Real>(axes.up)) / major;
      break;
    }
    case Projection::sphere: {
      const Real scale = z > 0 ? 1 / std::sqrt(h * h + (z + 1) * (z + 1)) : h > 0 ? std::sqrt((1 - z) / 2) / h : 0;
      s = h > 0 || z > 0 ? x * scale : 1, t = y * scale;
      break;
    }
    case Projection::paraboloid: s = x / (1 + std::abs(z)), t = y / (1 + std::abs(z)); break;
    case Projection::angular:
      s = h > 0 ? -x / h * std::atan2(h, z) / formulae::pi : z > 0 ? 0 : 1;
      t = h > 0 ? y / h * std::atan2(h, z) / formulae::pi : 0;
      break;
    case Projection::octahedral:
    case Projection::equal_area: {
      Real a = std::abs(x) / (std::abs(x) + std::abs(y) + std::abs(z)),
           b = std::abs(z) / (std::abs(x) + std::abs(y) + std::abs(z));
      if (p == Projection::equal_area) {
        const Real r = std::hypot(x, z) / std::sqrt(1 + std::abs(y));
        b = r * std::atan2(std::abs(z), std::abs(x)) / (formulae::pi / 2), a = r - b;
      }
      s = std::copysign(y < 0 ? 1 - b : a, x), t = std::copysign(y < 0 ? 1 - a : b, z);
    }
  }
  return {(1 + s) / 2, (1 - t) / 2};
}

TEST_P(EachKernel, LocationsAreTheFormula) {
  const auto d = hard_directions();
  std::vector<Location<double>> at(d.size());
  on_every_target([&](const char* target) {
    locate(GetParam(), d, at);
    double worst = 0;
    for (std::size_t k = 0; k < d.size(); ++k) {
      const auto plain = visit(GetParam(), [&](auto q) { return decltype(q)::locate(d[k]); });
      const Vec2<Real> exact = exact_place(GetParam(), d[k]);
      ASSERT_EQ(at[k].face, plain.face) << target;
      ASSERT_TRUE(at[k].u >= 0 && at[k].u <= 1 && at[k].v >= 0 && at[k].v <= 1) << target;
      const double off = double(std::max(std::abs(at[k].u - exact.x), std::abs(at[k].v - exact.y)));
      worst = std::max(worst, off);
      ASSERT_LT(off, 3e-16) << target << " " << d[k].x << " " << d[k].y << " " << d[k].z;
    }
    RecordProperty(std::string("of_a_face_") + target, std::to_string(worst * 1e16) + "e-16");
  });
}

// An edge or a corner of the cube belongs to the first of X, Y, Z.
TEST(Kernels, CubeEdgesGoToTheFirstAxis) {
  const double e = std::sqrt(0.5), c = std::sqrt(1.0 / 3);
  const std::vector<Direction> d{{e, e, 0}, {-e, e, 0}, {0, e, e}, {0, -e, e}, {e, 0, -e}, {c, c, c}, {-c, -c, -c}};
  const int faces_wanted[] = {0, 1, 2, 3, 0, 0, 1};
  std::vector<Location<double>> at(d.size());
  on_every_target([&](const char* target) {
    locate(Projection::cube, d, at);
    for (std::size_t k = 0; k < d.size(); ++k) EXPECT_EQ(at[k].face, faces_wanted[k]) << target << " " << k;
  });
}

TEST(Kernels, RotatesLikeTheMatrix) {
  const auto all = hard_directions();
  const Rotation turn = rotation(12, 34, 56);
  on_every_target([&](const char* target) {
    for (std::size_t n = 0; n <= 40; ++n) {
      std::vector<Direction> d(all.begin() + 900, all.begin() + 900 + std::ptrdiff_t(n));
      rotate(turn, d);
      for (std::size_t k = 0; k < n; ++k) ASSERT_EQ(d[k], turn * all[900 + k]) << target << n;
    }
  });
}

// Beyond its sides an octahedral map goes on with itself, however far: half turns about the middles of the sides.
TEST_P(EachKernel, OctahedralMapsRepeatThemselves) {
  if (!is_octahedral(GetParam())) GTEST_SKIP() << "no net of an octahedron";
  std::vector<Point2> inside, beyond;
  for (const double u : {0.1, 0.25, 0.6, 0.99})
    for (const double v : {0.02, 0.3, 0.75})
      for (const Point2 over :
           {Point2(-u, 1 - v), Point2(2 - u, 1 - v), Point2(1 - u, -v), Point2(1 - u, 2 - v), Point2(u - 1, v - 1),
            Point2(u + 1, v + 1), Point2(u + 2, v), Point2(u - 1, v + 3), Point2(2 - u, -1 - v)})
        inside.emplace_back(u, v), beyond.push_back(over);
  std::vector<Direction> wanted(inside.size()), found(inside.size());
  on_every_target([&](const char* target) {
    directions(GetParam(), 0, inside, wanted);
    directions(GetParam(), 0, beyond, found);
    for (std::size_t k = 0; k < inside.size(); ++k) {
      ASSERT_LT(glm::length(wanted[k] - found[k]), 3e-15) << target << " " << beyond[k].x << " " << beyond[k].y;
      const Direction plain =
          visit(GetParam(), [&](auto q) { return decltype(q)::direction(0, beyond[k].x, beyond[k].y); });
      ASSERT_LT(glm::length(wanted[k] - plain), 3e-15);
    }
  });
}

// Spans of every length: each element as in the whole, nothing beyond.
TEST_P(EachKernel, RemaindersStayInBounds) {
  const auto uv = points(GetParam());
  const auto d = hard_directions();
  const int size = 40;
  on_every_target([&](const char* target) {
    std::vector<Direction> texels(17), continued(17);
    std::vector<Location<double>> at(17);
    texel_directions(GetParam(), size, 0, 0, 12, texels);
    directions(GetParam(), 0, std::span(uv).first(17), continued);
    locate(GetParam(), std::span(d).first(17), at);
    for (std::size_t n = 0; n <= 17; ++n) {
      const Direction mark(-7, -7, -7);
      std::vector<Direction> part(n + 1, mark), part_continued(n + 1, mark);
      std::vector<Location<double>> part_at(n + 1, {-7, -7, -7});
      // Exact heap blocks, so that a sanitizer sees a read beyond them.
      const std::vector<Direction> part_d(d.begin(), d.begin() + std::ptrdiff_t(n));
      const std::vector<Point2> part_uv(uv.begin(), uv.begin() + std::ptrdiff_t(n));
      texel_directions(GetParam(), size, 0, 0, 12, std::span(part).first(n));
      directions(GetParam(), 0, part_uv, std::span(part_continued).first(n));
      locate(GetParam(), part_d, std::span(part_at).first(n));
      for (std::size_t k = 0; k < n; ++k) {
        ASSERT_EQ(part[k], texels[k]) << target << n;
        ASSERT_EQ(part_continued[k], continued[k]) << target << n;
        ASSERT_TRUE(part_at[k].u == at[k].u && part_at[k].v == at[k].v && part_at[k].face == at[k].face) << target << n;
      }
      ASSERT_EQ(part[n], mark);
      ASSERT_EQ(part_continued[n], mark);
      ASSERT_EQ(part_at[n].face, -7);
      ASSERT_EQ(part_at[n].u, -7);
    }
  });
}

TEST_P(EachKernel, SameBitsOnEveryTarget) {
  const auto uv = points(GetParam());
  const auto d = hard_directions();
  std::vector<double> first;
  on_every_target([&](const char* target) {
    std::vector<double> all;
    const auto keep = [&](const std::vector<Direction>& found) {
      for (const Direction& f : found) all.insert(all.end(), {f.x, f.y, f.z});
    };
    for (const Piece& r : pieces(GetParam())) {
      std::vector<Direction> texels(r.count);
      texel_directions(GetParam(), r.size, r.face, r.row, r.first, texels);
      keep(texels);
    }
    std::vector<Direction> continued(uv.size());
    directions(GetParam(), 0, uv, continued);
    keep(continued);
    std::vector<Location<double>> at(d.size());
    locate(GetParam(), d, at);
    for (const auto& l : at) all.insert(all.end(), {double(l.face), l.u, l.v});
    if (first.empty()) first = all;
    ASSERT_EQ(all.size(), first.size());
    EXPECT_EQ(std::memcmp(all.data(), first.data(), all.size() * sizeof(double)), 0) << target;
  });
}

}  // namespace
}  // namespace envmap::kernels_test

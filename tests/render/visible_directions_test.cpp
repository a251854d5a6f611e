// What a mirror shows, against rays reflected at random places of it.
#include "envmap/scenes/render/visible_directions.h"

#include <gtest/gtest.h>

#include <random>

#include "envmap/projection/visit.h"
#include "rooms.h"

namespace envmap::visible_directions_test {
namespace {

using Vector4 = glm::vec<4, double, glm::highp>;

// A square in the plane y = 0, facing up, bulging by its normals only.
Mesh plate(double half, double bulge) {
  Mesh mesh;
  for (const auto& [x, z] : {std::pair(-1, -1), {-1, 1}, {1, 1}, {1, -1}}) {
    mesh.positions.emplace_back(half * x, 0, half * z);
    mesh.normals.push_back(glm::normalize(glm::vec3(bulge * x, 1, bulge * z)));
  }
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

struct Ray {
  Direction from, along;
};

// Rays from the viewer to random places of a mesh, turned there; those that the viewer's planes hide left out.
std::vector<Ray> rays(const Viewer& viewer, const Mesh& mesh, const Matrix& world, const MirrorOptics& optics) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform;
  std::vector<Ray> shown;
  const Rotation normals = glm::transpose(glm::inverse(Rotation(world)));
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
    for (int n = 0; n < 12; ++n) {
      double a = uniform(random), b = uniform(random);
      if (a + b > 1) a = 1 - a, b = 1 - b;
      std::array<Direction, 3> p, v;
      for (std::size_t k = 0; k < 3; ++k) {
        p[k] = Direction(world * Vector4(mesh.positions[mesh.indices[i + k]], 1));
        v[k] = glm::normalize(normals * Direction(mesh.normals[mesh.indices[i + k]]));
      }
      const Direction at = p[0] * (1 - a - b) + p[1] * a + p[2] * b;
      if (!optics.double_sided && glm::dot(glm::cross(p[1] - p[0], p[2] - p[0]), viewer.at - at) <= 0) continue;
      bool seen = true;
      for (const Vector4& plane : viewer.planes) seen = seen && glm::dot(Direction(plane), at) + plane.w >= 0;
      if (seen)
        shown.push_back({at, optics.turned(glm::normalize(at - viewer.at),
                                           glm::normalize(v[0] * (1 - a - b) + v[1] * a + v[2] * b))});
    }
  return shown;
}

double beyond(const Direction& ray, const std::vector<DirectionCone>& caps) {
  double nearest = 10;
  for (const DirectionCone& cap : caps) nearest = std::min(nearest, angle_between(ray, cap.axis) - cap.angle);
  return nearest;
}

// Every ray lies in a cap, all its points seen from a middle do,
// and it lies in a face that is said to be reached. @return how many faces are.
int expect_held(const Viewer& viewer, const Mesh& mesh, const Matrix& world, const MirrorOptics& optics) {
  const std::vector<DirectionCone> caps = reflection_bounds(viewer, mesh, world, optics).caps;
  const Rotation axes = rotation(20, 30, 40);
  const auto reached = reached_faces(caps, axes, 0);
  const DirectionCone all = caps.empty() ? DirectionCone{{0, 0, 1}, 0} : enclosing(caps);
  const Direction middle = Direction(world[3]) + Direction(0.1, 0.05, 0);
  const std::vector<DirectionCone> swept = reflection_bounds(viewer, mesh, world, optics, middle).caps;
  for (const auto& [from, ray] : rays(viewer, mesh, world, optics)) {
    EXPECT_LE(beyond(ray, caps), 1e-9);
    for (const double distance : {0.0, 0.1, 0.5, 2.0, 10.0})
      EXPECT_LE(beyond(glm::normalize(from + distance * ray - middle), swept), 1e-6) << distance;
    EXPECT_LE(angle_between(ray, all.axis), all.angle + 1e-9);
    EXPECT_TRUE(reached[Cube::locate(glm::transpose(axes) * ray).face]);
  }
  return int(std::ranges::count(reached, true));
}

TEST(VisibleDirections, EveryRayOfAMirrorIsHeld) {
  const Matrix place = glm::translate(Matrix(1), Direction(0.2, 0.1, -4)) * glm::scale(Matrix(1), Direction(1, 2, 0.5));
  for (const Direction& at : {Direction(0, 0, 3), Direction(0.5, 3, -3), Direction(2, 0, -4)}) {
    expect_held({at, {}}, rooms::ball(4), place, {});
    expect_held({at, {}}, rooms::ball(5), Matrix(1), {});
    for (const double bulge : {0.0, 0.1, 1.0}) {
      expect_held({at, {}}, plate(2, bulge), Matrix(1), {0, true});
      expect_held({at, {}}, plate(2, bulge), place, {0, true});
    }
  }
}

TEST(VisibleDirections, EveryRayOfALensIsHeld) {
  for (const double ior : {1.0, 1.33, 2.4}) {
    expect_held({{0.5, 3, -3}, {}}, plate(2, 0.3), Matrix(1), {ior, true});
    expect_held({{0.5, 3, -3}, {}}, rooms::ball(4), Matrix(1), {ior, false});
    expect_held({{0.5, 3, -3}, {}}, rooms::ball(4), Matrix(1), {ior, true});
  }
}

TEST(VisibleDirections, WhatIsOutOfSightNeedsNothing) {
  const Vector4 ahead(0, 0, -1, 0);  // The viewer at the origin sees -Z.
  EXPECT_TRUE(reflection_bounds({{0, 0, 0}, {ahead}}, rooms::ball(4), glm::translate(Matrix(1), Direction(0, 0, 5)), {})
                  .caps.empty());
  EXPECT_TRUE(reflection_bounds({{0, -2, 0}, {}}, plate(1, 0), Matrix(1), {}).caps.empty()) << "seen from behind";
  EXPECT_FALSE(reflection_bounds({{0, -2, 0}, {}}, plate(1, 0), Matrix(1), {0, true}).caps.empty());
  expect_held({{0, 0, 0}, {ahead}}, rooms::ball(4), glm::translate(Matrix(1), Direction(0, 0, -0.5)), {});
}

TEST(VisibleDirections, AFlatMirrorTakesOneHalfAndABallTakesAll) {
  const VisibleCone shown = reflection_bounds({{0, 2, 3}, {}}, plate(1, 0), Matrix(1), {});
  EXPECT_NEAR(shown.widening, 1, 1e-9);
  const std::vector<DirectionCone>& flat = shown.caps;
  const DirectionCone all = enclosing(flat);
  EXPECT_LT(all.angle, 0.6);
  EXPECT_GT(all.axis.y, 0.3);
  EXPECT_LT(all.axis.z, -0.3);
  EXPECT_LE(expect_held({{0, 2, 3}, {}}, plate(1, 0), Matrix(1), {}), 3);
  EXPECT_EQ(expect_held({{0, 0, 3}, {}}, rooms::ball(6), Matrix(1), {}), 6);
  EXPECT_GT(enclosing(reflection_bounds({{0, 0, 3}, {}}, rooms::ball(16), Matrix(1), {}).caps).angle, pi / 2);
}

TEST(VisibleDirections, AFaceIsReachedWhereACapTouchesIt) {
  const auto reached = [](const Direction& axis, double angle) {
    return reached_faces(std::vector{DirectionCone{glm::normalize(axis), angle}}, Rotation(1), 0);
  };
  EXPECT_EQ(reached({0, 0, 1}, 0.78), (std::array{false, false, false, false, true, false}));
  EXPECT_EQ(reached({0, 0, 1}, 0.79), (std::array{true, true, true, true, true, false}));
  EXPECT_EQ(reached({1, 0, 1}, 0.01), (std::array{true, false, false, false, true, false}));
  EXPECT_EQ(reached({-1, -1, -1}, 0.01), (std::array{false, true, false, true, false, true}));
  EXPECT_EQ(reached({0, 1, 0}, pi), (std::array{true, true, true, true, true, true}));
}

}  // namespace
}  // namespace envmap::visible_directions_test

// The error of depth that is interpolated between moved vertices: an edge of
// length l whose ends are both d away is thought to be d away all along, and is sqrt(d^2 - l^2 / 4) away in its middle.
#include <gtest/gtest.h>

#include <cmath>

#include "drawing.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/render/renderer.h"

namespace depth_bound_test {
namespace {

using namespace envmap;

constexpr double ahead = 1, half = 2;
const double d = std::sqrt(ahead * ahead + 2 * half * half), l = 2 * std::sqrt(2) * half;
const double bound = d - std::sqrt(d * d - 0.25 * l * l);

// A square at z that faces the origin, `cells` along each side.
void add_square(SceneGraph& scene, const Direction& middle, double side, int cells, const Colour& colour) {
  Mesh mesh{.material = int(scene.materials.size())};
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) {
      mesh.positions.emplace_back(middle + side * Direction(1 - 2.0 * i / cells, 1 - 2.0 * j / cells, 0));
      mesh.normals.emplace_back(0, 0, -1);
      mesh.coordinates.emplace_back(0, 0);
    }
  const auto vertex = [&](int i, int j) { return std::uint32_t(j * (cells + 1) + i); };
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i)
      for (const std::uint32_t k :
           {vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1), vertex(i, j), vertex(i + 1, j + 1), vertex(i + 1, j)})
        mesh.indices.push_back(k);
  scene.materials.push_back({.base_colour = {0, 0, 0, 1}, .emissive = colour, .double_sided = true});
  scene.nodes.push_back({.meshes = {int(scene.meshes.size())}});
  scene.meshes.push_back(std::move(mesh));
}

// Whether the middle of a map shows a card that stands so far behind a wall of two triangles.
bool shows_card(DrawMethod method, Projection to, double behind) {
  SceneGraph scene;
  add_square(scene, {0, 0, ahead}, half, 1, Colour(1, 0, 0));
  add_square(scene, {0, 0, ahead + behind}, 0.4, 16, Colour(0, 1, 0));
  drawing::context();
  Renderer renderer(scene, nullptr);
  const FrameState shot{scene, pose(scene, 0)};
  const Viewpoint from{.to = to, .size = 65};
  const Drawn map = method == DrawMethod::raycast ? raycast(shot, from) : draw(renderer, from, shot, method);
  const Colour seen = *map.radiance.base().texel(0, 32, 32);
  EXPECT_TRUE(seen == Colour(1, 0, 0) || seen == Colour(0, 1, 0)) << seen.x << " " << seen.y;
  return seen == Colour(0, 1, 0);
}

TEST(DepthBound, MovedVerticesShowWhatLiesBehindAWallByLessThanTheBound) {
  EXPECT_NEAR(bound, 2, 1e-12);
  for (const Projection to : {Projection::paraboloid, Projection::sphere}) {
    EXPECT_TRUE(shows_card(DrawMethod::distort, to, 0.95 * bound)) << name(to);
    EXPECT_FALSE(shows_card(DrawMethod::distort, to, 1.05 * bound)) << name(to);
    for (const double part : {0.05, 0.95, 1.05})
      for (const DrawMethod method : {DrawMethod::exact, DrawMethod::raycast})
        EXPECT_FALSE(shows_card(method, to, part * bound)) << name(to) << " " << part;
  }
}

// Of an edge cut into n pieces the bound is that of a piece, about l^2 / (8 n^2 d).
TEST(DepthBound, FallsWithTheSquareOfThePieces) {
  const auto of = [](double distance, double length) {
    return distance - std::sqrt(distance * distance - 0.25 * length * length);
  };
  for (const int n : {4, 8, 16, 32}) EXPECT_NEAR(of(d, l / n) * 8 * n * n * d / (l * l), 1, 0.6 / n);
}

}  // namespace
}  // namespace depth_bound_test

// Cast maps against what geometry says without a tree of boxes.
#include "envmap/scenes/render/rays/raycast.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "envmap/operate/generate.h"
#include "envmap/operate/lookup.h"
#include "envmap/scenes/render/rays/texture_sample.h"
#include "envmap/scenes/render/shading/shading.h"
#include "envmap/scenes/scene/mesh.h"

namespace raycast_test {
namespace {

using namespace envmap;

// A square of two triangles, |x| and |y| <= 1 at z = 0, whose front looks along +Z.
Mesh square(int material) {
  Mesh mesh{.material = material,
            .positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}},
            .coordinates = {{0, 1}, {1, 1}, {1, 0}, {0, 0}},
            .indices = {0, 1, 2, 0, 2, 3}};
  complete(mesh);
  return mesh;
}

constexpr Direction wall_axes[6] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
Colour wall_colour(int axis) { return Colour(1 + axis, axis == 2 ? 0.5F : 7, 10 - axis); }

// A box of half side `half` about the origin whose six walls shine inwards, +X -X +Y -Y +Z -Z.
SceneGraph box(double half, bool inwards = true) {
  SceneGraph scene;
  for (int k = 0; k < 6; ++k) {
    scene.materials.push_back({.base_colour = glm::vec4(0, 0, 0, 1), .metallic = 1, .emissive = wall_colour(k)});
    scene.meshes.push_back(square(k));
    const Direction front = inwards ? -wall_axes[k] : wall_axes[k];
    const Direction up = std::abs(front.y) > 0.5 ? Direction(0, 0, 1) : Direction(0, 1, 0),
                    right = glm::cross(up, front);
    Matrix m(1);
    m[0] = {half * right, 0};
    m[1] = {half * up, 0};
    m[2] = {half * front, 0};
    m[3] = {half * wall_axes[k], 1};
    scene.nodes.push_back({.name = std::to_string(k), .local = m, .meshes = {k}});
  }
  return scene;
}

FrameState shot_of(const SceneGraph& scene) { return {.scene = scene, .pose = pose(scene, 0)}; }

// For every texel that carries the map: its number, its ray and its place.
template <class F>
void each_texel(const Viewpoint& v, F&& f) {
  const int width = v.size * aspect(v.to);
  for (int face = 0; face < faces(v.to); ++face)
    for (int j = 0; j < v.size; ++j) {
      const Columns in = columns(v.to, v.size, j);
      std::vector<Direction> rays(in.count());
      texel_directions(v.to, v.size, face, j, in.first, rays);
      for (int i = in.first; i < in.end; ++i)
        f(face, i, j, std::size_t((face * v.size + j) * width + i), v.axes * rays[i - in.first]);
    }
}

TEST(Raycast, InsideOfABoxInAllProjections) {
  const SceneGraph scene = box(2);
  for (const Projection to : all_projections)
    for (const Direction& at : {Direction(0), Direction(0.7, -1.2, 1.9)}) {
      const Viewpoint v{.to = to, .size = 64, .at = at, .axes = rotation(30, 40, 50)};
      const Drawn drawn = raycast(shot_of(scene), v);
      int wrong = 0, edges = 0;
      each_texel(v, [&](int face, int i, int j, std::size_t n, const Direction& ray) {
        double distance = 1e9;
        int wall = -1;
        double second = 1e9;
        for (int k = 0; k < 6; ++k) {
          const double slope = glm::dot(ray, wall_axes[k]), t = (2 - glm::dot(at, wall_axes[k])) / slope;
          if (slope <= 0) continue;
          if (t < distance)
            second = distance, distance = t, wall = k;
          else
            second = std::min(second, t);
        }
        if (second < distance * (1 + 1e-5)) {  // A ray into an edge may see either wall.
          ++edges;
          return;
        }
        wrong += drawn.surfaces[n] != unsigned(wall + 1);
        EXPECT_NEAR(drawn.distances[n], distance, 2e-6 * distance);
        EXPECT_LT(glm::length(*drawn.radiance.base().texel(face, i, j) - wall_colour(wall)), 1e-5F);
      });
      EXPECT_EQ(wrong, 0) << name(to);
      EXPECT_LT(edges, 200);
    }
}

TEST(Raycast, BeyondTheDiscIsNothingAndAParaboloidIsFull) {
  const SceneGraph scene = box(1);
  for (const Projection to : {Projection::sphere, Projection::angular, Projection::paraboloid}) {
    const Drawn drawn = raycast(shot_of(scene), {.to = to, .size = 16, .samples = 4});
    const bool filled = to == Projection::paraboloid;
    EXPECT_EQ(*drawn.radiance.base().texel(0, 0, 0) != Colour(0), filled);
    EXPECT_EQ(drawn.surfaces[0] != 0, filled);
    EXPECT_EQ(std::isinf(drawn.distances[0]), !filled);
  }
}

TEST(Raycast, SidesSpheresAndNodesLeftOut) {
  SceneGraph scene = box(1, false);
  const Viewpoint v{.to = Projection::cube, .size = 9};
  const auto hits = [&](const Viewpoint& from) {
    const Drawn drawn = raycast(shot_of(scene), from);
    return std::ranges::count_if(drawn.surfaces, [](std::uint32_t s) { return s != 0; });
  };
  EXPECT_EQ(hits(v), 0) << "from the back nothing is seen";
  for (Material& m : scene.materials) m.double_sided = true;
  EXPECT_EQ(hits(v), 6 * 81);
  // Nearer than 1.2: what lies within 33.6 degrees of an axis.
  int within = 0;
  each_texel(v, [&](int, int, int, std::size_t, const Direction& d) {
    within += 1 / std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) < 1.2;
  });
  EXPECT_EQ(hits({.to = Projection::cube, .size = 9, .far = 1.2}), within);
  EXPECT_EQ(hits({.to = Projection::cube, .size = 9, .near = 1.2}), 6 * 81 - within);
  EXPECT_EQ(hits({.to = Projection::cube, .size = 9, .without = 2}), 5 * 81);
  // A mirrored node turns its triangles round, and with them their fronts (glTF 2.0, 3.7.4): outside stays outside.
  for (Material& m : scene.materials) m.double_sided = false;
  for (Node& node : scene.nodes) node.local = glm::scale(Matrix(1), Direction(-1, 1, 1)) * node.local;
  EXPECT_EQ(hits(v), 0);
  EXPECT_GT(hits({.to = Projection::cube, .size = 9, .at = {3, 0.1, 0.1}}), 0);
}

TEST(Raycast, TexturesAndHoles) {
  SceneGraph scene;
  scene.textures.push_back({.width = 2,
                            .height = 2,
                            .texels = {{255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}, {255, 255, 255, 0}},
                            .srgb = false,
                            .wrap_u = Texture::Wrap::clamp,
                            .wrap_v = Texture::Wrap::clamp});
  scene.materials.push_back(
      {.base_colour_texture = 0, .metallic = 1, .emissive = Colour(1), .emissive_texture = 0, .alpha_cutoff = 0.5F});
  scene.meshes.push_back(square(0));
  scene.nodes.push_back({.local = glm::translate(Matrix(1), Direction(0, 0, -1)), .meshes = {0}});
  // Seen along -Z, x is right: texture coordinate (0,0) is the upper left corner.
  const Drawn drawn = raycast(shot_of(scene), {.to = Projection::cube, .size = 4});
  const Level& level = drawn.radiance.base();
  EXPECT_EQ(*level.texel(5, 0, 0), Colour(1, 0, 0));
  EXPECT_EQ(*level.texel(5, 3, 0), Colour(0, 1, 0));
  EXPECT_EQ(*level.texel(5, 0, 3), Colour(0, 0, 1));
  EXPECT_EQ(*level.texel(5, 3, 3), Colour(0)) << "a hole";
  EXPECT_EQ(drawn.surfaces[5 * 16 + 15], 0U);
}

TEST(Raycast, TexturesWrap) {
  Texture t{.width = 4, .height = 1, .srgb = false};
  for (int k = 0; k < 4; ++k) t.texels.emplace_back(51 * k, 0, 0, 255);
  const auto at = [&](double x) { return texture_at(t, {(x + 0.5) / 4, 0.5}).x * 5; };  // x in texels from a centre.
  EXPECT_NEAR(at(1.25), 1.25, 1e-5);
  EXPECT_NEAR(at(3.5), 1.5, 1e-5);
  EXPECT_NEAR(at(-1), 3, 1e-5);
  EXPECT_NEAR(at(401), 1, 1e-3);
  t.wrap_u = Texture::Wrap::mirror;
  EXPECT_NEAR(at(3.5), 3, 1e-5);
  EXPECT_NEAR(at(5), 2, 1e-5);
  EXPECT_NEAR(at(-2), 1, 1e-5);
  t.wrap_u = Texture::Wrap::clamp;
  EXPECT_NEAR(at(9), 3, 1e-5);
  EXPECT_NEAR(at(-9), 0, 1e-5);
  t.srgb = true;
  EXPECT_NEAR(texture_at(t, {0.625F, 0.5F}).x, std::pow((0.4 + 0.055) / 1.055, 2.4), 1e-6);
}

TEST(Raycast, ASphereInAWhiteRoomIsInvisibleAndItsNormalsAreSmooth) {
  const Environment white(generate(Constant{Direction(1)}, Projection::cube, 8), 4);
  SceneGraph scene;
  scene.materials.push_back({});
  Mesh ball;
  constexpr int n = 24;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= 2 * n; ++i) {
      const double a = pi * i / n, b = pi * j / n;
      const glm::vec3 p(std::sin(b) * std::cos(a), std::cos(b), -std::sin(b) * std::sin(a));
      ball.positions.push_back(p);
      ball.normals.push_back(p);
    }
  for (unsigned j = 0; j < n; ++j)
    for (unsigned i = 0; i < 2 * n; ++i) {
      const unsigned a = j * (2 * n + 1) + i, b = a + 2 * n + 1;
      for (const unsigned k : {a, b, b + 1, a, b + 1, a + 1}) ball.indices.push_back(k);
    }
  complete(ball);
  scene.meshes = {ball};
  scene.nodes.push_back({.local = glm::scale(Matrix(1), Direction(1, 2, 0.5)), .meshes = {0}});
  FrameState shot{.scene = scene, .pose = pose(scene, 0), .environment = &white};
  for (const float metallic : {0.0F, 1.0F}) {
    scene.materials[0].metallic = metallic;
    scene.materials[0].roughness = 0.6F;
    const Drawn drawn = raycast(shot, {.to = Projection::cube, .size = 32, .at = {0, 0, 3}});
    int seen = 0;
    each_texel({.to = Projection::cube, .size = 32}, [&](int face, int i, int j, std::size_t k, const Direction&) {
      seen += drawn.surfaces[k] == 1;
      EXPECT_NEAR(drawn.radiance.base().texel(face, i, j)->y, 1, 5e-3);
    });
    EXPECT_GT(seen, 100);
  }
}

TEST(Raycast, SamplesAreTheMeanOfWhatTheySee) {
  // The wall ahead is half left out: an edge through the middle of texels at an odd size.
  SceneGraph scene = box(1);
  const Drawn one = raycast(shot_of(scene), {.to = Projection::cube, .size = 65, .at = {0.1, 0.2, 0.3}});
  const Drawn many =
      raycast(shot_of(scene),
              {.to = Projection::cube, .size = 65, .at = {0.1, 0.2, 0.3}, .samples = 256, .which = 1U << 5});
  // Face -Z shows wall -Z, 1.3 away and 0.9 wide to the right: it ends at s = 0.9 / 1.3, t = 0.8 / 1.3.
  const double edge = (0.5 + 0.5 * 0.9 / 1.3) * 65;
  const int i = int(edge);
  const float part = float(edge - i);
  const Colour expected = part * wall_colour(5) + (1 - part) * wall_colour(0);
  EXPECT_LT(glm::length(*many.radiance.base().texel(5, i, 32) - expected), 0.05F);
  EXPECT_EQ(*one.radiance.base().texel(5, 32, 32), *many.radiance.base().texel(5, 32, 32));
}

// Triangles through the viewpoint, behind it, without area, tiny and huge.
TEST(Raycast, ExtremeTriangles) {
  SceneGraph scene;
  scene.materials.push_back(
      {.base_colour = glm::vec4(0, 0, 0, 1), .metallic = 1, .emissive = Colour(1), .double_sided = true});
  const auto mesh = [&](std::vector<glm::vec3> corners) {
    Mesh m{.positions = std::move(corners), .indices = {0, 1, 2}};
    complete(m);
    scene.meshes.push_back(m);
    scene.nodes.push_back({.meshes = {int(scene.meshes.size()) - 1}});
  };
  mesh({{-1, 0, -1}, {1, 0, -1}, {0, 0, 2}});  // Holds the viewpoint in its plane.
  mesh({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}});     // A point.
  mesh({{-1e-6F, -1e-6F, -0.1F}, {1e-6F, -1e-6F, -0.1F}, {0, 1e-6F, -0.1F}});
  mesh({{-1e6F, -1e6F, 5}, {1e6F, -1e6F, 5}, {0, 1e6F, 5}});  // All of +Z.
  const Drawn drawn = raycast(shot_of(scene), {.to = Projection::cube, .size = 33});
  each_texel({.to = Projection::cube, .size = 33}, [&](int face, int i, int j, std::size_t n, const Direction& d) {
    EXPECT_TRUE(std::isfinite(drawn.radiance.base().texel(face, i, j)->x));
    if (d.z > 0.01 && std::abs(d.y) > 0.01) {
      EXPECT_EQ(drawn.surfaces[n], 4U);
      EXPECT_NEAR(drawn.distances[n], 5 / d.z, 1e-5 / d.z);
    }
    if (d.z < -0.01 && std::abs(d.y) > 0.01) {
      EXPECT_EQ(drawn.surfaces[n], glm::length(Vec2<double>(d.x, d.y)) < 1e-9 ? 3U : 0U);
    }
  });
  EXPECT_EQ(drawn.surfaces[5 * 33 * 33 + 16 * 33 + 16], 3U) << "the tiny one fills the very middle";
}

}  // namespace
}  // namespace raycast_test

// Pictures by rays that go on from mirrors and through glass, against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "envmap/operate/generate.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/render/shading/shading.h"
#include "rooms.h"

namespace raycast_picture_test {
namespace {

using namespace envmap;

constexpr int size = 72;

Viewpoint camera(const Direction& at, double tangent = 0.5) {
  return {.size = size, .at = at, .far = 100, .lens = Lens{size, {tangent, tangent}, 0}};
}

std::vector<int> all_nodes(const SceneGraph& scene) {
  std::vector<int> nodes;
  for (std::size_t k = 0; k < scene.nodes.size(); ++k) nodes.push_back(int(k));
  return nodes;
}

std::vector<Colour> cast(const SceneGraph& scene, const Viewpoint& from, const Environment* sky, int bounces = 32) {
  return raycast_picture({.scene = scene, .pose = pose(scene, 0), .environment = sky}, from,
                         {.mirrors = all_nodes(scene), .bounces = bounces});
}

// f(pixel, its ray in the world).
void for_each_pixel(const std::vector<Colour>& picture, const Viewpoint& from, auto&& f) {
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i)
      f(picture[std::size_t(j * size + i)], from.axes * from.lens->ray((i + 0.5) / size, (j + 0.5) / size));
}

double difference(const Colour& seen, const Direction& expected) { return glm::length(Direction(seen) - expected); }

const Environment& directions() {
  static const Environment sky(generate(Directions{}, Projection::cube, 256), 8);
  return sky;
}
Direction colour_of(const Direction& d) { return 0.5 * (d + 1.0); }

SceneGraph ball_of(const Material& material, int rings = 128) {
  SceneGraph scene;
  scene.materials = {material};
  scene.meshes = {rooms::ball(rings)};
  scene.nodes = {{.name = "ball", .meshes = {0}}};
  return scene;
}

// Where a ray meets the unit ball about the origin; none where it passes or comes near its outline.
std::optional<Direction> on_ball(const Direction& from, const Direction& ray, double margin) {
  const double b = glm::dot(ray, from), root = b * b - glm::dot(from, from) + 1;
  if (root < margin) return std::nullopt;
  return from + (-b - std::sqrt(root)) * ray;
}

TEST(RayPictures, AMirrorBallShowsTheSkyThatTheSphereReflects) {
  const Viewpoint from = camera({0.4, 0.7, 3});
  int shown = 0;
  for_each_pixel(cast(ball_of({.metallic = 1, .roughness = 0}), from, &directions()), from,
                 [&](const Colour& seen, const Direction& ray) {
                   const auto place = on_ball(from.at, ray, 0.01);
                   if (!place) return;
                   ++shown;
                   EXPECT_LT(difference(seen, colour_of(glm::reflect(ray, *place))), 0.01);
                 });
  EXPECT_GT(shown, 1000);
}

// Snell's law twice and, in between, Schlick's reflections inside: in a ball all angles are the same, and each part is
// turned by pi - 2 refracted against the one before.
TEST(RayPictures, AGlassBallBendsLightWhereItLeaves) {
  constexpr double ior = 1.5, f0 = 0.04;
  const Viewpoint from = camera({0, 0, 3});
  const SceneGraph scene = ball_of({.roughness = 0, .transmission = 1, .ior = 1.5F, .solid = true});
  int shown = 0;
  for_each_pixel(cast(scene, from, &directions()), from, [&](const Colour& seen, const Direction& ray) {
    const auto place = on_ball(from.at, ray, 0.05);
    if (!place) return;
    ++shown;
    const double cosine = -glm::dot(ray, *place), reflected = f0 + (1 - f0) * std::pow(1 - cosine, 5);
    Direction expected = reflected * colour_of(glm::reflect(ray, *place));
    double part = 1 - reflected;
    Direction way = glm::refract(ray, *place, 1 / ior), at = *place;
    for (int k = 0; k < 12; ++k) {
      at -= 2 * glm::dot(at, way) * way;  // The other end of the chord.
      expected += part * (1 - reflected) * colour_of(glm::refract(way, -at, ior));
      way = glm::reflect(way, -at);
      part *= reflected;
    }
    EXPECT_LT(difference(seen, expected), 0.02);
  });
  EXPECT_GT(shown, 500);
}

TEST(RayPictures, AThinWallBendsNothing) {
  const Viewpoint from = camera({0.4, 0.7, 3});
  for (const bool solid : {false, true})  // A solid of index 1 does not, either.
    for_each_pixel(cast(ball_of({.roughness = 0, .transmission = 1, .ior = 1, .solid = solid}), from, &directions()),
                   from, [&](const Colour& seen, const Direction& ray) {
                     EXPECT_LT(difference(seen, colour_of(ray)), 0.01);
                   });
}

TEST(RayPictures, NothingWhiteIsSeenInWhite) {
  static const Environment white(generate(Constant{Direction(1)}, Projection::cube, 16), 8);
  const Material made[] = {{.metallic = 1, .roughness = 0},
                           {.metallic = 1, .roughness = 0.4F},
                           {.roughness = 0, .transmission = 1},
                           {.roughness = 0, .transmission = 1, .solid = true},
                           {.roughness = 0.1F, .transmission = 0.6F, .ior = 1.8F, .solid = true},
                           {.roughness = 0.3F}};
  SceneGraph scene;
  for (int k = 0; k < 6; ++k) {
    scene.materials.push_back(made[k]);
    scene.meshes.push_back(rooms::ball(24, 0.5));
    scene.meshes.back().material = k;
    scene.nodes.push_back(
        {.local = glm::translate(Matrix(1), Direction(k % 3 - 1, k / 3 - 0.5, 0.3 * (k % 2))), .meshes = {k}});
  }
  const Viewpoint from = camera({0.2, 0.3, 4});
  for (const int bounces : {1, 2, 32})
    for_each_pixel(cast(scene, from, &white, bounces), from,
                   [&](const Colour& seen, const Direction&) { EXPECT_LT(difference(seen, Direction(1)), 6e-3); });
}

// ---- flat mirrors in the coloured room ------------------------------------------------------------------------------

constexpr double half = 0.3;

// A square of half a side 0.3 at z, its front to +Z or -Z.
void add_plate(SceneGraph& scene, double z, float facing) {
  scene.materials.push_back({.metallic = 1, .roughness = 0});
  Mesh mesh{.material = int(scene.materials.size()) - 1};
  for (const auto& [x, y] : {std::pair(-half, -half), {half, -half}, {half, half}, {-half, half}}) {
    mesh.positions.emplace_back(facing * x, y, z);
    mesh.normals.emplace_back(0, 0, facing);
    mesh.coordinates.emplace_back(0, 0);
  }
  mesh.indices = {0, 1, 2, 0, 2, 3};
  scene.meshes.push_back(mesh);
  scene.nodes.push_back({.name = "plate", .meshes = {int(scene.meshes.size()) - 1}});
}

// By unfolding: what a ray shows after at most so many reflections; black after them. None beside an edge.
std::optional<Direction> between_plates(Direction at, Direction ray, std::initializer_list<double> plates,
                                        int bounces) {
  for (;; --bounces) {
    std::optional<double> nearest;
    for (const double z : plates) {
      const double distance = (z - at.z) / ray.z;
      if (distance > 1e-9) nearest = distance;
    }
    const Direction place = nearest ? at + *nearest * ray : at;
    const double reach = std::max(std::abs(place.x), std::abs(place.y));
    if (nearest && std::abs(reach - half) < 1e-3) return std::nullopt;
    if (!nearest || reach > half) return 0.5 * (at + rooms::hit(at, ray).distance * ray + 1.0);
    if (bounces == 0) return Direction(0);
    at = place;
    ray.z = -ray.z;
  }
}

TEST(RayPictures, AFlatMirrorShowsTheMirroredRoom) {
  SceneGraph scene = rooms::room(2);
  add_plate(scene, -0.5, 1);
  const Viewpoint from = camera({0.1, 0.05, 0.4});
  for_each_pixel(cast(scene, from, nullptr), from, [&](const Colour& seen, const Direction& ray) {
    if (const auto expected = between_plates(from.at, ray, {-0.5}, 1)) {
      EXPECT_LT(difference(seen, *expected), 0.01);
    }
  });
}

TEST(RayPictures, FacingMirrorsShowSoManyReflections) {
  SceneGraph scene = rooms::room(2);
  add_plate(scene, -0.5, 1);
  add_plate(scene, 0.5, -1);
  const Viewpoint from = camera({0.1, 0.05, 0.4}, 0.3);
  std::vector<int> black;
  for (const int bounces : {1, 2, 4, 32}) {
    black.push_back(0);
    for_each_pixel(cast(scene, from, nullptr, bounces), from, [&](const Colour& seen, const Direction& ray) {
      const auto expected = between_plates(from.at, ray, {-0.5, 0.5}, bounces);
      if (!expected) return;
      black.back() += *expected == Direction(0);
      EXPECT_LT(difference(seen, *expected), 0.02) << bounces;
    });
  }
  EXPECT_TRUE(black[0] > black[1] && black[1] > black[2] && black[2] > 0)
      << black[0] << " " << black[1] << " " << black[2];
}

}  // namespace
}  // namespace raycast_picture_test

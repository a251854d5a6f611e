// Filters of textures on what rays meet, against the mean of a checkered plane over each pixel in float64.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "envmap/sample/pyramid.h"
#include "envmap/scenes/render/rays/ray_differential.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/render/rays/texture_sample.h"
#include "envmap/scenes/render/shading/shading.h"
#include "small_scenes.h"

namespace texture_filter_test {
namespace {

using namespace envmap;

constexpr int width = 96, height = 72, check = 16;
constexpr double half = 2000, metre = 0.5;  // Of the plane; and of a check.

// Two by two checks, black and white.
Texture checkers() {
  Texture t{.width = 2 * check, .height = 2 * check};
  for (int j = 0; j < t.height; ++j)
    for (int i = 0; i < t.width; ++i) t.texels.emplace_back(glm::u8vec3(i / check == j / check ? 255 : 0), 255);
  return t;
}

// A plane at y = 0 that shines. Texture coordinates rise by one over two checks, from the origin.
SceneGraph checkered_plane() {
  SceneGraph scene;
  scene.textures = {checkers()};
  Mesh mesh = small_scenes::square(float(half));
  for (std::size_t k = 0; k < mesh.positions.size(); ++k)
    mesh.coordinates[k] = glm::vec2(mesh.positions[k].x, mesh.positions[k].z) / float(2 * metre);
  small_scenes::add(scene, std::move(mesh),
                    {.base_colour = {0, 0, 0, 1}, .emissive = Colour(1), .emissive_texture = 0, .ior = 1});
  return scene;
}

// One metre over the plane, a little downwards: the plane reaches almost to the horizon. X stays level in the picture.
Viewpoint camera(int samples = 1) {
  const Direction back = glm::normalize(Direction(0, 0.25, 1)), right(1, 0, 0);
  return {.size = height,
          .at = {0.13, 1, 0.21},
          .axes = {right, glm::cross(back, right), back},
          .far = 3000,
          .samples = samples,
          .lens = Lens{width, {0.5 * width / height, 0.5}, 0}};
}

// Of a square wave, 1 from 0 to a check and then -1: its integral from 0.
double integral_of_wave(double x) {
  const double period = 2 * metre, in = x - period * std::floor(x / period);
  return std::min(in, period - in);
}
double wave(double x) { return std::fmod(std::floor(x / metre), 2) == 0 ? 1 : -1; }

// The mean of a pixel that sees nothing but the plane, where the texture is known without texels:
// (1 + wave(x) wave(z)) / 2. Along a row of the picture z is one, and x goes evenly: a closed form. Across it, 512.
std::optional<double> truth(int i, int j) {
  constexpr int n = 512;
  const Viewpoint from = camera();
  const auto place = [&](double x, double y) -> std::optional<Direction> {
    const Direction ray = from.axes * from.lens->ray(x / width, y / height), there = from.at - from.at.y / ray.y * ray;
    if (ray.y >= 0 || std::max(std::abs(there.x), std::abs(there.z)) > half) return std::nullopt;
    return there;
  };
  double sum = 0;
  for (int b = 0; b < n; ++b) {
    const auto left = place(i, j + (b + 0.5) / n), right = place(i + 1, j + (b + 0.5) / n);
    if (!left || !right) return std::nullopt;
    sum += wave(left->z) * (integral_of_wave(right->x) - integral_of_wave(left->x)) / (right->x - left->x);
  }
  return 0.5 + 0.5 * sum / n;
}

const std::vector<std::optional<double>>& truths() {
  static const auto all = [] {
    std::vector<std::optional<double>> means;
    for (int j = 0; j < height; ++j)
      for (int i = 0; i < width; ++i) means.push_back(truth(i, j));
    return means;
  }();
  return all;
}

std::vector<Colour> cast(const SceneGraph& scene, const Viewpoint& from, TextureFilter filter,
                         std::vector<int> mirrors = {}) {
  return raycast_picture({.scene = scene, .pose = pose(scene, 0)}, from,
                         {.mirrors = std::move(mirrors), .texture_filter = filter});
}

// The rms difference to truths() in some rows of a picture.
double error(const std::vector<Colour>& picture, int first, int end) {
  double sum = 0;
  int count = 0;
  for (int k = first * width; k < end * width; ++k)
    if (const auto mean = truths()[std::size_t(k)]) {
      const double off = picture[std::size_t(k)].x - *mean;
      sum += off * off, ++count;
    }
  EXPECT_GT(count, 0);
  return std::sqrt(sum / count);
}

constexpr int horizon = 19, near = 36;  // Rows: the first that sees only the plane, and where checks span some pixels.

// Far off and near: nearest 0.42 0.14, bilinear 0.40 0.07, nearest-level 0.14 0.07, trilinear 0.14 0.06, ewa 0.02 0.02.
TEST(TextureFilters, ErrorsOfARecedingPlaneFallInTheirOrder) {
  const SceneGraph scene = checkered_plane();
  std::array<double, enumerators<TextureFilter>> far_off{}, nearby{};
  for (std::size_t k = 0; k < far_off.size(); ++k) {
    const auto picture = cast(scene, camera(), TextureFilter(k));
    far_off[k] = error(picture, horizon, near);
    nearby[k] = error(picture, near, height);
  }
  for (const auto& [nearest, bilinear, nearest_level, trilinear, ewa] : {far_off, nearby}) {
    EXPECT_LT(bilinear, nearest);
    EXPECT_LT(nearest_level, 1.1 * bilinear);  // Near by there is little to filter.
    EXPECT_LT(trilinear, nearest_level);
    EXPECT_LT(ewa, 0.4 * trilinear);
    EXPECT_LT(ewa, 0.025);
  }
  EXPECT_GT(far_off[1], 0.3);               // Without levels the distance is noise;
  EXPECT_LT(far_off[2], 0.5 * far_off[1]);  // with them it is grey.
}

// Four rays a pixel cover a quarter each.
TEST(TextureFilters, SamplesShareThePixel) {
  const auto picture = cast(checkered_plane(), camera(4), TextureFilter::trilinear);
  EXPECT_LT(error(picture, near, height), 0.05);
}

// Against 64 rays a pixel.
TEST(TextureFilters, FootprintsGoOnFromMirrors) {
  SceneGraph scene = checkered_plane();
  Mesh mirror = small_scenes::square(float(half));
  for (glm::vec3& p : mirror.positions) p = {p.x, -p.z, -6};
  for (glm::vec3& n : mirror.normals) n = {0, 0, 1};
  small_scenes::add(scene, std::move(mirror), {.metallic = 1, .roughness = 0});
  const int node = int(scene.nodes.size()) - 1;
  const auto shown = cast(scene, camera(), TextureFilter::ewa, {node});
  const auto rays = cast(scene, camera(64), TextureFilter::bilinear, {node});
  const auto none = cast(scene, camera(), TextureFilter::bilinear, {node});
  const auto rms = [&](const std::vector<Colour>& a) {
    double sum = 0;
    int count = 0;
    for (int k = (horizon + 2) * width; k < near * width; ++k, ++count) {
      const double off = a[std::size_t(k)].x - rays[std::size_t(k)].x;
      sum += off * off;
    }
    return std::sqrt(sum / count);
  };
  EXPECT_LT(rms(shown), 0.06);
  EXPECT_GT(rms(none), 0.2);
}

TEST(TextureFilters, TheCoarsestLevelIsTheMeanOfAllTexels) {
  SceneGraph scene;
  Texture t{.width = 5, .height = 3, .srgb = false};
  double sum = 0;
  for (int k = 0; k < 15; ++k) {
    const int code = k * k + 7;
    t.texels.emplace_back(code, 0, 0, 255);
    sum += code / 255.0 / 15;
  }
  scene.textures = {t};
  const TextureFootprint endless{{0.1F, 0.7F}, {1e4, 0}, {0, 1e4}};
  for (const TextureFilter filter : {TextureFilter::nearest_level, TextureFilter::trilinear, TextureFilter::ewa})
    EXPECT_NEAR(TextureSampler(scene, filter)(0, endless).x, sum, 1e-6);
}

// Of a plane that is seen along itself the derivative has no end.
TEST(TextureFilters, FootprintsWithoutEndShowTheCoarsestLevel) {
  SceneGraph scene;
  scene.textures = {checkers()};
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {inf, nan, 1e300})
    EXPECT_NEAR(TextureSampler(scene, TextureFilter::ewa)(0, {{0.1F, 0.2F}, {bad, 0}, {0, 1e-3}}).x, 0.5, 1e-6);
}

// GL_LINEAR_MIPMAP_NEAREST takes level ceil(lod + 1/2) - 1: the finer one where two are as near.
TEST(TextureFilters, NearestLevelRoundsAsOpenGlDoes) {
  const auto level = [](double lod) { return nearest_level_plan({{std::exp2(lod), 0}, {0, 1}}).lod; };
  EXPECT_EQ(level(0), 0);
  EXPECT_EQ(level(0.49), 0);
  EXPECT_EQ(level(0.5), 0);
  EXPECT_EQ(level(0.51), 1);
  EXPECT_EQ(level(1.49), 1);
  EXPECT_EQ(level(1.51), 2);
}

// A sphere of radius 1 about the origin: rays from a pixel and from one a little further, without derivatives.
struct Bounce {
  Direction place, along;
};
std::optional<Bounce> on_sphere(const Direction& from, const Direction& ray, double ratio) {
  const double b = glm::dot(ray, from), root = b * b - glm::dot(from, from) + 1;
  if (root < 0) return std::nullopt;
  const Direction place = from + (-b - std::sqrt(root)) * ray;
  return Bounce{place, ratio > 0 ? glm::refract(ray, place, ratio) : glm::reflect(ray, place)};
}

TEST(RayDifferentials, AreTheDerivativesOfRaysThatAreReflectedAndRefracted) {
  constexpr double step = 1e-6;
  const Direction from(0.2, 0.3, 3), raw(-0.1, -0.05, -1), across(1, 0, 0), down(0.1, -1, 0.2);
  const Direction ray = glm::normalize(raw);
  const RayDifferential spread{.along = {normalised_derivative(raw, across), normalised_derivative(raw, down)}};
  for (const double ratio : {0.0, 1 / 1.5, 1.2}) {
    const Bounce here = *on_sphere(from, ray, ratio);
    const RayDifferential there = spread.moved(ray, glm::length(here.place - from), here.place);
    // On a unit sphere the normal is the place.
    const RayDifferential left = ratio > 0 ? after_refraction(there, ray, here.place, there.origin, ratio)
                                           : after_reflection(there, ray, here.place, there.origin);
    for (std::size_t k = 0; k < 2; ++k) {
      const Direction way = k == 0 ? across : down;
      const Bounce high = *on_sphere(from, glm::normalize(raw + step * way), ratio);
      const Bounce low = *on_sphere(from, glm::normalize(raw - step * way), ratio);
      EXPECT_LT(glm::length(left.origin[k] - (high.place - low.place) / (2 * step)), 1e-6) << ratio;
      EXPECT_LT(glm::length(left.along[k] - (high.along - low.along) / (2 * step)), 1e-6) << ratio;
    }
  }
}

}  // namespace
}  // namespace texture_filter_test

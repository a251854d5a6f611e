// The water of samples/water: what springs keep; reflection and refraction by maps and by rays, against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "drawing.h"
#include "envmap/operate/generate.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "painter.h"

namespace water_test {
namespace {

using namespace envmap;
using namespace water;

TEST(Water, VolumeStaysAndEnergyDoesNotDrift) {
  constexpr double stiffness = 0.12;
  HeightField field(48, 31);
  field.drop(10, 12, 3, 1);
  field.drop(40, 3, 2, -0.5);
  EXPECT_NEAR(field.volume(), 0, 1e-12);
  const double first = field.energy(stiffness);
  double least = first, most = first;
  for (int k = 0; k < 5000; ++k) {
    field.step(stiffness);
    least = std::min(least, field.energy(stiffness));
    most = std::max(most, field.energy(stiffness));
  }
  EXPECT_NEAR(field.volume(), 0, 1e-9);
  EXPECT_GT(least, 0.85 * first);
  EXPECT_LT(most, 1.15 * first);
  for (int k = 0; k < 3000; ++k) field.step(stiffness, 0.99);
  EXPECT_LT(field.energy(stiffness), 1e-6 * first);
  EXPECT_NEAR(field.volume(), 0, 1e-9);
}

// A straight wave of one cosine. A column has two springs along it and four across corners: it is pulled back with
// (1 + sqrt 2) (2 - 2 cos q) x stiffness of its height, q = pi / columns.
TEST(Water, AWaveIsPulledBackAsTheSpringsSay) {
  constexpr int columns = 40;
  constexpr double stiffness = 0.1, q = std::numbers::pi / columns;
  HeightField field(columns, 3);
  for (int i = 0; i < columns; ++i) field.raise(i, std::cos(q * (i + 0.5)));
  field.step(stiffness);
  const double pull = (1 + std::numbers::sqrt2) * (2 - 2 * std::cos(q)) * stiffness;
  for (int i = 0; i < columns; ++i) EXPECT_NEAR(field.height(i, 1), (1 - pull) * std::cos(q * (i + 0.5)), 1e-12);
}

// A drop in the middle goes the same way in all four directions.
TEST(Water, WavesAreSymmetric) {
  HeightField field(40, 30);
  field.drop(19.5, 14.5, 3, 0.1);
  for (int k = 0; k < 60; ++k) field.step(0.12, 0.998);
  for (int j = 0; j < 30; ++j)
    for (int i = 0; i < 40; ++i) {
      ASSERT_NEAR(field.height(i, j), field.height(39 - i, j), 1e-12);
      ASSERT_NEAR(field.height(i, j), field.height(i, 29 - j), 1e-12);
    }
}

TEST(Water, CausticsMoveLight) {
  HeightField field(64, 40);
  const Basin basin;
  for (const float light : caustics(basin, field, {0, 1, 0})) ASSERT_NEAR(light, 1, 1e-5);
  field.drop(30, 20, 4, 0.05);
  double sum = 0, most = 0;
  for (const float light : caustics(basin, field, {0, 1, 0})) sum += light, most = std::max<double>(most, light);
  EXPECT_NEAR(sum, 64 * 40, 1e-2) << "light is moved, not made";
  EXPECT_GT(most, 1.1);
}

constexpr int width = 96, height = 54;

// Across the basin, from low above its edge.
Viewpoint camera() {
  const Direction at(0.2, 0.6, 1.3), back = glm::normalize(at - Direction(0, 0, -0.4));
  const Direction right = glm::normalize(glm::cross(Direction(0, 1, 0), back));
  return {.size = height, .at = at, .axes = {right, glm::cross(back, right), back}, .samples = 4,
          .lens = Lens{width, {0.4 * width / height, 0.4}}};
}

// By maps and by rays.
std::vector<std::vector<Colour>> both(const Pool& pool, const Environment* sky) {
  drawing::context();
  const FrameState shot{.scene = pool.scene, .pose = pose(pool.scene, 0), .environment = sky};
  return {Painter(pool, sky).paint(camera(), shot), raycast_picture(shot, camera(), {.mirrors = {pool.water_node}})};
}

// Where a ray of the picture meets still water; none where it misses it.
std::optional<Direction> still_water(const Basin& basin, const Direction& ray) {
  const Direction at = camera().at - camera().at.y / ray.y * ray;
  if (ray.y >= 0 || std::abs(at.x) > 0.95 * basin.wide || std::abs(at.z) > 0.92 * basin.deep) return {};
  return at;
}

// f(pixel, ray, where it meets the water).
void for_each_of_water(const Basin& basin, auto&& f) {
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      const Direction ray = camera().axes * camera().lens->ray((i + 0.5) / width, (j + 0.5) / height);
      if (const auto at = still_water(basin, ray)) f(j * width + i, ray, *at);
    }
}

// Of unpolarised light, from air.
double fresnel(double cosine, double eta) {
  const double within = std::sqrt(1 - eta * eta * (1 - cosine * cosine));
  const double across = (eta * cosine - within) / (eta * cosine + within),
               along = (eta * within - cosine) / (eta * within + cosine);
  return 0.5 * (across * across + along * along);
}

// The water alone, or with what it lies on.
Pool bare(const Basin& basin, bool with_floor) {
  Pool pool = make_pool(basin, HeightField(33, 21));
  for (Node& node : pool.scene.nodes)
    std::erase_if(node.meshes, [&](int mesh) { return mesh != pool.water && !(with_floor && mesh == pool.floor); });
  return pool;
}

// Under a sky of 1 above and 0 below. The library has Schlick's approximation of 1994: 0.045 off at most.
TEST(Water, StillWaterReflectsWhatFresnelSays) {
  const Basin basin;
  const Environment sky(generate(Sky{.zenith = Rgb<double>(1), .ground = Rgb<double>(0), .horizon = Rgb<double>(1)},
                                 Projection::cube, 64),
                        8);
  for (const auto& picture : both(bare(basin, false), &sky)) {
    double least = 1, most = 0;
    for_each_of_water(basin, [&](int pixel, const Direction& ray, const Direction&) {
      const double f0 = std::pow((1 - basin.eta) / (1 + basin.eta), 2),
                   schlick = f0 + (1 - f0) * std::pow(1 + ray.y, 5);
      ASSERT_NEAR(picture[pixel].x, schlick, 0.012);
      ASSERT_NEAR(picture[pixel].x, fresnel(-ray.y, basin.eta), 0.045);
      least = std::min<double>(least, picture[pixel].x), most = std::max<double>(most, picture[pixel].x);
    });
    EXPECT_LT(least, 0.07);
    EXPECT_GT(most, 0.2);
  }
}

TEST(Water, WhiteWaterInWhiteIsWhite) {
  const Basin basin{.tint = Colour(0)};
  const Environment sky(generate(Constant{}, Projection::cube, 8), 8);
  for (const auto& picture : both(bare(basin, false), &sky))
    for (const Colour& c : picture) ASSERT_NEAR(c.x, 1, 2e-3);
}

// A floor that shines in a colour that tells the place, seen where Snell's law says and as bright as Beer and Lambert's
// law leaves it on the slanting way up.
TEST(Water, StillWaterRefractsAndAbsorbsTheFloor) {
  const Basin basin;
  Pool pool = bare(basin, true);
  constexpr int n = 128;
  Texture ramp{.width = n, .height = n, .srgb = false, .wrap_u = Texture::Wrap::clamp, .wrap_v = Texture::Wrap::clamp};
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      ramp.texels.emplace_back(glm::u8vec4(255.0 * (i + 0.5) / n + 0.5, 255.0 * (j + 0.5) / n + 0.5, 0, 255));
  pool.scene.textures.push_back(ramp);
  pool.scene.materials.push_back({.base_colour = glm::vec4(0, 0, 0, 1),
                                  .emissive = Colour(1),
                                  .emissive_texture = int(pool.scene.textures.size()) - 1,
                                  .ior = 1});
  Mesh& floor = pool.scene.meshes[pool.floor];
  floor.material = int(pool.scene.materials.size()) - 1;
  for (std::size_t k = 0; k < floor.positions.size(); ++k)
    floor.coordinates[k] = {0.5 + 0.5 * floor.positions[k].x / basin.wide,
                            0.5 + 0.5 * floor.positions[k].z / basin.deep};
  for (const auto& picture : both(pool, nullptr)) {
    int seen = 0, off = 0;
    for_each_of_water(basin, [&](int pixel, const Direction& ray, const Direction& at) {
      const Direction within = glm::refract(ray, Direction(0, 1, 0), basin.eta),
                      place = at + basin.floor / within.y * within;
      const double u = 0.5 + 0.5 * place.x / basin.wide, v = 0.5 + 0.5 * place.z / basin.deep;
      if (std::min({u, v, 1 - u, 1 - v}) < 0.03) return;
      const double f0 = std::pow((1 - basin.eta) / (1 + basin.eta), 2),
                   let_in = (1 - f0) * (1 - std::pow(1 + ray.y, 5)), way = basin.floor / within.y;
      const double red = std::exp(-basin.tint.x * way), green = std::exp(-basin.tint.y * way);
      const double wrong =
          std::max(std::abs(picture[pixel].x - let_in * red * u), std::abs(picture[pixel].y - let_in * green * v));
      // Maps find the way by the floor's distance from their middle, which tells little of it just above.
      EXPECT_LT(wrong, 0.06) << place.x << " " << place.z;
      off += wrong > 0.02;
      ++seen;
    });
    EXPECT_GT(seen, 500);
    EXPECT_LT(off, seen / 100);
  }
}

// With waves and all that stands round: what is thin or hidden from the map's middle differs.
TEST(Water, MapsShowWhatRaysDo) {
  const Basin basin;
  const Direction sun = glm::normalize(Direction(-0.4, 0.8, 0.4));
  HeightField field(64, 40);
  Pool pool = make_pool(basin, field);
  field.drop(20, 12, 3, 0.04);
  for (int k = 0; k < 40; ++k) field.step(0.12);
  set_waves(pool, basin, field, sun);
  const Environment sky(generate(Gradient{{0.3, 0.3, 0.2}, {0.2, 0.5, 1.2}}, Projection::cube, 64), 16);
  const auto pictures = both(pool, &sky);
  double off = 0, sum = 0;
  for_each_of_water(basin, [&](int pixel, const Direction&, const Direction&) {
    const Colour d = pictures[0][pixel] - pictures[1][pixel];
    off += glm::dot(d, d), sum += glm::dot(pictures[1][pixel], pictures[1][pixel]);
  });
  EXPECT_LT(std::sqrt(off / sum), 0.16);
}

}  // namespace
}  // namespace water_test

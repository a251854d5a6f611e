#include "tradeoff/calibrate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <limits>
#include <optional>
#include <random>
#include <utility>

#include "cli/console.h"
#include "envmap/base/error.h"
#include "envmap/operate/convert.h"
#include "envmap/operate/measure.h"
#include "envmap/projection/cube.h"
#include "envmap/render/context.h"
#include "envmap/render/raycast.h"
#include "envmap/render/renderer.h"

namespace tools {
namespace {

using namespace envmap;

constexpr int repeats = 3;

// Nanoseconds of processor time, of all threads.
template <class Work>
double nanoseconds(Work&& work) {
  const std::clock_t start = std::clock();
  work();
  return 1e9 * double(std::clock() - start) / CLOCKS_PER_SEC;
}
// Of the quickest of several runs: what other programs do only adds. Some clocks tick a few times a millisecond, or
// less: short work is done as often as takes a while.
template <class Work>
double quickest(Work&& work) {
  constexpr double a_while = 3e7;
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0, times = 1; k < repeats;) {
    const double taken = nanoseconds([&] {
      for (int n = 0; n < times; ++n) work();
    });
    if (taken < a_while)
      times *= 4;
    else
      least = std::min(least, taken / times), ++k;
  }
  return least;
}

// What one more of something costs, from two runs with more and with less of it; where noise says less than nothing,
// a part of the whole.
double slope(double more, double less, double count) { return std::max(more - less, 0.01 * more) / count; }

// Noise and a sun: no filter has it easy.
EnvironmentMap landscape(int height) {
  EnvironmentMap map;
  map.levels.emplace_back(Projection::latlong, height);
  std::mt19937 random(17);
  for (int j = 0; j < height; ++j)
    for (Colour& c : map.base().row(0, j)) c = Colour(0.5F + 0.5F * float(random() % 1000) / 1000);
  *map.base().texel(0, height / 3, height / 4) = Colour(5000, 4000, 3000);
  return map;
}

// ---- filters --------------------------------------------------------------------------------------------------------

void measure_filters(Costs& costs) {
  constexpr int size = 64;
  const EnvironmentMap source = landscape(8 * size);
  const auto measure = [&](Cost cost, Filter filter, int samples) {
    ConvertOptions how{.to = {Projection::cube}, .size = size, .filter = filter, .samples = samples};
    if (filter == Filter::area) how.area_error = 1e-4;
    const Resampler resampler(source, how);
    costs[cost] = quickest([&] { (void)level_of(resampler.rows()); }) / texel_count(Projection::cube, size);
  };
  measure(Cost::nearest, Filter::nearest, 1);
  measure(Cost::bilinear, Filter::bilinear, 1);
  measure(Cost::bicubic, Filter::bicubic, 1);
  measure(Cost::bilinear_2, Filter::bilinear, 2);
  measure(Cost::bilinear_4, Filter::bilinear, 4);
  measure(Cost::ewa, Filter::ewa, 1);
  measure(Cost::bilinear_8, Filter::bilinear, 8);
  measure(Cost::area, Filter::area, 1);
}

// ---- scenes ---------------------------------------------------------------------------------------------------------

// A box seen from inside, `edge` vertices along each of its sides: 12 (edge - 1)^2 triangles.
Scene box(int edge) {
  Scene scene;
  scene.materials.push_back({.base_colour = {0, 0, 0, 1}, .emissive = Colour(1)});
  for (const Cube::Axes& axes : Cube::axes) {
    Mesh mesh;
    for (int j = 0; j < edge; ++j)
      for (int i = 0; i < edge; ++i) {
        const double s = 2.0 * i / (edge - 1) - 1, t = 1 - 2.0 * j / (edge - 1);
        mesh.positions.emplace_back(axes.forward + s * axes.right + t * axes.up);
        mesh.normals.emplace_back(-axes.forward);
        mesh.coordinates.emplace_back(0, 0);
      }
    const auto vertex = [&](int i, int j) { return std::uint32_t(j * edge + i); };
    for (int j = 0; j + 1 < edge; ++j)
      for (int i = 0; i + 1 < edge; ++i)
        mesh.indices.insert(mesh.indices.end(), {vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1), vertex(i, j),
                                                 vertex(i + 1, j + 1), vertex(i + 1, j)});
    scene.nodes.push_back({.name = "wall", .meshes = {int(scene.meshes.size())}});
    scene.meshes.push_back(std::move(mesh));
  }
  return scene;
}

constexpr int coarse = 64, fine = 256;

// Time of a method in few and in many texels, and with many triangles.
struct Times {
  double few, many, cut;
};
template <class Draw>
Times times_of(const Scene& plain, const Scene& cut, Draw&& draw) {
  draw(plain, coarse);  // Compiles what it draws with.
  return {quickest([&] { draw(plain, coarse); }), quickest([&] { draw(plain, fine); }),
          quickest([&] { draw(cut, coarse); })};
}

void measure_drawing(Costs& costs) {
  const Scene plain = box(2), cut = box(66);
  const auto triangles_more = double(triangles(cut) - triangles(plain));
  const auto texels_more = [](Projection p) { return texel_count(p, fine) - texel_count(p, coarse); };
  const auto view = [](Projection to, int size) { return Viewpoint{.to = to, .size = size}; };
  const Times rays = times_of(plain, cut, [&](const Scene& scene, int size) {
    (void)raycast({scene, pose(scene, 0)}, view(Projection::sphere, size));
  });
  costs[Cost::ray_texel] = slope(rays.many, rays.few, texels_more(Projection::sphere));
  costs[Cost::ray_triangle] = slope(rays.cut, rays.few, triangles_more);
  const Context context(ContextKind::automatic);
  Renderer of_plain(plain, nullptr), of_cut(cut, nullptr);
  const auto drawn = [&](Projection to, DrawMethod method) {
    return times_of(plain, cut, [&, to, method](const Scene& scene, int size) {
      (void)draw(&scene == &plain ? of_plain : of_cut, view(to, size), {scene, pose(scene, 0)}, method);
    });
  };
  const Times exact = drawn(Projection::sphere, DrawMethod::exact),
              cube = drawn(Projection::cube, DrawMethod::resample);
  const Times resampled = drawn(Projection::sphere, DrawMethod::resample);
  costs[Cost::draw_texel] = slope(exact.many, exact.few, texels_more(Projection::sphere));
  costs[Cost::draw_triangle] = slope(exact.cut, exact.few, triangles_more);
  costs[Cost::cube_texel] = slope(cube.many, cube.few, texels_more(Projection::cube));
  costs[Cost::cube_triangle] = slope(cube.cut, cube.few, triangles_more);
  costs[Cost::resample_texel] = slope(resampled.many, cube.many, texel_count(Projection::sphere, fine));
}

}  // namespace

Costs calibrated() {
  Costs costs;
  const Progress progress = progress_line("calibrating");
  const auto tell = [&](double part) {
    if (progress) progress(part);
  };
  measure_filters(costs), tell(0.4);
  try {
    measure_drawing(costs);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::renderer) throw;
    warn(fmt::format("envmap tradeoff: what OpenGL draws is not measured: {}", e.what()));
  }
  tell(1);
  return costs;
}

}  // namespace tools

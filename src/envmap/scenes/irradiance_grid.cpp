#include "envmap/scenes/irradiance_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/base/part_progress.h"
#include "envmap/maths/check_direction.h"
#include "envmap/operate/check_options.h"
#include "envmap/operate/convert.h"
#include "envmap/prefilter/harmonic_norms.h"
#include "envmap/projection/visit.h"
#include "envmap/scenes/check_drawing.h"
#include "envmap/scenes/grid_of_shot.h"
#include "envmap/scenes/render/rays/look.h"
#include "envmap/scenes/scene/camera.h"
#include "envmap/scenes/scene_state.h"

namespace envmap {
namespace {

void check(const GridOptions& o) {
  for (const int count : o.cells) check_range({"cells", 1, 256}, count);
  check_range({"size", 4, 256}, o.size);
  check_range({"error_places", 0, 4096}, o.error_places);
  check_drawing(RenderOptions{.far_metres = o.far_metres,
                              .time_seconds = o.time_seconds,
                              .ambient = o.ambient,
                              .occlusion = o.occlusion},
                true);
}

SceneBox box_of(const GridOptions& o, const FrameState& shot) {
  const Extent all = extent(shot.scene, shot.pose);
  const SceneBox box = o.box.value_or(SceneBox{all.low, all.high});
  for (const Direction& corner : {box.low, box.high}) check_finite("box", Flux(corner));
  for (int axis = 0; axis < 3; ++axis)
    if (!(box.low[axis] < box.high[axis]))
      throw UsageError(
          fmt::format("box: has no extent along {}: its low corner must be below its high one", "xyz"[axis]));
  return box;
}

// The scene as rays see it from anywhere in the box.
class GridRays {
 public:
  GridRays(const FrameState& shot, const GridOptions& o, const SceneBox& box)
      : from_{.at = 0.5 * box.low + 0.5 * box.high, .near = 0, .far = o.far_metres},
        tree_(shot, from_.at, -1),
        light_(lighting(shot, &tree_)),
        tracer_(tree_, light_, shot, from_, {}) {
    for (const Instance& i : instances(shot.scene))
      two_sided_.push_back(shot.scene.materials[shot.scene.meshes[i.mesh].material].double_sided);
  }

  // The environment as such a map: each texel has the mean over it, so that a sun is not missed between rays.
  [[nodiscard]] EnvironmentMap sky(Projection to, int size) const {
    if (light_.environment == nullptr) return blank_map(to, size);
    return convert(light_.environment->map, {.to = to, .size = size, .filter = Filter::area});
  }

  // Of the radiance that arrives at a place. @param sky of that projection and size.
  [[nodiscard]] EnvironmentMap map(const Direction& at, const EnvironmentMap& sky) const {
    const Projection to = sky.projection();
    const int size = sky.base().height();
    EnvironmentMap seen = blank_map(to, size);
    Level& level = seen.base();
    for_each_row(level.faces(), level.height(), {}, [&](int face, int row) {
      std::vector<Direction> rays(std::size_t(level.width()));
      texel_directions(to, size, face, row, 0, rays);
      for (std::size_t i = 0; i < rays.size(); ++i)
        level.row(face, row)[i] =
            look(tree_, tracer_, light_, from_, at - from_.at, rays[i], {}, &sky.base().row(face, row)[i]).radiance;
    });
    return seen;
  }

  // Irradiance there of surfaces that face the corners of a cube: the sum over all texels of such a map.
  [[nodiscard]] std::array<Flux, 8> irradiance(const Direction& at, const EnvironmentMap& sky) const {
    const EnvironmentMap seen = map(at, sky);
    const Level& level = seen.base();
    std::array<Flux, 8> sums{};
    std::vector<Direction> from(std::size_t(level.width()));
    std::vector<double> solid_angle(from.size());
    for (int face = 0; face < level.faces(); ++face)
      for (int row = 0; row < level.height(); ++row) {
        texel_directions(level.projection(), level.height(), face, row, 0, from);
        solid_angles(level.projection(), level.height(), row, solid_angle);
        for (std::size_t i = 0; i < from.size(); ++i)
          for (std::size_t k = 0; k < 8; ++k)
            sums[k] += solid_angle[i] * std::max(0.0, glm::dot(corner(k), from[i])) * Flux(level.row(face, row)[i]);
      }
    return sums;
  }
  static Direction corner(std::size_t k) {
    return Direction((k & 1) != 0 ? 1 : -1, (k & 2) != 0 ? 1 : -1, (k & 4) != 0 ? 1 : -1) / std::sqrt(3.0);
  }

  // IrradianceGrid::validity. A surface that shows both sides tells nothing of what is solid.
  [[nodiscard]] double validity(const Direction& at) const {
    constexpr int size = 8;
    const std::vector<double> backs = map_rows<double>(6 * size, [&](int k) {
      std::vector<Direction> rays(size);
      std::vector<double> solid_angle(size);
      texel_directions(Projection::cube, size, k / size, k % size, 0, rays);
      solid_angles(Projection::cube, size, k % size, solid_angle);
      double sum = 0;
      for (std::size_t i = 0; i < rays.size(); ++i) sum += sees_back(at, rays[i]) ? solid_angle[i] : 0;
      return sum;
    });
    double sum = 0;
    for (const double row : backs) sum += row;
    return std::max(0.0, 1 - sum / (4 * pi));
  }

 private:
  [[nodiscard]] bool sees_back(const Direction& at, const Direction& ray) const {
    const auto hit = tree_.find(at - from_.at, ray, 0, from_.far, Medium::any);
    return hit && hit->back && !two_sided_[std::size_t(hit->instance)];
  }

  Viewpoint from_;
  EmbreeScene tree_;
  Lighting light_;
  WhittedIntegrator tracer_;
  std::vector<char> two_sided_;  // By instance.
};

// f(x, y, z) of each cell, in their order.
template <class F>
void for_cells(const std::array<int, 3>& cells, const F& f) {
  for (int z = 0; z < cells[2]; ++z)
    for (int y = 0; y < cells[1]; ++y)
      for (int x = 0; x < cells[0]; ++x) f(x, y, z);
}

void fill(IrradianceGrid& grid, const GridRays& rays, int size, const Progress& progress) {
  const double count = double(grid.cells[0]) * grid.cells[1] * grid.cells[2];
  const EnvironmentMap sky = rays.sky(Projection::cube, size);
  for_cells(grid.cells, [&](int x, int y, int z) {
    const Direction at = grid.centre(x, y, z);
    grid.light.push_back(shader_sh(rays.map(at, sky), ShBasis::three, ShWindow::none));
    grid.validity.push_back(rays.validity(at));
    if (progress) progress(double(grid.light.size()) / count);
  });
}

// One ring of cells inside solids takes the mean of neighbours that are done. @return whether there was one.
bool fill_a_ring(IrradianceGrid& grid, std::vector<char>& done) {
  const std::vector<char> before = done;
  bool any = false;
  const auto clamped = [&](int k, int axis) { return std::clamp(k, 0, grid.cells[std::size_t(axis)] - 1); };
  for_cells(grid.cells, [&](int x, int y, int z) {
    const std::size_t cell = grid.index(x, y, z);
    if (before[cell] != 0) return;
    ShaderSh sum{};
    int count = 0;
    for (int k = clamped(z - 1, 2); k <= clamped(z + 1, 2); ++k)
      for (int j = clamped(y - 1, 1); j <= clamped(y + 1, 1); ++j)
        for (int i = clamped(x - 1, 0); i <= clamped(x + 1, 0); ++i) {
          const std::size_t other = grid.index(i, j, k);
          if (before[other] == 0) continue;
          for (std::size_t n = 0; n < sum.size(); ++n) sum[n] += grid.light[other][n];
          ++count;
        }
    if (count == 0) return;
    for (Flux& f : sum) f /= double(count);
    grid.light[cell] = sum;
    done[cell] = any = true;
  });
  return any;
}

// What filters interpolate must not be the darkness inside solids.
void fill_solids(IrradianceGrid& grid) {
  std::vector<char> done;
  for (const double v : grid.validity) done.push_back(v >= IrradianceGrid::least_validity ? 1 : 0);
  while (fill_a_ring(grid, done)) continue;
}

// The same on all machines.
class RandomPlaces {
 public:
  explicit RandomPlaces(const SceneBox& box) : box_(box) {}
  Direction next() {
    Direction at;
    for (int axis = 0; axis < 3; ++axis) at[axis] = glm::mix(box_.low[axis], box_.high[axis], number());
    return at;
  }

 private:
  double number() { return std::ldexp(double(engine_() >> 11), -53); }
  SceneBox box_;
  std::mt19937_64 engine_{20010812};
};

GridError error_of(const IrradianceGrid& grid, const GridRays& rays, const GridOptions& o, const Progress& progress) {
  RandomPlaces places(grid.box);
  const EnvironmentMap sky = rays.sky(Projection::latlong, 2 * o.size);
  GridError error;
  std::vector<std::pair<Flux, Flux>> pairs;  // Interpolated, and as it is.
  for (int tries = 0; tries < 4 * o.error_places && error.places < o.error_places; ++tries) {
    const Direction at = places.next();
    if (progress) progress(double(tries) / (4 * o.error_places));
    if (rays.validity(at) < IrradianceGrid::least_validity) continue;
    const std::array<Flux, 8> there = rays.irradiance(at, sky);
    for (std::size_t k = 0; k < 8; ++k) pairs.emplace_back(grid.irradiance(at, GridRays::corner(k)), there[k]);
    ++error.places;
  }
  double difference = 0, all = 0, sum = 0;
  for (const auto& [a, b] : pairs) difference += glm::dot(a - b, a - b), all += glm::dot(b, b), sum += b.x + b.y + b.z;
  if (all > 0) error.rms = std::sqrt(difference / all);
  const double floor = pairs.empty() ? 0 : 0.001 * sum / (3 * double(pairs.size()));
  for (const auto& [a, b] : pairs)
    for (int c = 0; c < 3; ++c)
      if (a[c] != b[c]) error.max = std::max(error.max, std::abs(a[c] - b[c]) / std::max(b[c], floor));
  return error;
}

}  // namespace

Direction IrradianceGrid::centre(int x, int y, int z) const {
  const Direction part((x + 0.5) / cells[0], (y + 0.5) / cells[1], (z + 0.5) / cells[2]);
  return box.low + part * (box.high - box.low);
}

int IrradianceGrid::invalid() const {
  return int(std::ranges::count_if(validity, [](double v) { return v < least_validity; }));
}

Flux IrradianceGrid::irradiance(const Direction& at, const Direction& normal) const {
  if (light.empty()) throw UsageError("an irradiance grid without cells has no light");
  const Direction n = checked_direction("normal", normal);
  if (!std::isfinite(at.x + at.y + at.z)) throw UsageError("at must be finite");
  std::array<int, 3> low{}, high{};
  Direction part(0);
  for (int axis = 0; axis < 3; ++axis) {
    const int last = cells[std::size_t(axis)] - 1;
    const double along = (at[axis] - box.low[axis]) / (box.high[axis] - box.low[axis]);
    const double cell = std::clamp(along * (last + 1) - 0.5, 0.0, double(last));
    low[std::size_t(axis)] = int(cell);
    high[std::size_t(axis)] = std::min(int(cell) + 1, last);
    part[axis] = cell - int(cell);
  }
  // Irradiance has degrees 0, 1 and 2 times pi, 2 pi / 3 and pi / 4 (Ramamoorthi and Hanrahan 2001).
  using namespace harmonic_norms;
  constexpr double c0 = pi * n0, c1 = 2 * pi / 3 * n1, c2 = pi / 4 * n2, c20 = pi / 4 * n20, c22 = pi / 4 * n22;
  const double basis[9] = {c0,
                           c1 * n.y,
                           c1 * n.z,
                           c1 * n.x,
                           c2 * n.x * n.y,
                           c2 * n.y * n.z,
                           c20 * (3 * n.z * n.z - 1),
                           c2 * n.z * n.x,
                           c22 * (n.x * n.x - n.y * n.y)};
  Flux sum(0);
  for (int k = 0; k < 8; ++k) {
    const bool x = (k & 1) != 0, y = (k & 2) != 0, z = (k & 4) != 0;
    const double weight = (x ? part.x : 1 - part.x) * (y ? part.y : 1 - part.y) * (z ? part.z : 1 - part.z);
    const ShaderSh& nine = light[index((x ? high : low)[0], (y ? high : low)[1], (z ? high : low)[2])];
    for (std::size_t i = 0; i < 9; ++i) sum += weight * basis[i] * nine[i];
  }
  return glm::max(sum, 0.0);
}

std::vector<AmbientCube> ambient_cubes(const IrradianceGrid& grid) {
  std::vector<AmbientCube> cubes;
  for_cells(grid.cells, [&](int x, int y, int z) {
    AmbientCube& cube = cubes.emplace_back();
    for (int side = 0; side < 6; ++side) {
      Direction normal(0);
      normal[side / 2] = side % 2 == 0 ? -1 : 1;
      cube[std::size_t(side)] = Colour(grid.irradiance(grid.centre(x, y, z), normal) / pi);
    }
  });
  return cubes;
}

IrradianceGrid grid_of(const FrameState& shot, const GridOptions& o, const Progress& progress) {
  check(o);
  IrradianceGrid grid{.cells = o.cells, .box = box_of(o, shot), .light = {}, .validity = {}, .remarks = {}};
  const GridRays rays(shot, o, grid.box);
  fill(grid, rays, o.size, part_progress(progress, 0, 0.8));
  fill_solids(grid);
  grid.error = error_of(grid, rays, o, part_progress(progress, 0.8, 0.2));
  return grid;
}

IrradianceGrid irradiance_grid(const Scene& scene, const GridOptions& o, const Light* light, const Run& run) {
  check(o);
  auto& state = SceneAccess::state(scene);
  const auto make = [&](const Progress& progress) {
    state.prepare(light, o.occlusion, Reflection::split_sum, o.time_seconds, part_progress(progress, 0, 0.2));
    const FrameState shot = state.lit.shot(o.time_seconds, o.ambient, o.shadows);
    IrradianceGrid grid = grid_of(shot, o, part_progress(progress, 0.2, 0.8));
    grid.remarks = state.lit.remarks(o.ambient);
    return grid;
  };
  return run_operation(run, [&](const Progress& progress) {
    return state.in_turn(progress, [&] { return make(progress); });
  });
}

}  // namespace envmap

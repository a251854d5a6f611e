#include "envmap/scenes/render/rays/raycast.h"

#include <cmath>
#include <limits>

#include "envmap/base/parallel.h"
#include "envmap/map/image_view.h"
#include "envmap/sample/footprint.h"
#include "envmap/scenes/render/rays/look.h"
#include "envmap/scenes/render/rays/whitted_integrator.h"

namespace envmap {

namespace {

// How the rays of neighbouring pixels differ, of each pixel's samples those of its part.
class Spreads {
 public:
  Spreads(const Viewpoint& from, TextureFilter filter) : from_(from), levels_(reads_levels(filter)) {}

  // Of a picture's ray at u and v.
  [[nodiscard]] RayDifferential of_picture(double u, double v) const {
    if (!levels_) return {};
    const Lens& lens = *from_.lens;
    const Direction across(2 * lens.tangents.x / lens.width, 0, 0), down(0, -2 * lens.tangents.y / from_.size, 0);
    if (lens.parallel) return in_world({.origin = {across, down}});
    const Direction at(lens.tangents.x * (2 * u - 1 - lens.shift), lens.tangents.y * (1 - 2 * v), -1);
    return in_world({.along = {normalised_derivative(at, across), normalised_derivative(at, down)}});
  }

  // Of a map's ray through a sample of a texel.
  [[nodiscard]] RayDifferential of_map(int face, int column, int row, const Vec2<double>& offset) const {
    if (!levels_) return {};
    const Point2 at((column + 0.5 + offset.x) / (from_.size * aspect(from_.to)), (row + 0.5 + offset.y) / from_.size);
    const Derivative by_texel = texel_derivative(from_.to, from_.size, face, at);
    return in_world({.along = {by_texel.du, by_texel.dv}});
  }

 private:
  [[nodiscard]] RayDifferential in_world(const RayDifferential& spread) const {
    return spread.turned(from_.axes).scaled(1 / std::sqrt(double(from_.samples)));
  }

  const Viewpoint& from_;
  bool levels_;
};

}  // namespace

Seen look(const EmbreeScene& tree, const WhittedIntegrator& tracer, const Lighting& lighting, const Viewpoint& from,
          const Direction& origin, const Direction& ray, const RayDifferential& spread, const Colour* behind) {
  Seen seen;
  float left = 1;  // Of what is behind.
  double near = from.near;
  while (const auto hit = tree.find(origin, ray, near, from.far, Medium::air, spread)) {
    const float part = left * hit->surface.opacity;
    if (part > 0) seen.radiance += part * Colour(tracer.from_surface(*hit, ray));
    if (!hit->blended) {
      seen.distance = float(hit->distance);
      seen.surface = std::uint32_t(hit->instance + 1);
      return seen;
    }
    left -= part;
    near = hit->distance + EmbreeScene::clearance(origin + hit->distance * ray);
  }
  const Colour sky = behind != nullptr ? *behind : background(lighting.environment, ray);
  seen.radiance += left * (sky + (from.show_ambient ? lighting.ambient : Colour(0)));
  return seen;
}

Drawn raycast(const FrameState& shot, const Viewpoint& from, const RayPaths& paths, const Progress& progress) {
  const EmbreeScene tree(shot, from.at, from.without, paths.texture_filter);
  const Spreads spreads(from, paths.texture_filter);
  const std::optional<LobeIntegral> integral = lobe_integral(shot, paths);
  Lighting light = lighting(shot, &tree);
  if (integral) light.integral = &*integral;
  // What the map leaves out, mirrors show.
  std::optional<EmbreeScene> all;
  if (from.without >= 0 && !paths.mirrors.empty()) all.emplace(shot, from.at, -1, paths.texture_filter);
  const WhittedIntegrator tracer(all ? *all : tree, light, shot, from, paths);
  Drawn drawn{.radiance = blank_map(from.to, from.size)};
  Level& level = drawn.radiance.base();
  drawn.distances.assign(ImageView<float>::count(level.width(), level.height(), level.faces()),
                         std::numeric_limits<float>::infinity());
  drawn.surfaces.assign(drawn.distances.size(), 0);
  const ImageView<float> distances(drawn.distances, level.width(), level.height(), level.faces());
  const ImageView<std::uint32_t> surfaces(drawn.surfaces, level.width(), level.height(), level.faces());
  for_each_row(level.faces(), level.height(), progress, [&](int face, int row) {
    if ((from.which >> face & 1) == 0) return;
    const Columns in = columns(from.to, from.size, row);
    std::vector<Direction> rays(in.count());
    std::vector<Flux> sums(rays.size(), Flux(0));
    const auto distance = in.of(distances.row(face, row));
    const auto surface = in.of(surfaces.row(face, row));
    for (int k = 0; k < from.samples; ++k) {
      sample_directions(from.to, from.size, face, row, sample_offset(k, from.samples), rays);
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const RayDifferential spread = spreads.of_map(face, in.first + int(i), row, sample_offset(k, from.samples));
        const Seen seen = look(tree, tracer, light, from, Direction(0), from.axes * rays[i], spread);
        sums[i] += Flux(seen.radiance);
        if (k > 0) continue;
        distance[i] = seen.distance;
        surface[i] = seen.surface;
      }
    }
    for (std::size_t i = 0; i < rays.size(); ++i)
      *level.texel(face, in.first + int(i), row) = Colour(sums[i] / double(from.samples));
  });
  return drawn;
}

std::vector<Colour> raycast_picture(const FrameState& shot, const Viewpoint& from, const RayPaths& paths,
                                    const Progress& progress) {
  const EmbreeScene tree(shot, from.at, from.without, paths.texture_filter);
  const Spreads spreads(from, paths.texture_filter);
  const std::optional<LobeIntegral> integral = lobe_integral(shot, paths);
  Lighting light = lighting(shot, &tree);
  if (integral) light.integral = &*integral;
  const WhittedIntegrator tracer(tree, light, shot, from, paths);
  const Lens& lens = *from.lens;
  std::vector<Colour> picture(std::size_t(lens.width) * std::size_t(from.size));
  for_each_row(1, from.size, progress, [&](int, int row) {
    for (int i = 0; i < lens.width; ++i) {
      Flux sum(0);
      for (int k = 0; k < from.samples; ++k) {
        const Vec2<double> offset = sample_offset(k, from.samples);
        const double u = (i + 0.5 + offset.x) / lens.width, v = (row + 0.5 + offset.y) / from.size;
        sum += tracer.from_eye(from.axes * lens.origin(u, v), from.axes * lens.ray(u, v), spreads.of_picture(u, v));
      }
      picture[std::size_t(row) * std::size_t(lens.width) + std::size_t(i)] = Colour(sum / double(from.samples));
    }
  });
  return picture;
}

}  // namespace envmap

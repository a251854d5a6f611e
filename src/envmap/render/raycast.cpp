#include "envmap/render/raycast.h"

#include <limits>

#include "envmap/base/parallel.h"
#include "envmap/map/image_view.h"
#include "envmap/render/ray_tree.h"

namespace envmap {
namespace {

struct Seen {
  Colour radiance{0};
  float distance = std::numeric_limits<float>::infinity();
  std::uint32_t surface = 0;
};

Seen look(const RayTree& tree, const Lighting& lighting, const Viewpoint& from, const Direction& ray) {
  const auto hit = tree.find(Direction(0), ray, from.near, from.far);
  if (!hit) return {.radiance = background(lighting.environment, ray) + (from.show_ambient ? lighting.ambient : Colour(0))};
  return {.radiance = shade(hit->surface, -ray, lighting),
          .distance = static_cast<float>(hit->distance),
          .surface = static_cast<std::uint32_t>(hit->instance + 1)};
}

}  // namespace

Drawn raycast(const Shot& shot, const Viewpoint& from, const Progress& progress) {
  const RayTree tree(shot, from.at, from.without);
  const Lighting light = lighting(shot, &tree);
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
        const Seen seen = look(tree, light, from, from.axes * rays[i]);
        sums[i] += Flux(seen.radiance);
        if (k > 0) continue;
        distance[i] = seen.distance;
        surface[i] = seen.surface;
      }
    }
    for (std::size_t i = 0; i < rays.size(); ++i)
      *level.texel(face, in.first + static_cast<int>(i), row) = Colour(sums[i] / static_cast<double>(from.samples));
  });
  return drawn;
}

}  // namespace envmap

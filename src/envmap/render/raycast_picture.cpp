#include "envmap/base/parallel.h"
#include "envmap/render/whitted_integrator.h"

namespace envmap {

std::vector<Colour> raycast_picture(const Shot& shot, const Viewpoint& from, const RayPaths& paths,
                                    const Progress& progress) {
  const EmbreeScene tree(shot, from.at, from.without);
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
        sum += tracer.from_eye(from.axes * lens.origin(u, v), from.axes * lens.ray(u, v));
      }
      picture[std::size_t(row) * std::size_t(lens.width) + std::size_t(i)] = Colour(sum / double(from.samples));
    }
  });
  return picture;
}

}  // namespace envmap


#include <algorithm>
#include <limits>

#include "envmap/base/parallel.h"
#include "envmap/map/image_view.h"
#include "envmap/operate/convert.h"
#include "envmap/render/renderer.h"

namespace envmap {
namespace {

constexpr float nowhere = std::numeric_limits<float>::infinity();

// A cube of the same size, which is at least as dense as any of the others nearly everywhere, and the bilinear filter.
// Distance and surface are those of the cube's texel in that direction.
Drawn resample(Renderer& renderer, const Viewpoint& from, const Shot& shot) {
  Viewpoint all_round = from;
  all_round.to = Projection::cube;
  Drawn cube = draw(renderer, all_round, shot, DrawMethod::distort);
  Drawn out{convert(cube.radiance, {.to = from.to, .size = from.size, .filter = Filter::bilinear}), {}, {}, 0};
  const int width = from.size * aspect(from.to);
  out.distances.assign(ImageView<float>::count(width, from.size, faces(from.to)), nowhere);
  out.surfaces.assign(out.distances.size(), 0);
  const ImageView<const float> cube_distances(cube.distances, from.size, from.size, 6);
  const ImageView<const std::uint32_t> cube_surfaces(cube.surfaces, from.size, from.size, 6);
  const ImageView<float> distances(out.distances, width, from.size, faces(from.to));
  const ImageView<std::uint32_t> surfaces(out.surfaces, width, from.size, faces(from.to));
  parallel_for(faces(from.to) * from.size, [&](int line) {
    const int face = line / from.size, row = line % from.size;
    const Columns in = columns(from.to, from.size, row);
    std::vector<Direction> rays(in.count());
    texel_directions(from.to, from.size, face, row, in.first, rays);
    std::vector<Location<double>> places(rays.size());
    locate(Projection::cube, rays, places);
    for (std::size_t k = 0; k < places.size(); ++k) {
      const auto at = [&](double u) { return std::min(int(u * from.size), from.size - 1); };
      const int i = at(places[k].u), j = at(places[k].v);
      in.of(distances.row(face, row))[k] = cube_distances(places[k].face, i, j);
      in.of(surfaces.row(face, row))[k] = cube_surfaces(places[k].face, i, j);
    }
  });
  return out;
}

}  // namespace

EnvironmentMap read_back(const MapTexture& map, std::vector<float>* distances) {
  EnvironmentMap out;
  Level& level = out.levels.emplace_back(map.projection, map.size);
  if (distances != nullptr) distances->resize(ImageView<float>::count(level.width(), level.height(), level.faces()));
  std::vector<glm::vec4> drawn(ImageView<glm::vec4>::count(level.width(), level.height()));
  const ImageView<const glm::vec4> image(drawn, level.width(), level.height());
  for (int face = 0; face < level.faces(); ++face) {
    glGetTextureSubImage(map.texture, 0, 0, 0, map.layer(face), level.width(), level.height(), 1, GL_RGBA, GL_FLOAT,
                         static_cast<GLsizei>(drawn.size() * sizeof(glm::vec4)), drawn.data());
    parallel_for(level.height(), [&](int row) {
      std::ranges::transform(image.row(0, row), level.row(face, row).begin(),
                             [](const glm::vec4& t) { return Colour(t); });
      if (distances == nullptr) return;
      const ImageView<float> to(*distances, level.width(), level.height(), level.faces());
      std::ranges::transform(image.row(0, row), to.row(face, row).begin(),
                             [](const glm::vec4& t) { return t.w < 100 * least_nearness ? nowhere : 1 / t.w; });
    });
  }
  gl::check("reading a map back");
  return out;
}

Drawn draw(Renderer& renderer, const Viewpoint& from, const Shot& shot, DrawMethod method) {
  if (method == DrawMethod::resample && from.to != Projection::cube) return resample(renderer, from, shot);
  if (method == DrawMethod::resample) method = DrawMethod::distort;
  MapTexture map(from.to, from.size);
  Drawn out;
  out.missing_solid_angle = renderer.draw(from, shot, method, map, &out.surfaces);
  out.radiance = read_back(map, &out.distances);
  return out;
}

}  // namespace envmap

#include <tbb/parallel_for.h>

#include <limits>

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
  Drawn out{convert(cube.radiance, {.to = from.to, .size = from.size, .filter = Filter::bilinear}), {}, {}};
  const auto width = static_cast<std::size_t>(from.size * aspect(from.to)), size = static_cast<std::size_t>(from.size);
  out.distances.assign(static_cast<std::size_t>(faces(from.to)) * width * size, nowhere);
  out.surfaces.assign(out.distances.size(), 0);
  tbb::parallel_for(0, faces(from.to) * from.size, [&](int line) {
    const int face = line / from.size, row = line % from.size;
    const Columns in = columns(from.to, from.size, row);
    std::vector<Direction> rays(static_cast<std::size_t>(in.end - in.first));
    texel_directions(from.to, from.size, face, row, in.first, rays);
    std::vector<Location<double>> places(rays.size());
    locate(Projection::cube, rays, places);
    for (std::size_t k = 0; k < places.size(); ++k) {
      const auto at = [&](double u) { return std::min(static_cast<std::size_t>(u * from.size), size - 1); };
      const std::size_t texel =
          (static_cast<std::size_t>(places[k].face) * size + at(places[k].v)) * size + at(places[k].u);
      const std::size_t to = static_cast<std::size_t>(line) * width + static_cast<std::size_t>(in.first) + k;
      out.distances[to] = cube.distances[texel];
      out.surfaces[to] = cube.surfaces[texel];
    }
  });
  return out;
}

}  // namespace

EnvironmentMap read_back(const MapTexture& map, std::vector<float>* distances) {
  EnvironmentMap out;
  Level& level = out.levels.emplace_back(map.projection, map.size);
  const auto width = static_cast<std::size_t>(level.width()), texels = width * static_cast<std::size_t>(level.height());
  if (distances != nullptr) distances->resize(texels * static_cast<std::size_t>(level.faces()));
  std::vector<glm::vec4> drawn(texels);
  for (int face = 0; face < level.faces(); ++face) {
    glGetTextureSubImage(map.texture, 0, 0, 0, map.layer(face), level.width(), level.height(), 1, GL_RGBA, GL_FLOAT,
                         static_cast<GLsizei>(texels * sizeof(glm::vec4)), drawn.data());
    tbb::parallel_for(0, level.height(), [&](int row) {
      const std::size_t first = static_cast<std::size_t>(row) * width;
      for (std::size_t k = 0; k < width; ++k) level.row(face, row)[k] = Colour(drawn[first + k]);
      if (distances != nullptr)
        for (std::size_t k = 0; k < width; ++k)
          (*distances)[static_cast<std::size_t>(face) * texels + first + k] = drawn[first + k].w;
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
  renderer.draw(from, shot, method, map, &out.surfaces);
  out.radiance = read_back(map, &out.distances);
  return out;
}

}  // namespace envmap

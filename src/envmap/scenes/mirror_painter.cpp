#include "envmap/scenes/mirror_painter.h"

#include "envmap/operate/convert.h"

namespace envmap {
namespace {

// Distances of a map turned as its radiance is: 1 / distance, which is 0 at infinity, by the bilinear filter.
std::vector<float> turned(const std::vector<float>& distances, const Level& level, const Rotation& axes) {
  EnvironmentMap inverse;
  Level& from = inverse.levels.emplace_back(level.projection(), level.height());
  auto next = distances.begin();
  const auto each_row = [&](Level& of, const auto& action) {
    for (int face = 0; face < of.faces(); ++face)
      for (int j = 0; j < of.height(); ++j) action(of.row(face, j));
  };
  each_row(from, [&](std::span<Colour> row) {
    for (Colour& c : row) c = Colour(1 / *next++);
  });
  EnvironmentMap to = convert(inverse, {.to = {level.projection()}, .filter = Filter::bilinear, .rotation = axes});
  std::vector<float> out;
  each_row(to.base(), [&](std::span<Colour> row) {
    for (const Colour& c : row) out.push_back(1 / c.x);
  });
  return out;
}

}  // namespace

RenderedFrames draw_through_maps(Renderer& renderer, Mirrors& maps, FrameState shot, const std::vector<Eye>& eyes,
                                 const MirrorOptions& drawing) {
  std::vector<Viewer> viewers;
  for (const Eye& eye : eyes) viewers.push_back(eye.viewer);
  RenderedFrames painted{.pictures = {}, .updates = maps.update(renderer, shot, viewers, drawing)};
  shot.mirrors = maps.maps();
  for (const Eye& eye : eyes) painted.pictures.push_back(draw_picture(renderer, eye.from, shot));
  return painted;
}

RenderedFrames MirrorPainter::paint(FrameState shot, const std::vector<int>& moved, const std::vector<Eye>& eyes,
                                    MirrorOptions drawing) {
  for (const int mesh : moved) renderer_.update(shot.scene, mesh);
  drawing.moved = !moved.empty();
  return draw_through_maps(renderer_, maps_, std::move(shot), eyes, drawing);
}

std::vector<PaintedMap> MirrorPainter::maps() const {
  std::vector<PaintedMap> all;
  for (const MirrorMap& map : maps_.maps()) {
    PaintedMap& painted = all.emplace_back(PaintedMap{.radiance = {}, .at = map.at});
    if (!map.texture) continue;
    painted.radiance = read_back(*map.texture, &painted.distances);
    if (map.axes == Rotation(1)) continue;
    painted.distances = turned(painted.distances, painted.radiance.base(), map.axes);
    painted.radiance = convert(painted.radiance, {.to = {map.texture->projection}, .rotation = map.axes});
  }
  return all;
}

}  // namespace envmap

#include "envmap/offscreen/mirror_painter.h"

#include "envmap/operate/convert.h"

namespace envmap {

Painted draw_through_maps(Renderer& renderer, Mirrors& maps, Shot shot, const std::vector<Eye>& eyes,
                          const MirrorOptions& drawing) {
  std::vector<Viewer> viewers;
  for (const Eye& eye : eyes) viewers.push_back(eye.viewer);
  Painted painted{.pictures = {}, .updates = maps.update(renderer, shot, viewers, drawing)};
  shot.mirrors = maps.maps();
  for (const Eye& eye : eyes) painted.pictures.push_back(draw_picture(renderer, eye.from, shot));
  return painted;
}

Painted MirrorPainter::paint(Shot shot, const std::vector<int>& moved, const std::vector<Eye>& eyes,
                             MirrorOptions drawing) {
  for (const int mesh : moved) renderer_.update(shot.scene, mesh);
  drawing.moved = !moved.empty();
  return draw_through_maps(renderer_, maps_, std::move(shot), eyes, drawing);
}

std::vector<EnvironmentMap> MirrorPainter::maps() const {
  std::vector<EnvironmentMap> all;
  for (const MirrorMap& map : maps_.maps()) {
    all.push_back(map.texture ? read_back(*map.texture) : EnvironmentMap{});
    if (map.texture && map.axes != Rotation(1))
      all.back() = convert(all.back(), {.to = {all.back().base().projection()}, .rotation = map.axes});
  }
  return all;
}

}  // namespace envmap

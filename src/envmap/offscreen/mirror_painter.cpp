#include "envmap/offscreen/mirror_painter.h"

#include "envmap/operate/convert.h"

namespace envmap {

std::vector<std::vector<Colour>> MirrorPainter::paint(Shot shot, const std::vector<int>& moved,
                                                      const std::vector<Eye>& eyes, MirrorOptions drawing,
                                                      const std::function<void(const std::string&)>& tell) {
  for (const int mesh : moved) renderer_.update(shot.scene, mesh);
  std::vector<Viewer> viewers;
  for (const Eye& eye : eyes) viewers.push_back(eye.viewer);
  drawing.moved = !moved.empty();
  maps_.update(renderer_, shot, viewers, drawing, tell);
  shot.mirrors = maps_.maps();
  std::vector<std::vector<Colour>> pictures;
  for (const Eye& eye : eyes) pictures.push_back(draw_picture(renderer_, eye.from, shot));
  return pictures;
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

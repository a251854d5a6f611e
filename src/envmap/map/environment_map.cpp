#include "envmap/map/environment_map.h"

namespace envmap {

Level::Level(Projection projection, int size, int width, std::size_t max_memory)
    : projection_(projection),
      faces_(envmap::faces(projection)),
      width_(width > 0 ? width : size * aspect(projection)),
      height_(size),
      pixels_(index(faces_, -gutter, -gutter) + 1, max_memory) {}

Rotation image_to_world(Forward forward) {
  switch (forward) {
    case Forward::plus_z: return rotation(0, 0, 0);
    case Forward::minus_z: return rotation(180, 0, 0);
    case Forward::plus_x: return rotation(90, 0, 0);
    case Forward::minus_x: break;
  }
  return rotation(-90, 0, 0);
}

}  // namespace envmap

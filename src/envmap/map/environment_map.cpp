#include "envmap/map/environment_map.h"

#include "envmap/base/error.h"

namespace envmap {
namespace {

int checked(const Bounds& range, int value) {
  check(range, value);
  return value;
}

}  // namespace

Level::Level(Projection projection, int size, int width, std::size_t max_memory)
    : projection_(projection),
      faces_(envmap::faces(projection)),
      width_(width == 0 ? checked(limits::level_height, size) * aspect(projection)
                        : checked(limits::level_width, width)),
      height_(checked(limits::level_height, size)),
      pixels_(index(faces_, -apron, -apron) + 1, max_memory) {}

Level& EnvironmentMap::no_level() { throw UsageError("a map needs a level; this one has none"); }

EnvironmentMap EnvironmentMap::clone() const {
  EnvironmentMap copy{{}, forward};
  copy.levels.reserve(levels.size());
  for (const Level& level : levels) copy.levels.push_back(level.clone());
  return copy;
}

EnvironmentMap blank_map(const Frame& frame, int size) {
  EnvironmentMap map{{}, frame.forward};
  map.levels.emplace_back(frame.projection, size);
  return map;
}

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

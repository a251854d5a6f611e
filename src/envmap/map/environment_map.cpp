#include "envmap/map/environment_map.h"

#include "envmap/base/error.h"
#include "envmap/map/check_chain.h"

namespace envmap {
namespace {

// @param width as it was asked for, 0 where that of the projection is meant.
int width_of(Projection projection, int size, int width) {
  check_range(limits::level_height, size);
  const int wide = width == 0 ? size * aspect(projection) : width;
  check_face_size(projection, {wide, size});
  return wide;
}

}  // namespace

Level::Level(Projection projection, int size, int width, std::size_t max_memory)
    : projection_(projection),
      faces_(envmap::faces(projection)),
      width_(width_of(projection, size, width)),
      height_(size),
      pixels_(index(faces_, -padding, -padding) + 1, max_memory) {}

Level& EnvironmentMap::no_level() { throw UsageError("a map needs a level; this one has none"); }

EnvironmentMap EnvironmentMap::clone() const {
  EnvironmentMap copy{{}, forward};
  copy.levels.reserve(levels.size());
  for (const Level& level : levels) copy.levels.push_back(level.clone());
  return copy;
}

void check_levels(const EnvironmentMap& map) {
  std::vector<LevelSize> faces;
  for (const Level& level : map.levels) {
    if (level.projection() != map.projection()) throw UsageError("levels of one map must have one projection");
    faces.push_back({level.width(), level.height()});
  }
  check_level_count({map.base().width(), map.base().height()}, faces.size());
  check_halving(faces);
}

EnvironmentMap blank_map(const Frame& frame, int size) {
  EnvironmentMap map{{}, frame.forward};
  map.levels.emplace_back(frame.projection, size);
  return map;
}

Rotation image_to_world(Forward forward) {
  check_enumerator("forward", forward);
  switch (forward) {
    case Forward::plus_z: return rotation(0, 0, 0);
    case Forward::minus_z: return rotation(180, 0, 0);
    case Forward::plus_x: return rotation(90, 0, 0);
    case Forward::minus_x: break;
  }
  return rotation(-90, 0, 0);
}

}  // namespace envmap

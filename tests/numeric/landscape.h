/// @file
/// A map that makes work for every method: noise without any relation between the channels, a dark ground, and a sun.
#pragma once

#include <random>

#include "envmap/map/environment_map.h"
#include "envmap/projection/projection.h"

namespace envmap::numeric_tests {

inline EnvironmentMap landscape(Projection projection, int size, float sun = 2000) {
  EnvironmentMap map;
  map.levels.emplace_back(projection, size);
  std::mt19937 random(29);
  Level& level = map.base();
  for (int face = 0; face < level.faces(); ++face)
    for (int j = 0; j < size; ++j)
      for (int i = columns(projection, size, j).first; i < columns(projection, size, j).end; ++i)
        for (int c = 0; c < 3; ++c)
          (*level.texel(face, i, j))[c] = 0.05F + float(random() % 1000) / 1000 * (c + 1) * (j < size / 2 ? 1.F : 0.1F);
  *level.texel(level.faces() - 1, level.width() / 3, size / 3) = Colour(sun, 0.8F * sun, 0.5F * sun);
  return map;
}

}  // namespace envmap::numeric_tests

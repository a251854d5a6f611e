/// @file
/// What a map makes of a horizontal floor.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "envmap/map/environment_map.h"
#include "envmap/maths/compensated_sum.h"
#include "envmap/projection/projection.h"

namespace envmap {

/// Irradiance, texel by texel.
inline Flux irradiance_of_floor(const Level& level) {
  std::array<CompensatedSum, 3> sums;
  std::vector<double> w(std::size_t(level.width()));
  std::vector<Direction> d(w.size());
  for (int f = 0; f < level.faces(); ++f)
    for (int j = 0; j < level.height(); ++j) {
      solid_angles(level.projection(), level.height(), j, w);
      const Columns in = columns(level.projection(), level.height(), j);
      const auto inside = std::span(d).first(in.count());
      texel_directions(level.projection(), level.height(), f, j, in.first, inside);
      for (int i = in.first; i < in.end; ++i)
        for (int c = 0; c < 3; ++c)
          sums[std::size_t(c)].add(w[i] * (*level.texel(f, i, j))[c] * std::max(0.0, inside[i - in.first].y));
    }
  return {sums[0].value(), sums[1].value(), sums[2].value()};
}

}  // namespace envmap

/// @file
/// What a filter fills: the grid of a result, and how it is turned against the source.
#pragma once

#include <optional>
#include <span>

#include "envmap/projection/ball_camera.h"
#include "envmap/projection/projection.h"

namespace envmap {

struct Target {
  Projection to;
  int size;            ///< Height of a face.
  Rotation to_source;  ///< From the image frame of the result to that of the source.
  /// That took the source, a sphere map; absent: from infinitely far away.
  std::optional<BallCamera> ball = std::nullopt;

  /// Directions of the result's image frame become those that the source's projection shows where they are seen.
  void bring_to_source(std::span<Direction> directions) const {
    rotate(to_source, directions);
    if (!ball) return;
    for (Direction& d : directions) d = ball->seen_from_afar(d);
  }
};

}  // namespace envmap

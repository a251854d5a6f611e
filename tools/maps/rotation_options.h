// --rotate of convert: by three angles, or from one direction to another.
#pragma once

#include <optional>

#include "cli/options.h"
#include "envmap/map/environment_map.h"
#include "envmap/maths/vector.h"

namespace tools {

// Yaw, pitch and roll in degrees.
using YawPitchRoll = envmap::Direction;

struct Turn {
  std::optional<YawPitchRoll> angles;
  std::optional<envmap::Direction> from;  // A unit vector. Neither angles nor from: the brightest light of the map.
  envmap::Direction to{0};                // A unit vector, if there are no angles.

  [[nodiscard]] bool of_sun() const { return !angles && !from; }
};

void add_rotate(Options& options, std::optional<Turn>& turn);

// Says on standard error which angles two directions stand for.
envmap::Rotation rotation_of(const Turn& turn, const envmap::EnvironmentMap& map);

}  // namespace tools

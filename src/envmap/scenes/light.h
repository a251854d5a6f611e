/// @file
/// An environment that lights scenes, worked out once.
#pragma once

#include <memory>

#include "envmap/base/export.h"
#include "envmap/base/run.h"
#include "envmap/map/environment_map.h"

namespace ENVMAP_EXPORT envmap {

class PreparedEnvironment;

/// What lies behind scenes and lights them. What any scene takes of it is made at once: lookups, harmonics, the source
/// of prefiltered levels. The first scene that has a roughness makes its level, which others share. Copies share all,
/// and several threads may use them at once.
class Light {
 public:
  /// Takes over level 0 of the map; clone() a map that is still needed. @throws InputError where a texel is NaN,
  /// infinite or negative.
  explicit Light(EnvironmentMap map, const Run& run = {});

  [[nodiscard]] const EnvironmentMap& map() const;

 private:
  friend class Scene;
  std::shared_ptr<const PreparedEnvironment> prepared_;
};

}  // namespace envmap

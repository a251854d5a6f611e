/// @file
/// An environment that lights scenes, worked out once.
#pragma once

#include <memory>
#include <vector>

#include "envmap/base/export.h"
#include "envmap/base/run.h"
#include "envmap/light/lights.h"
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

  /// An environment whose suns and lamps (find_lights()) light surfaces as discs, which cast shadows with half shadows,
  /// in place of their texels. What lies behind scenes and what sharp reflections show stays the map as it is.
  static Light with_suns(EnvironmentMap map, const LightOptions& options = {}, const Run& run = {});

  [[nodiscard]] const EnvironmentMap& map() const;
  /// None where the constructor made the light, and where the map has none.
  [[nodiscard]] const std::vector<DiscLight>& suns() const;

 private:
  explicit Light(std::shared_ptr<const PreparedEnvironment> prepared);

  friend class Scene;
  std::shared_ptr<const PreparedEnvironment> prepared_;
};

}  // namespace envmap

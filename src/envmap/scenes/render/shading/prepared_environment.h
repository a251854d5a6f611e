/// @file
/// An environment whose light is worked out once, whatever scenes and maps it lights.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <mutex>
#include <tuple>
#include <vector>

#include "envmap/base/run.h"
#include "envmap/light/distant_lights.h"
#include "envmap/prefilter/prefilter.h"
#include "envmap/scenes/render/drawing_method.h"
#include "envmap/scenes/render/shading/shading.h"

namespace envmap {

/// What any scene needs is made at once, the rest when the first scene asks for it: a prefiltered level for each
/// roughness, the lights that stand for it where shadows are found. Safe for several threads at once: they take turns.
class PreparedEnvironment {
 public:
  /// Level 0 of the map. @param progress may be empty. @param suns of it that light surfaces in place of their texels.
  /// @throws InputError where a texel is NaN, infinite or negative.
  explicit PreparedEnvironment(EnvironmentMap map, const Progress& progress = {}, FoundLights suns = {});

  [[nodiscard]] const EnvironmentMap& map() const { return *map_; }
  [[nodiscard]] const std::vector<DiscLight>& suns() const { return suns_; }

  /// @param roughnesses of glossy_levels.h. @param progress may be empty.
  [[nodiscard]] std::shared_ptr<const Environment> light(const std::vector<float>& roughnesses, Reflection reflection,
                                                         const Progress& progress) const;

  /// distant_lights().
  [[nodiscard]] std::vector<DistantLight> distant(int count, const Progress& progress) const;

 private:
  std::shared_ptr<const PaddedLevel> level(float roughness) const;

  std::shared_ptr<const EnvironmentMap> map_, remainder_;  // The map without the suns; the map itself without any.
  std::vector<DiscLight> suns_;
  EnvironmentLookup lookup_;
  std::array<Colour, 9> irradiance_;
  Prefilterer source_;
  mutable std::timed_mutex in_use_;
  mutable std::map<float, std::shared_ptr<const PaddedLevel>> levels_;  // By roughness.
  mutable std::map<std::tuple<std::vector<float>, Reflection>, std::shared_ptr<const Environment>> made_;
  mutable std::map<int, std::vector<DistantLight>> distant_;  // By count.
};

}  // namespace envmap

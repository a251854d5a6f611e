#include "envmap/scenes/render/shading/prepared_environment.h"

#include "envmap/base/parallel.h"
#include "envmap/base/turn.h"
#include "envmap/scenes/render/shading/sampled_reflection.h"

namespace envmap {
namespace {

std::shared_ptr<const EnvironmentMap> first_level(EnvironmentMap map) {
  (void)map.base();  // Throws where there is none.
  map.levels.erase(map.levels.begin() + 1, map.levels.end());
  return std::make_shared<const EnvironmentMap>(std::move(map));
}

std::shared_ptr<const EnvironmentMap> without(const std::shared_ptr<const EnvironmentMap>& map,
                                              const FoundLights& suns) {
  if (suns.lights.empty()) return map;
  EnvironmentMap rest = map->clone();
  take_out(rest, suns);
  return std::make_shared<const EnvironmentMap>(std::move(rest));
}

}  // namespace

PreparedEnvironment::PreparedEnvironment(EnvironmentMap map, const Progress& progress, FoundLights suns)
    : map_(first_level(std::move(map))),
      remainder_(without(map_, suns)),
      suns_(std::move(suns.lights)),
      lookup_(*map_),
      irradiance_(irradiance_over_pi(*remainder_)),
      source_(remainder_) {
  if (progress) progress(1);
}

std::shared_ptr<const PaddedLevel> PreparedEnvironment::level(float roughness) const {
  std::shared_ptr<const PaddedLevel>& made = levels_[roughness];
  if (!made) made = glossy_level(source_, roughness, glossy_size, 4 * glossy_size);
  return made;
}

std::shared_ptr<const Environment> PreparedEnvironment::light(const std::vector<float>& roughnesses,
                                                              Reflection reflection, const Progress& progress) const {
  const auto turn = wait_for_turn(in_use_, progress);
  std::shared_ptr<const Environment>& known = made_[{roughnesses, reflection}];
  if (known) return known;
  isolate_tasks([&] {
    EnvironmentLight light{.irradiance = irradiance_, .glossy = {}, .roughnesses = roughnesses, .suns = suns_};
    for (const float roughness : roughnesses) {
      light.glossy.push_back(level(roughness));
      if (progress) progress(double(light.glossy.size()) / double(roughnesses.size()));
    }
    if (reflection == Reflection::sampled) light.sampled = sampled_levels(*remainder_);
    known = std::make_shared<const Environment>(map_, lookup_, std::move(light), remainder_);
  });
  return known;
}

std::vector<DistantLight> PreparedEnvironment::distant(int count, const Progress& progress) const {
  const auto turn = wait_for_turn(in_use_, progress);
  const auto known = distant_.find(count);
  if (known != distant_.end()) return known->second;
  isolate_tasks([&] { distant_[count] = distant_lights(*remainder_, count); });
  return distant_[count];
}

}  // namespace envmap

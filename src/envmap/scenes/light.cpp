#include "envmap/scenes/light.h"

#include "envmap/base/run_operation.h"
#include "envmap/scenes/render/shading/prepared_environment.h"

namespace envmap {

Light::Light(EnvironmentMap map, const Run& run)
    : prepared_(run_operation(run, [&](const Progress& progress) {
        return std::make_shared<const PreparedEnvironment>(std::move(map), progress);
      })) {}

Light::Light(std::shared_ptr<const PreparedEnvironment> prepared) : prepared_(std::move(prepared)) {}

Light Light::with_suns(EnvironmentMap map, const LightOptions& options, const Run& run) {
  return Light(run_operation(run, [&](const Progress& progress) {
    FoundLights suns = find_lights(map, options, {.stop = run.stop});
    return std::make_shared<const PreparedEnvironment>(std::move(map), progress, std::move(suns));
  }));
}

const EnvironmentMap& Light::map() const { return prepared_->map(); }
const std::vector<DiscLight>& Light::suns() const { return prepared_->suns(); }

}  // namespace envmap

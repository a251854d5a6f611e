#include "envmap/scenes/light.h"

#include "envmap/base/run_operation.h"
#include "envmap/scenes/render/shading/prepared_environment.h"

namespace envmap {

Light::Light(EnvironmentMap map, const Run& run)
    : prepared_(run_operation(run, [&](const Progress& progress) {
        return std::make_shared<const PreparedEnvironment>(std::move(map), progress);
      })) {}

const EnvironmentMap& Light::map() const { return prepared_->map(); }

}  // namespace envmap

#include "envmap/prefilter/source.h"

#include "envmap/operate/convert.h"

namespace envmap::prefiltering {

std::optional<EnvironmentMap> source_cube(const EnvironmentMap& map) {
  if (map.projection() == Projection::cube || map.projection() == Projection::latlong) return std::nullopt;
  return convert(map, {.to = {Projection::cube}, .filter = Filter::area});
}

}  // namespace envmap::prefiltering

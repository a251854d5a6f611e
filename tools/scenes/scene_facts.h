// What `info` prints of a scene.
#pragma once

#include <string>

#include "cli/report.h"
#include "envmap/scenes/scene/scene.h"
#include "maps/map_facts.h"

namespace tools {

/// The key `scene` of `info --json`.
void add(Report& report, const envmap::Scene& scene);

/// The lines of `info` without --json.
FactLines lines_of(const envmap::Scene& scene, const std::string& file);

}  // namespace tools

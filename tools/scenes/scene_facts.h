// What `info` prints of a scene.
#pragma once

#include <string>

#include "cli/report.h"
#include "envmap/scenes/scene/scene_graph.h"
#include "maps/map_facts.h"

namespace tools {

/// The key `scene` of `info --json`.
void add(Report& report, const envmap::SceneGraph& scene);

/// The lines of `info` without --json.
FactLines lines_of(const envmap::SceneGraph& scene, const std::string& file);

}  // namespace tools

// render --grid: irradiance at the cells of a box.
#pragma once

#include <optional>
#include <string>

#include "cli/options.h"
#include "cli/report.h"
#include "scenes/scene_options.h"

namespace tools {

struct GridRequest {
  std::string cells;  // NX,NY,NZ; empty: no grid.
  std::optional<envmap::Direction> low, high;
  std::optional<int> size;
  double far = 1000;
};

// --grid, --grid-low and --grid-high, which exclude all rows before them that are about single maps.
void add_grid(Options& o, GridRequest& grid);

// Draws the grid and writes it. @return exit status. @throws UsageError
int write_grid(const SceneOptions& scene, const GridRequest& grid, const std::string& output, Report& report);

}  // namespace tools

/// @file
/// The irradiance grid of a scene at one moment.
#pragma once

#include "envmap/scenes/irradiance_grid.h"
#include "envmap/scenes/render/draw.h"

namespace envmap {

/// @param options time, ambient light, shadows and occlusion are the shot's. @param progress may be empty.
/// @throws UsageError as irradiance_grid(); that has no remarks.
IrradianceGrid grid_of(const FrameState& shot, const GridOptions& options, const Progress& progress);

}  // namespace envmap

/// @file
/// Irradiance grids as files.
#pragma once

#include <string>

#include "envmap/base/export.h"
#include "envmap/io/files/commit.h"
#include "envmap/scenes/irradiance_grid.h"

namespace ENVMAP_EXPORT envmap {

/// Writes .json, or a .ktx2 of half floats as Bevy's IrradianceVolume takes it: a volume of cells[0] x 2 cells[1] x
/// 3 cells[2] texels (crates/bevy_pbr/src/light_probe/irradiance_volume.wgsl). @throws UsageError where the name has
/// another extension, OutputError where the file cannot be written, or half floats cannot hold the light.
void write_grid(const std::string& path, const IrradianceGrid& grid, const CommitOptions& commit = {});

/// Says early what write_grid() would say late. @throws UsageError, OutputError.
void check_grid_file(const std::string& path);

}  // namespace envmap

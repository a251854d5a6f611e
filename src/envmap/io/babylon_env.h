/// @file
/// Babylon.js' environment files, .env: a header in JSON, and the faces of all levels as RGBD in PNG images.
/// Source: GetEnvInfo, CreateEnvTextureAsync and UploadEnvLevelsAsync in
/// packages/dev/core/src/Misc/environmentTextureTools.ts (9.34). The world is Babylon.js' left-handed one: +X, +Y and
/// +Z of a map are -X, +Y and +Z there, both ways.
#pragma once

#include <span>
#include <string_view>

#include "envmap/base/progress.h"
#include "envmap/io/key_values.h"
#include "envmap/io/output_file.h"
#include "envmap/io/texture.h"
#include "envmap/map/atlas.h"

namespace envmap {

inline constexpr std::string_view env_mark{"\x86\x16\x87\x96\xf6\xd6\x96\x36", 8};

/// All levels of a cube, the largest first, down to one texel.
/// @param pairs "irradiance" is JSON for the header, its spherical polynomial; else Babylon.js makes it.
/// @param progress may be empty.
/// @throws OutputError where levels are missing, or sides are no power of two.
void write_env(OutputFile& file, std::span<const Atlas> levels, const KeyValues& pairs, const Progress& progress);

/// The header of a file with env_mark. Its irradiance is not read. @throws InputError, without the name of the file,
/// where it is damaged or its faces are no PNG images.
TextureFile open_env(const InputFile& file);

}  // namespace envmap

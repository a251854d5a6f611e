/// @file
/// .env of Babylon.js: a header in JSON, and the faces of all levels as RGBD in PNG images. Source: GetEnvInfo,
/// CreateEnvTextureAsync and UploadEnvLevelsAsync in packages/dev/core/src/Misc/environmentTextureTools.ts (9.34). The
/// world is Babylon.js' left-handed one: +X, +Y and +Z of a map are -X, +Y and +Z there, both ways.
#pragma once

#include <span>
#include <string_view>

#include "envmap/base/run.h"
#include "envmap/io/files/output_file.h"
#include "envmap/io/texels/texture_file.h"
#include "envmap/map/atlas.h"

namespace envmap {

struct TexturePlan;

inline constexpr std::string_view env_mark{"\x86\x16\x87\x96\xf6\xd6\x96\x36", 8};

/// The levels of a cube, the largest first, down to one texel.
/// The pair "irradiance" is JSON for the header, its spherical polynomial; else Babylon.js makes it. With it may go a
/// cube of irradiance: "irradianceTexture" is JSON, {"size", "lengths" of six files, "dominantDirection" or nothing},
/// and "irradianceFaces" are these files, as those of rgbd_faces(), in hexadecimal digits.
/// @throws OutputError where levels are missing, or sides are no power of two.
void write_env(OutputFile& file, std::span<const Atlas> levels, const TexturePlan& plan, const Progress& progress);

/// Irradiance is not read. Damaged are those whose faces are no PNG images, too.
TextureFile open_env(const InputFile& file);

}  // namespace envmap

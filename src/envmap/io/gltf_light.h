/// @file
/// The light of EXT_lights_image_based in a binary glTF file: levels of evenly rising roughness as RGBD in PNG images,
/// irradiance as spherical harmonics. Sources: extensions/2.0/Vendor/EXT_lights_image_based/README.md of the glTF
/// repository; what it leaves open (the faces' orientation, the harmonics' signs) as Babylon.js' loader has it,
/// EXT_lights_image_based.ts of 9.28.
#pragma once

#include <span>
#include <string_view>

#include "envmap/base/progress.h"
#include "envmap/io/key_values.h"
#include "envmap/io/output_file.h"
#include "envmap/io/texture.h"
#include "envmap/map/atlas.h"

namespace envmap {

/// A file with the light alone, in an empty scene. @param levels of a cube, two at least, the largest first.
/// @param pairs "irradianceCoefficients" is JSON: nine colours. @param progress may be empty.
/// @throws OutputError where levels or coefficients are missing, or sides are no power of two.
void write_gltf_light(OutputFile& file, std::span<const Atlas> levels, const KeyValues& pairs,
                      const Progress& progress);

/// Whether a file begins as a .glb.
bool is_glb(std::string_view head);

/// The first light of a .glb file, whose images are in it as PNG. @throws InputError,
/// without the name of the file, where there is none.
TextureFile open_gltf_light(const InputFile& file);

}  // namespace envmap

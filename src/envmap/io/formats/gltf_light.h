/// @file
/// EXT_lights_image_based in a binary glTF file: levels of evenly rising roughness as RGBD in PNG images, irradiance
/// as spherical harmonics. Sources: extensions/2.0/Vendor/EXT_lights_image_based/README.md of the glTF repository; what
/// it leaves open (the faces' orientation, the harmonics' signs) as Babylon.js' loader has it,
/// EXT_lights_image_based.ts of 9.28.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "envmap/base/run.h"
#include "envmap/io/files/output_file.h"
#include "envmap/io/texels/texture_file.h"
#include "envmap/map/atlas.h"

namespace envmap {

struct TexturePlan;

/// The light alone, in an empty scene. @param levels of a cube, two at least, the largest first.
/// The pair "irradianceCoefficients" is JSON: nine colours.
/// @throws OutputError where levels or coefficients are missing, or sides are no power of two.
void write_gltf_light(OutputFile& file, std::span<const Atlas> levels, const TexturePlan& plan,
                      const Progress& progress);

/// Returns whether a file begins as a .glb or, as JSON, a .gltf.
bool is_gltf(std::string_view head);

/// The light of a scene, or the first one. Its images may lie in the file, in buffers and files beside it, and in data
/// URIs, as PNG or JPEG. @param path where the files that it names lie.
TextureFile open_gltf_light(const InputFile& file, const std::string& path);

}  // namespace envmap

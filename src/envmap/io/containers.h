/// @file
/// The containers of textures, with all levels of a map in one file: KTX2, KTX, DDS, Babylon.js' .env and glTF lights.
/// All are written as FileFormat::write is; progress may be empty. Whoever opens throws InputError, without the name of
/// the file, where it is damaged or holds what is not read.
#pragma once

#include <span>
#include <string_view>

#include "envmap/base/progress.h"
#include "envmap/io/output_file.h"
#include "envmap/io/texture.h"
#include "envmap/map/atlas.h"

namespace envmap {

struct TexturePlan;

// KTX2 of Khronos. Source: "KTX File Format Specification" 2.0, document revision 4 (2025); "Khronos Data Format
// Specification" 1.4 for the descriptor in it.

inline constexpr std::string_view ktx2_mark{"\xabKTX 20\xbb\r\n\x1a\n", 12};

/// The smallest level first in the file, with KTXorientation "rd".
void write_ktx2(OutputFile& file, std::span<const Atlas> levels, const TexturePlan& plan, const Progress& progress);

/// Not read: other texel formats, arrays, volumes, supercompression other than Zstandard.
TextureFile open_ktx2(const InputFile& file);

// KTX of 2010 (Filament lights with it). Source: "KTX File Format Specification" 1.0.

inline constexpr std::string_view ktx1_mark{"\xabKTX 11\xbb\r\n\x1a\n", 12};

/// The largest level first in the file, with KTXorientation "S=r,T=d" and KTXwriter.
void write_ktx1(OutputFile& file, std::span<const Atlas> levels, const TexturePlan& plan, const Progress& progress);

/// Not read: other texel formats, arrays, volumes, big-endian words.
TextureFile open_ktx1(const InputFile& file);

// DDS of DirectX. Source: Microsoft, "Programming Guide for DDS" and "DDS_HEADER_DXT10 structure".

/// With the DX10 header; face after face, each with all its levels. DDS holds no metadata.
void write_dds(OutputFile& file, std::span<const Atlas> levels, const TexturePlan& plan, const Progress& progress);

/// Texels of texel_formats, integers between masks, grey, and BC1 to BC4 and BC7 where the module of formats is: the
/// blocks alone go through it. Not read: arrays, volumes, cubes that lack a face, channels with a sign.
TextureFile open_dds(const InputFile& file);

/// Images on surfaces are left to OpenImageIO. @throws InputError where its integers lie as no program means them:
/// OpenImageIO 2.4 goes round and round where a channel has no bits.
void check_dds(const InputFile& file);

// .env of Babylon.js: a header in JSON, and the faces of all levels as RGBD in PNG images. Source: GetEnvInfo,
// CreateEnvTextureAsync and UploadEnvLevelsAsync in packages/dev/core/src/Misc/environmentTextureTools.ts (9.34). The
// world is Babylon.js' left-handed one: +X, +Y and +Z of a map are -X, +Y and +Z there, both ways.

inline constexpr std::string_view env_mark{"\x86\x16\x87\x96\xf6\xd6\x96\x36", 8};

/// The levels of a cube, the largest first, down to one texel.
/// The pair "irradiance" is JSON for the header, its spherical polynomial; else Babylon.js makes it.
/// @throws OutputError where levels are missing, or sides are no power of two.
void write_env(OutputFile& file, std::span<const Atlas> levels, const TexturePlan& plan, const Progress& progress);

/// Irradiance is not read. Damaged are those whose faces are no PNG images, too.
TextureFile open_env(const InputFile& file);

// EXT_lights_image_based in a binary glTF file: levels of evenly rising roughness as RGBD in PNG images, irradiance as
// spherical harmonics. Sources: extensions/2.0/Vendor/EXT_lights_image_based/README.md of the glTF repository; what it
// leaves open (the faces' orientation, the harmonics' signs) as Babylon.js' loader has it, EXT_lights_image_based.ts of
// 9.28.

/// The light alone, in an empty scene. @param levels of a cube, two at least, the largest first.
/// The pair "irradianceCoefficients" is JSON: nine colours.
/// @throws OutputError where levels or coefficients are missing, or sides are no power of two.
void write_gltf_light(OutputFile& file, std::span<const Atlas> levels, const TexturePlan& plan,
                      const Progress& progress);

/// Whether a file begins as a .glb or, as JSON, a .gltf.
bool is_gltf(std::string_view head);

/// The light of a scene, or the first one. Its images may lie in the file, in buffers and files beside it, and in data
/// URIs, as PNG or JPEG. @param path where the files that it names lie.
TextureFile open_gltf_light(const InputFile& file, const std::string& path);

}  // namespace envmap

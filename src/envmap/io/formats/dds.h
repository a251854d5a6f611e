/// @file
/// DDS of DirectX: textures with all levels of a map in one file. Source: Microsoft, "Programming Guide for DDS" and
/// "DDS_HEADER_DXT10 structure".
/// Writers are called as FileFormat::write is. Readers throw InputError, without the name of the file, where it is
/// damaged or holds what is not read.
#pragma once

#include <span>
#include <string>

#include "envmap/base/run.h"
#include "envmap/io/files/output_file.h"
#include "envmap/io/images/image_reader.h"
#include "envmap/io/texels/texture_file.h"
#include "envmap/map/atlas.h"

namespace envmap {

struct TexturePlan;

/// With the DX10 header; face after face, each with all its levels. DDS holds no metadata.
void write_dds(OutputFile& file, std::span<const Atlas> levels, const TexturePlan& plan, const Progress& progress);

/// Texels of texel_formats, integers between masks, grey, and BC1 to BC4 and BC7 where the module of formats is: the
/// blocks alone go through it. Not read: arrays, volumes, cubes that lack a face, channels with a sign.
TextureFile open_dds(const InputFile& file);

/// An image on a surface, which OpenImageIO reads. @param name for its messages.
/// @throws InputError, which names the format, also where integers lie as no program means them.
ImageReader open_dds_image(InputFile& file, const std::string& name);

}  // namespace envmap

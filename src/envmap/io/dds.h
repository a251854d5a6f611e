/// @file
/// DDS, the texture container of DirectX. Source: Microsoft, "Programming Guide for DDS" and "DDS_HEADER_DXT10
/// structure".
#pragma once

#include <optional>
#include <span>

#include "envmap/base/progress.h"
#include "envmap/io/output_file.h"
#include "envmap/io/texture.h"
#include "envmap/map/atlas.h"

namespace envmap {

/// With the DX10 header; face after face, each with all its levels. DDS holds no metadata.
/// @param cube whether the levels are columns of faces in the API's orientation. @param progress may be empty.
void write_dds(OutputFile& file, std::span<const Atlas> levels, Texels texels, bool cube, const Progress& progress);

/// The header of a file that begins with "DDS ". @return nothing where its texels are not in texel_formats: those
/// OpenImageIO may read. @throws InputError, without the name of the file, where it is damaged, an array or a volume.
std::optional<TextureFile> open_dds(const InputFile& file);

}  // namespace envmap

/// @file
/// Images that are read row by row: JPEG by libjpeg, TIFF by libtiff, portable float maps by hand. The file must
/// outlive the reader. All throw InputError without the file's name, and return nothing for images that OpenImageIO has
/// to read.
#pragma once

#include <optional>
#include <span>

#include "envmap/base/progress.h"
#include "envmap/io/image_reader.h"
#include "envmap/io/input_file.h"
#include "envmap/io/output_file.h"
#include "envmap/map/atlas.h"

namespace envmap {

struct TexturePlan;

/// Of progressive images libjpeg holds all coefficients in memory once a row is read. Any damage that libjpeg notices
/// is an error.
/// @param headroom of a gain map, as ImageChoice has it. @param for_texture whether texels stay as stored: without a
/// gain map, or a profile. @return nothing for images without a gain map whose XMP or IPTC may tell an orientation, a
/// description or a copyright, or of colours that JFIF and Adobe do not define.
std::optional<ImageReader> open_jpeg(const InputFile& file, std::optional<double> headroom = {},
                                     bool for_texture = false);

/// The first image of a file: grey, RGB or RGBA of associated alpha, as unsigned integers of 8 and 16 bits, half or
/// single, in strips, with or without lossless compression; doubles, compressed planes, LogLuv and LogL.
/// @param found its facts, also where nothing is returned. @return nothing for rare images (tiles, other samples and
/// colours, straight alpha, a data window, mip levels), for those with texts that only OpenImageIO reads, and for those
/// that it reads faster: it decompresses the strips of large ones on all processors.
std::optional<ImageReader> open_tiff(const InputFile& file, ImageFacts* found = nullptr);

/// A map (Debevec, "The portable float map") of either byte order. Values are multiplied by the scale.
ImageReader open_pfm(const InputFile& file);

/// What OpenImageIO 2.4 reads but does not write. Little-endian, bottom row first.
void write_pfm(OutputFile& file, std::span<const Atlas> levels, const TexturePlan& plan, const Progress& progress);

}  // namespace envmap

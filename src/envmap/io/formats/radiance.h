/// @file
/// Radiance pictures (.hdr), read and written by hand. Source: Ward, "Real pixels" (Graphics Gems II, 1991), and "The
/// RADIANCE 5.1 synthetic imaging system, file formats", section "Picture file format".
#pragma once

#include <span>

#include "envmap/io/files/input_file.h"
#include "envmap/io/images/image_reader.h"
#include "envmap/io/images/image_writer.h"
#include "envmap/maths/vector.h"

namespace envmap {

/// A file that begins with "#?": flat, with the old or the new run lengths, in any of the eight orders of rows.
/// EXPOSURE and COLORCORR are divided out, as the format has it. XYZE becomes RGB of the primaries in the file, else of
/// Radiance's, per watt (179 lumens). Mantissas are taken as m / 256, as all readers but Radiance's own do, which adds
/// half a step for the truncation of its writers. @param file must outlive the reader.
/// @throws InputError without the file's name.
ImageReader open_radiance(const InputFile& file);

/// For make_writer(): mantissas are rounded to nearest, rows go from the top, with the new run lengths where the format
/// has them (8 to 32767 texels a row). Values are those of largest_radiance at most.
ImageWriter create_radiance(OutputFile& file, const ImagePlan& plan);

/// 255/256 x 2^127.
inline constexpr double largest_radiance = 1.69e38;

/// What is read back of texels.
void round_to_radiance(std::span<Colour> texels);

}  // namespace envmap

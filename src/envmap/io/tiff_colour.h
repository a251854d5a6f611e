/// @file
/// What the tags of a TIFF say of its colours. Sources: TIFF 6.0, section 20 ("RGB Image Colorimetry"); TIFF
/// Technical Note "Adobe Photoshop TIFF", tag 34675; Larson, "LogLuv encoding for full-gamut, high-dynamic range
/// images" (1998).
#pragma once

#include <tiffio.h>

#include "envmap/io/image_reader.h"

namespace envmap {

/// Has libtiff make floats of CIE XYZ, or of luminance, out of LogLuv and LogL: before anything else is asked.
void unpack_log_luv(TIFF* tiff);

/// Sets colours, the profile and the claims of an image. An ICC profile comes before the other tags.
/// @throws InputError without the file's name, which names what is not supported.
void read_tiff_colours(TIFF* tiff, ImageFacts& facts);

}  // namespace envmap

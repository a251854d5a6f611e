/// @file
/// Tabulated lobes of files.
#pragma once

#include <string>

#include "envmap/base/export.h"
#include "envmap/prefilter/lobe.h"

namespace ENVMAP_EXPORT envmap {

/// Reads a lobe of a text file or of a measured material.
///
/// Text: on each line a cosine and a value, apart by spaces, tabs or a comma. `degrees` on a line before them says that
/// angles stand in the place of cosines. What follows # is a comment. Lobe::table() says which samples are allowed.
///
/// Measured: an isotropic material of the MERL database (Matusik et al. 2003, "A data-driven reflectance model"). Of
/// its BRDF f the lobe has f cos(n,l) with n = v = r, as the split sum wants lobes: half and difference angles are half
/// the angle between l and r, and the azimuth is 0. The samples are at the middle of the bins of half angles up to 45
/// degrees. Values are the luminance of Rec. 709, so that colours of the map are not tinted. The value in the middle is
/// that of the first bin, and at the horizon it is 0. Bins that the file marks as not measured (below 0) are left out.
/// @throws InputError where the file cannot be read, or holds no lobe.
Lobe read_lobe(const std::string& path);

}  // namespace envmap

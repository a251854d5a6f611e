/// @file
/// OpenEXR's envmap convention: samples on the border of the image. The first row is the pole, first and last column
/// are one meridian; texels of a cube face lie on its edges. Source: OpenEXR's ImfEnvmap.h.
#pragma once

#include "envmap/map/environment_map.h"

namespace envmap {

/// Of a map read from such a file: values at the centres of cells, bilinear within each face.
Level to_cell_centres(const Level& border);

/// For such a file: values at u = i / (width - 1), v = j / (height - 1), bicubic over edges and poles.
/// A pole is one value.
Level to_border(const Level& level);

}  // namespace envmap

/// @file
/// What a filter fills: the texels of a result, and where they look in the source.
#pragma once

#include <functional>
#include <span>

#include "envmap/base/export.h"
#include "envmap/projection/projection.h"

namespace ENVMAP_EXPORT envmap {

struct Target {
  Projection to;
  int size;            ///< Height of a face.
  Rotation to_source;  ///< From the image frame of the result to that of the source.
};

/// Fills texels [first, first + out.size()) of a row of a face of the result. Safe to call from many threads at once;
/// always gives the same.
using Sampler = std::function<void(int face, int row, int first, std::span<Colour> out)>;

}  // namespace envmap

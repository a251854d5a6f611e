/// @file
/// Images of which a file holds a part only, or more than is to be shown.
#pragma once

#include <cstdint>

#include "envmap/io/images/image_reader.h"

namespace envmap {

/// Where the texels of a file lie in its image: the first of them at (x, y).
struct DataWindow {
  std::int64_t x, y;
  int width, height;  ///< Of the image.
};

/// A reader of the image, 0 where the file has no texels, without those beyond it. One level. @param stored reads the
/// texels of the file.
ImageReader in_window(ImageReader stored, const DataWindow& window);

}  // namespace envmap

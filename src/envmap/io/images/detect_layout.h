/// @file
/// Which projection and layout an image holds.
#pragma once

#include <string>

#include "envmap/io/metadata.h"

namespace envmap {

struct DetectedLayout {
  Projection projection;
  Layout layout;
  int size;  ///< Height of a face.
};

/// Size of a face in a level of a file: halved and rounded down each time.
struct FaceSize {
  int width, height;
};
FaceSize face_size(const DetectedLayout& base, int level);

/// Levels of a chain that goes on while a face has more than one texel.
int complete_levels(const DetectedLayout& base);

/// @throws UsageError where a layout is none of `cube_layouts`.
void check_cube_layout(Layout layout);

/// From what the user said, else the metadata, else the shape: 2:1 latlong; 1:6, 6:1, 4:3, 3:4, 3:2 cube.
/// @throws InputError with the choices where the shape is ambiguous or fits nothing. The message names no file.
DetectedLayout detect_layout(int width, int height, const Metadata& said, const Metadata& recorded);

}  // namespace envmap

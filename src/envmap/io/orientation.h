/// @file
/// Pictures whose rows are not stored from the top, or not from the left.
#pragma once

#include "envmap/io/image_reader.h"

namespace envmap {

/// Whether rows of the file are columns of the picture.
inline bool is_transposed(Orientation o) { return o >= Orientation::left_top; }

/// A reader of the picture upright, of one whose facts and rows are as they are stored. The picture is held in memory
/// once a row is asked for; it has one level.
ImageReader turned_upright(ImageReader stored);

}  // namespace envmap

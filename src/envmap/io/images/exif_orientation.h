/// @file
/// Pictures whose rows are not stored from the top, or not from the left.
#pragma once

#include <utility>

#include "envmap/io/images/image_reader.h"
#include "envmap/map/rows.h"

namespace envmap {

/// Whether rows of the file are columns of the picture.
inline bool is_transposed(Orientation o) { return o >= Orientation::left_top; }

/// Where the file has texel (x, y) of the upright picture, whose size is given.
std::pair<int, int> place_in_file(Orientation o, int width, int height, int x, int y);

/// A reader of the picture upright, of one whose facts and rows are as they are stored. The picture is held in memory
/// once a row is asked for; it has one level.
ImageReader turned_upright(ImageReader stored);

/// The rows of one square face as a file has them. Where they are its columns, the face is made here, and held.
Rows stored_rows(const Rows& rows, int face, Orientation o);

/// The other way: a square face of `stored` into a face of the map.
void copy_upright(const Level& stored, int stored_face, Orientation o, Level& map, int face);

}  // namespace envmap

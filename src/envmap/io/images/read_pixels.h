/// @file
/// The pixels of an image as a level of a map.
#pragma once

#include "envmap/base/run.h"
#include "envmap/io/images/detect_layout.h"
#include "envmap/io/images/open_image.h"
#include "envmap/io/read.h"

namespace envmap {

/// The size of a face in a level of the map. @param stored its number in the file. @param base the whole map.
/// @param number of the level in the map. @throws InputError where the level is too small for it.
FaceSize face_in(const Image& image, int stored, const DetectedLayout& base, int number);

/// A level of the map. Memory is taken when the first rows have been read: a header can promise anything.
/// @param stored its number in the file. @throws InputError where it has no R, G and B or grey, or is damaged.
Level read_pixels(const Image& image, const ReadOptions& options, int stored, const DetectedLayout& base,
                  const FaceSize& face, const Progress& progress);

}  // namespace envmap

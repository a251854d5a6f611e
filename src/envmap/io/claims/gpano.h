/// @file
/// What cameras and phones write of a panorama into XMP: which part of the sphere an image shows, and how the camera
/// was held. Source: Google, "Photo Sphere XMP Metadata".
#pragma once

#include <optional>
#include <string>

#include "envmap/io/images/data_window.h"
#include "envmap/io/images/open_image.h"
#include "envmap/maths/vector.h"

namespace envmap {

struct Panorama {
  std::string projection = "equirectangular";
  /// Of the whole panorama the part that was stored; absent: it says nothing of that. Pixels of when it was taken: the
  /// image may be smaller by now.
  struct Crop {
    double full_width, full_height, width, height, left, top;
  };
  std::optional<Crop> crop = {};
  /// Degrees. The middle of the panorama is `heading` clockwise from north and `pitch` above the horizon, which is
  /// turned by `roll` counter-clockwise in the image.
  std::optional<double> heading = {}, pitch = {}, roll = {};
};

/// Looks for it in JPEG, PNG, TIFF, WebP and HEIF files. @throws InputError, without the file's name, where it is
/// damaged.
std::optional<Panorama> panorama_of(const Image& image);

/// Where an image of this size lies in the whole panorama; nothing where it is all of it.
/// @throws InputError, without the file's name, where the numbers contradict each other.
std::optional<DataWindow> window_in(const Panorama& panorama, int width, int height);

/// Turns what the camera saw upright, with north at +Z.
Rotation pose_of(const Panorama& panorama);

}  // namespace envmap

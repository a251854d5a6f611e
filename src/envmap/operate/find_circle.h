/// @file
/// The outline of a ball, or of a fisheye's picture, in a photo.
#pragma once

#include <optional>

#include "envmap/map/environment_map.h"
#include "envmap/projection/lens.h"

namespace envmap {

struct FoundCircle {
  Circle circle;
  double support;               ///< Part of the circle along which an edge of the picture runs.
  double spread;                ///< Pixels: the standard deviation of the edge from the circle, by the median.
  std::optional<Circle> rival;  ///< Another circle that neither contains this one nor lies in it, almost as good.

  /// Whether the circle may be used unseen: an edge along most of it, as round as pixels are, and no rival.
  [[nodiscard]] bool sure() const;
};

/// The circle that the edges of a picture follow best; of circles that lie in each other the outermost. The same at any
/// number of threads. @param photo its level is an image of any width. @return nothing where no edges lie on a circle.
std::optional<FoundCircle> find_circle(const Level& photo);

}  // namespace envmap

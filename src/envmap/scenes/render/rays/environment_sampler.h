/// @file
/// Directions drawn from an environment in proportion to its light.
#pragma once

#include <vector>

#include "envmap/map/environment_map.h"

namespace envmap {

/// A density over directions that follows the luminance of a map, for importance sampling. Constant within each of 512
/// x 256 cells of a latlong map. Neighbouring numbers draw neighbouring directions, which sequences of low discrepancy
/// need; the alias table of ImportanceSampler (operate/importance_sampling.h) does not keep that.
class EnvironmentSampler {
 public:
  explicit EnvironmentSampler(const EnvironmentMap& map);

  struct Sample {
    Direction from;
    double density;  ///< Per steradian. 0 if the map is black.
  };
  /// @param u in [0, 1)^2.
  [[nodiscard]] Sample sample(const Point2& u) const;
  /// Per steradian.
  [[nodiscard]] double density(const Direction& from) const;

 private:
  static constexpr int height = 256, width = 2 * height;
  // Sums of luminance times solid angle: of all cells above a row, and within each row.
  std::vector<double> rows_, cells_;
};

}  // namespace envmap

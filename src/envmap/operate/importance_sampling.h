/// @file
/// Directions drawn from an environment in proportion to its light, for renderers. Source: Vose 1991, "A linear
/// algorithm for generating random numbers with a given distribution" (the alias method).
#pragma once

#include <memory>

#include "envmap/base/export.h"
#include "envmap/base/run.h"
#include "envmap/map/environment_map.h"

namespace ENVMAP_EXPORT envmap {

/// A density over world directions in proportion to luminance x solid angle of the texels of a map. Drawing takes the
/// same short time for every map. Several threads may draw at once. Copies share the tables.
class ImportanceSampler {
 public:
  /// @param map a cube or latlong map is taken as it is, another one as the cube that convert() makes of it.
  /// @throws InputError where a texel is NaN, infinite or negative, or all are black.
  explicit ImportanceSampler(const EnvironmentMap& map, const Run& run = {});

  struct Sample {
    Direction direction;  ///< Of unit length.
    double pdf;           ///< Per steradian; over the sphere it integrates to 1.
  };
  /// @param u two numbers in [0, 1). @throws UsageError where they are not.
  [[nodiscard]] Sample sample(const Point2& u) const;

  /// The density of sample() at a direction of any length, per steradian; 0 where the map is black.
  /// @throws UsageError where the direction is 0, NaN or infinite.
  [[nodiscard]] double pdf(const Direction& direction) const;

 private:
  struct Tables;
  std::shared_ptr<const Tables> tables_;
};

}  // namespace envmap

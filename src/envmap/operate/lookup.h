/// @file
/// Radiance by world direction.
#pragma once

#include <memory>
#include <span>

#include "envmap/base/export.h"
#include "envmap/map/environment_map.h"

namespace ENVMAP_EXPORT envmap {

/// The continuous environment that a map stands for: the seamless bilinear reconstruction of each of its levels, and a
/// straight line between levels. Several threads may look up at once. Copies share the texels.
class EnvironmentLookup {
 public:
  /// Copies the texels, or takes them over. @throws UsageError where the map has no level, or levels differ in
  /// projection, InputError where a texel is NaN or infinite.
  explicit EnvironmentLookup(const EnvironmentMap& map) : EnvironmentLookup(map.clone()) {}
  explicit EnvironmentLookup(EnvironmentMap&& map);

  /// @param direction of the world, of any length. Black where it has no direction: 0, NaN, infinite, or its
  /// square is. @param level 0 is the largest; below 0 and NaN count as 0, above the last level as the last.
  [[nodiscard]] Colour operator()(const Direction& direction, double level = 0) const;

  /// Many at once, with the same results, in the calling thread.
  /// @throws UsageError where `out` is not as long as `directions`.
  void operator()(std::span<const Direction> directions, std::span<Colour> out, double level = 0) const;

 private:
  struct Levels;
  std::shared_ptr<const Levels> levels_;
};

}  // namespace envmap

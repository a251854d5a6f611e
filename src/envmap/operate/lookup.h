/// @file
/// Radiance by world direction.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "envmap/base/export.h"
#include "envmap/base/run.h"
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
  /// A chain of prefiltered levels. @param roughnesses of its levels, rising: level_at() finds a roughness by them.
  /// @throws UsageError where they do not rise, or are not as many as the levels.
  EnvironmentLookup(EnvironmentMap&& map, std::vector<double> roughnesses);

  /// @param direction of the world, of any length. Black where it has no direction: 0, NaN, infinite, or its
  /// square is. @param level 0 is the largest; below 0 and NaN count as 0, above the last level as the last.
  [[nodiscard]] Colour operator()(const Direction& direction, double level = 0) const;

  /// Many directions at once, on all threads, with the same results. Directions of floats give those of the doubles
  /// that they are. @throws UsageError where `out` is not as long as `directions`.
  void operator()(std::span<const Direction> directions, std::span<Colour> out, double level = 0,
                  const Run& run = {}) const;
  void operator()(std::span<const Vec3<float>> directions, std::span<Colour> out, double level = 0,
                  const Run& run = {}) const;

  /// Where a roughness lies between the levels of a chain: on a straight line between the roughnesses of neighbours; at
  /// the ends beyond them. @throws UsageError where no roughnesses were given.
  [[nodiscard]] double level_at(double roughness) const;

 private:
  struct Levels;
  std::shared_ptr<const Levels> levels_;
};

}  // namespace envmap

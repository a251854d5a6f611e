/// @file
/// Radiance by world direction.
#pragma once

#include <memory>

#include "envmap/base/export.h"
#include "envmap/map/environment_map.h"

namespace ENVMAP_EXPORT envmap {

class PaddedLevel;

/// The continuous environment that a map stands for: the seamless bilinear reconstruction of its level 0. Several
/// threads may look up at once.
class EnvironmentLookup {
 public:
  /// Copies the texels, or takes them over.
  explicit EnvironmentLookup(const EnvironmentMap& map) : EnvironmentLookup(map.base().clone(), map.forward) {}
  explicit EnvironmentLookup(EnvironmentMap&& map) : EnvironmentLookup(std::move(map.base()), map.forward) {}

  /// @param direction of the world, of any length. Black where it has no direction: 0, NaN, infinite, or its
  /// square is.
  [[nodiscard]] Colour operator()(const Direction& direction) const;

  /// What is looked up: shared by copies, and never changed.
  [[nodiscard]] const PaddedLevel& level() const { return *level_; }
  [[nodiscard]] const Rotation& world_to_image() const { return world_to_image_; }

 private:
  EnvironmentLookup(Level&& level, Forward forward);

  std::shared_ptr<const PaddedLevel> level_;
  Rotation world_to_image_;
};

}  // namespace envmap

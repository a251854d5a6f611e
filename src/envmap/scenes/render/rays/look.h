/// @file
/// What an eye sees along one ray.
#pragma once

#include <cstdint>
#include <limits>

#include "envmap/scenes/render/rays/embree_scene.h"
#include "envmap/scenes/render/rays/whitted_integrator.h"

namespace envmap {

struct Seen {
  Colour radiance{0};
  float distance = std::numeric_limits<float>::infinity();
  std::uint32_t surface = 0;
};

/// Through what is blended to the first that is not: the surface, and its distance.
/// @param origin from the tree's centre. @param ray unit, world. @param spread what textures
/// are filtered over. @param behind what lies behind all surfaces; null: the
/// environment in that direction.
Seen look(const EmbreeScene& tree, const WhittedIntegrator& tracer, const Lighting& lighting, const Viewpoint& from,
          const Direction& origin, const Direction& ray, const RayDifferential& spread, const Colour* behind = nullptr);

}  // namespace envmap

/// @file
/// Rays that go on: from mirrors, through thin walls, and through solids.
#pragma once

#include <optional>
#include <vector>

#include "envmap/scenes/render/rays/embree_scene.h"
#include "envmap/scenes/render/rays/lobe_integral.h"
#include "envmap/scenes/render/rays/raycast.h"

namespace envmap {

/// The integrals that RayPaths::lobe_samples asks for.
std::optional<LobeIntegral> lobe_integral(const FrameState& shot, const RayPaths& paths);

/// Follows rays through a shot as RayPaths says. What it is made of must outlive it.
class WhittedIntegrator {
 public:
  /// @param tree of the shot, its centre the viewpoint's.
  WhittedIntegrator(const EmbreeScene& tree, const Lighting& light, const FrameState& shot, const Viewpoint& from,
                    const RayPaths& paths);

  /// What arrives along a ray of the picture. @param origin from the viewpoint. @param ray unit, world. @param spread
  /// what textures are filtered over.
  [[nodiscard]] Flux from_eye(const Direction& origin, const Direction& ray, const RayDifferential& spread) const;

  /// What the surface that it met sends back along it.
  [[nodiscard]] Flux from_surface(const SurfaceHit& hit, const Direction& ray) const;

 private:
  // A ray on its way.
  struct Ray {
    Direction origin, along;  // The origin from the viewpoint.
    int bounces;              // That may follow.
    double weight;            // What it counts for in the pixel.
    RayDifferential spread;
    bool of_eye = false;      // Nothing turned it yet: behind all surfaces it sees the background.
  };
  [[nodiscard]] Flux along(const Ray& ray) const;
  [[nodiscard]] Flux missing(const Ray& ray) const;
  [[nodiscard]] Flux leaving(const SurfaceHit& hit, const Ray& ray) const;
  [[nodiscard]] Flux scattered(const SurfaceHit& hit, const Ray& ray) const;
  // What a solid does to light: its refractive index, and Material::absorption.
  struct Solid {
    double ior;
    Flux absorption;
  };
  [[nodiscard]] Flux through(const Ray& ray, const Solid& solid, int reflections) const;
  [[nodiscard]] Flux leaving_solid(const SurfaceHit& hit, const Ray& ray, const Solid& solid, int reflections) const;

  const EmbreeScene& tree_;
  const Lighting& light_;
  const Viewpoint& from_;
  int bounces_;
  double far_;
  struct TracedPath {
    bool base, coat;
  };
  std::vector<TracedPath> followed_;  // By instance.
};

}  // namespace envmap

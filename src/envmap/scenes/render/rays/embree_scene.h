/// @file
/// A scene as rays meet it, in Embree's tree of boxes.
#pragma once

#include <memory>
#include <optional>

#include "envmap/scenes/render/draw.h"
#include "envmap/scenes/render/rays/ray_differential.h"
#include "envmap/scenes/render/shading/shading.h"
#include "envmap/scenes/render/texture_filter.h"

namespace envmap {

struct SurfaceHit {
  ShadingPoint surface;
  double distance;  ///< From the origin of the ray.
  int instance;     ///< Index into instances().
  bool blended;     ///< Material::blended: the ray goes on, too.
  bool back;        ///< Met from the back; the surface's normal faces the ray all the same.
  RayDifferential spread;            ///< Of the ray there.
  std::array<Direction, 2> normals;  ///< Derivatives of the surface's smooth normal, as of the ray.
};

/// What a ray passes through. Of `any`, both sides of all surfaces end it.
enum class Medium { air, solid, any };

/// Triangles are moved to a centre in double and rounded to float32 there, and so are rays; what a ray meets in a
/// triangle is found in double. Source: Wald et al. 2014, "Embree: a kernel framework for efficient CPU ray tracing".
class EmbreeScene {
 public:
  /// @param centre world. @param without the node that is not seen, with all below it; -1: none. It casts shadows.
  /// @param filter of what find() meets; holes, and those of shadows, are bilinear in the finest level.
  /// @throws RendererError where Embree runs out of memory.
  EmbreeScene(const FrameState& shot, const Direction& centre, int without,
              TextureFilter filter = TextureFilter::bilinear);
  ~EmbreeScene();

  /// Returns the closest hit. In air, back faces of single-sided materials are skipped (glTF doubleSided). Inside a
  /// solid, all faces of solids count, because the solid ends there. Holes of alpha_cutoff are skipped.
  /// @param origin from the centre. @param ray unit, world. @param spread of the ray: what textures are filtered over.
  [[nodiscard]] std::optional<SurfaceHit> find(const Direction& origin, const Direction& ray, double near, double far,
                                               Medium medium = Medium::air, const RayDifferential& spread = {}) const;

  /// Whether something that casts_shadow() lies on the way of light, whichever side it shows.
  /// @param place on a surface. @param normal of it. @param towards unit, to the light. @param but the node that, with
  /// all below it, casts none; -1: none. All in the world.
  [[nodiscard]] bool blocked(const Direction& place, const Direction& normal, const Direction& towards, double distance,
                             int but) const;

  /// From where rays may start at a place on a surface, so that they do not meet it again: 2^-15 of the place's
  /// distance from the centre, some hundred times what it was rounded by.
  [[nodiscard]] static double clearance(const Direction& place);

 private:
  struct World;
  std::unique_ptr<World> world_;
};

}  // namespace envmap

/// @file
/// Which directions a mirror or a lens can show: so that of its map only what is looked up need be drawn.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "envmap/scenes/scene/scene_graph.h"

namespace envmap {

/// All directions within an angle of an axis.
struct DirectionCone {
  Direction axis;
  double angle;  ///< Radians; pi: every direction.
};

/// Somebody who looks at the mirror: the camera, or the point that another mirror's map is drawn from.
struct Viewer {
  Direction at;
  /// World planes (normal, offset) with everything seen where dot(normal, p) + offset >= 0; empty: all is seen.
  std::vector<glm::vec<4, double, glm::highp>> planes;
  int node = -1;     ///< Whose centre it is; -1: a camera.
  double pixel = 0;  ///< Radians between its rays; 0: it has none.
};

/// What a surface does with a view ray.
struct MirrorOptics {
  double ior = 0;  ///< Below 1: reflects; else refracts once, into a medium of that index.
  bool double_sided = false;

  [[nodiscard]] bool refracts() const { return ior >= 1; }

  /// @param view unit, towards the surface. @param normal unit, turned to the viewer for refraction.
  [[nodiscard]] Direction turned(const Direction& view, const Direction& normal) const;
};

struct VisibleCone {
  std::vector<DirectionCone> caps;
  /// The least that directions turn for each radian that the ray does: 1 for flat mirrors and along cylinders, more on
  /// balls. A tenth of what is seen may be below. Infinite where nothing is seen.
  double widening = std::numeric_limits<double>::infinity();
  double solid_angle = 0;  ///< In which the mesh is seen; what lies behind counts, too.
};

/// Caps that together hold every direction that a mesh shows a viewer; none where it is out of sight. Occlusion by
/// other things is not looked at.
///
/// A triangle whose view rays lie within `a` of their mean and whose normals within `b` shows directions within a + 2b
/// of the mean ray's: a reflection turns by what the ray turns and by twice what the normal does, and refraction into
/// a denser medium by no more. What is wide is split, and parts beyond the viewer's planes are dropped.
/// Seen from a middle, the points of such a ray lie on the arc from where it starts to where it goes: lookups by
/// distance read there.
/// @param world places the mesh. @param middle of the map, if it is looked up by distance. @param fineness of the caps
/// in radians; wider ones are split up to six times.
VisibleCone reflection_bounds(const Viewer& viewer, const Mesh& mesh, const Matrix& world, const MirrorOptics& optics,
                              const std::optional<Direction>& middle = {}, double fineness = 0.2);

/// The normal of a mesh that is flat, in the world: all rays from it stay on its side. None of others.
std::optional<Direction> flat_normal(const Mesh& mesh, const Matrix& world);

/// The cube's faces (in the order of cube.h, in the frame of `axes`) that the caps reach.
/// @param axes from the map's frame to the world's. @param margin in radians, for what a lookup reads beyond its place.
std::array<bool, 6> reached_faces(std::span<const DirectionCone> caps, const Rotation& axes, double margin);

/// The smallest cap round all of them, nearly: Badoiu and Clarkson 2003, "Smaller core-sets for balls", on the sphere.
/// @param caps at least one.
DirectionCone enclosing(std::span<const DirectionCone> caps);

}  // namespace envmap

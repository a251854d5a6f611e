/// @file
/// The map of a scene round a point: what `envmap render` does, of one moment.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "envmap/base/export.h"
#include "envmap/base/run.h"
#include "envmap/map/environment_map.h"
#include "envmap/scenes/render/drawing_method.h"

namespace ENVMAP_EXPORT envmap {

/// Where a map is drawn from: a point of the scene, or the name of a node, which is then left out.
using ScenePlace = std::variant<Direction, std::string>;

struct RenderOptions {
  Frame to{Projection::cube};  ///< Its axis, of latlong and angular maps, is an axis of the scene.
  int size = 256;              ///< Height of a face.
  int samples = 1;             ///< Rays a texel, 1 to 1024.
  ScenePlace at = Direction(0);  ///< The centre of the map.
  /// What the map's +Z looks at: a direction of the scene, or the name of a node or "camera". Absent: the scene's +Z.
  std::optional<std::variant<Direction, std::string>> towards = {};
  double near_metres = 0.01, far_metres = 1000;  ///< Nothing nearer or further is drawn.
  double time_seconds = 0;                       ///< Of the scene's movements, -1e6 to 1e6.
  DrawMethod method = DrawMethod::automatic;
  std::optional<Colour> ambient = {};  ///< Radiance from all round.
  bool shadows = true;
  int occlusion = 64;  ///< Lights that stand for the environment where its shadows are found, 0 to 256.
  ContextKind context = ContextKind::automatic;  ///< Any but automatic: OpenGL draws, not `raycast`.
};

struct RenderedMap {
  EnvironmentMap map;
  DrawMethod method;  ///< Never automatic.
  /// Steradians of the triangles that distort or tessellate left out: what the map lacks at most.
  double missing_solid_angle = 0;
  std::vector<std::string> remarks;  ///< What of the file is not drawn, and whether the map is black, in sentences.
};

/// Draws one map of a glTF or OBJ file: for several, keep a Scene and a Light (scene.h). OpenGL has a thread and a
/// context of its own: the caller's stay as they are.
/// @param environment what lies behind the scene and lights it; null: black.
/// @throws InputError where the file cannot be read, UsageError where an option is out of its range or names what the
/// scene has not, RendererError where there is nothing to draw with.
RenderedMap render(const std::string& scene, const RenderOptions& options = {},
                   const EnvironmentMap* environment = nullptr, const Run& run = {});

}  // namespace envmap

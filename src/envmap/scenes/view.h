/// @file
/// A picture of a scene, with its mirrors and lenses drawn through environment maps: what `envmap view` does, of one
/// moment.
#pragma once

#include <iterator>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "envmap/base/enumerators.h"
#include "envmap/base/export.h"
#include "envmap/base/run.h"
#include "envmap/map/environment_map.h"
#include "envmap/scenes/render/drawing_method.h"

namespace ENVMAP_EXPORT envmap {

/// What is wished of a node: that it is a mirror, whatever its material, or that it is none.
struct MirrorWish {
  std::string node;
  std::optional<Projection> map = {};  ///< Of its map: sphere, paraboloid or cube. Absent: ViewOptions::maps.
  bool off = false;
};

/// maps: OpenGL, each mirror through a map of its own. raycast: rays that mirrors reflect, the reference, no OpenGL.
enum class ViewMethod { maps, raycast };
inline constexpr std::string_view view_method_names[] = {"maps", "raycast"};
template <>
inline constexpr std::size_t enumerators<ViewMethod> = std::size(view_method_names);

struct ViewOptions {
  /// A point of the scene, or the name of a camera. Absent: the scene's first camera, or all of the scene in sight.
  std::optional<std::variant<Direction, std::string>> camera = {};
  std::optional<Direction> look_at = {};              ///< The point at the picture's centre.
  std::optional<double> vertical_field_degrees = {};  ///< 0.01 to 179. Absent: the camera's, or 40.
  int width = 640, height = 480;                      ///< Pixels, 1 to 16384.
  int samples = 4;                                    ///< Rays a pixel, 1 to 1024.
  double time_seconds = 0;                            ///< Of the scene's movements, -1e6 to 1e6.
  std::optional<Colour> ambient = {};                 ///< Radiance from all round.
  bool shadows = true;
  int occlusion = 64;  ///< Lights that stand for the environment where its shadows are found, 0 to 256.
  ViewMethod method = ViewMethod::maps;
  Reflection reflection = Reflection::split_sum;  ///< Of the environment, where lobe_samples is 0.
  /// raycast and the rays of max_error: samples of the integral of a rough reflection, in place of `reflection`.
  int lobe_samples = 0;
  std::vector<MirrorWish> mirrors = {};      ///< Beside what materials make one.
  Projection maps = Projection::paraboloid;  ///< sphere, paraboloid or cube.
  int map_size = 0;                          ///< Height of a map's face, 4 to 8192; 0: what the picture needs.
  int largest_map = 1024;                    ///< Upper limit of what the picture needs.
  std::optional<int> bounces = {};           ///< Between mirrors, 1 to 64. Absent: until nothing changes, 32 at most.
  MirrorLookup lookup = MirrorLookup::distance;
  /// Chooses maps, lookup and bounces: the cheapest whose picture is off by this at most, the rms of the difference
  /// over that of the picture by rays; else rays. 1e-6 to 10.
  std::optional<double> max_error = {};
  double near_metres = 0.01, far_metres = 1000;  ///< Of maps: nothing nearer or further is drawn.
  ContextKind context = ContextKind::automatic;  ///< Any but automatic: OpenGL draws, not rays.
};

struct ViewedMirror {
  std::string node;    ///< Its name, which other nodes may have, too.
  int number = 0;      ///< Of the node in the scene.
  EnvironmentMap map;  ///< In the axes of the world. Without levels where nobody saw the mirror.
};

struct ViewedScene {
  int width = 0, height = 0;
  std::vector<Colour> radiance;  ///< Rows from the top, from left to right.
  ViewMethod method = ViewMethod::maps;
  std::optional<double> error = {};   ///< Against rays, where max_error was given.
  std::vector<ViewedMirror> mirrors;  ///< Of `maps`.
  std::vector<std::string> remarks;   ///< What of the file is not drawn, and whether it is black, in sentences.
};

/// Draws one picture of a glTF or OBJ file: for several, keep a Scene and a Light (scene.h). OpenGL has a thread and a
/// context of its own: the caller's stay as they are.
/// @param environment what lies behind the scene and lights it; null: black.
/// @throws InputError where the file cannot be read, UsageError where an option is out of its range or names what the
/// scene has not, RendererError where there is nothing to draw with.
ViewedScene view(const std::string& scene, const ViewOptions& options = {}, const EnvironmentMap* environment = nullptr,
                 const Run& run = {});

}  // namespace envmap

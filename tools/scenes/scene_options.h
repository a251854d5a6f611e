/// @file
/// What the commands that draw scenes have in common: the scene, its light, its moments.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "cli/options.h"
#include "envmap/base/part_progress.h"
#include "envmap/io/read.h"
#include "envmap/scenes/lit_scene.h"
#include "envmap/scenes/render/context.h"
#include "envmap/scenes/render/draw.h"
#include "envmap/scenes/render/texture_filter.h"

namespace tools {

struct SceneOptions {
  std::string path, environment, frames;
  std::optional<envmap::Direction> ambient;
  envmap::ContextKind context = envmap::ContextKind::automatic;
  bool no_shadows = false, suns = false;
  std::optional<bool> allow_missing;  // Absent: the command has no such option.
  int occlusion = 64;
  envmap::Reflection reflection = envmap::Reflection::split_sum;
  double time = 0, rate = 24;
  envmap::ReadOptions read;
};
void add_scene(Options& o, SceneOptions& scene);  ///< The argument. The others add a group each.
void add_light(Options& o, SceneOptions& scene);
void add_texture_filter(Options& o, std::optional<envmap::TextureFilter>& filter);
void add_context(Options& o, SceneOptions& scene);
void add_frames(Options& o, SceneOptions& scene);
void add_scene_input(Options& o, SceneOptions& scene);
/// For --method raycast. @throws UsageError where --context is given, which rays have no use for.
void check_no_context(const SceneOptions& options);

/// What draws, with --verbose, and why not the graphics card that is there.
void tell_renderer(const envmap::Context& context);

/// Whether a name stands for one file a frame: it holds {frame} or %04d.
bool is_numbered(const std::string& output);

/// The moments to draw; without --frames one, and one file.
struct Frames {
  int first = 0, last = 0;
  bool sequence = false;
  double start = 0, rate = 24;

  [[nodiscard]] int count() const { return last - first + 1; }
  /// The progress of a frame, of that of all.
  [[nodiscard]] envmap::Progress part(const envmap::Progress& all, int frame) const {
    return envmap::part_progress(all, double(frame - first) / count(), 1.0 / count());
  }
  [[nodiscard]] double time(int frame) const { return start + (sequence ? frame / rate : 0); }
  /// Of a frame's file: {frame}, four digits at least, or printf's %d and %04d. @throws UsageError
  [[nodiscard]] std::string path(const std::string& output, int frame) const;
  [[nodiscard]] std::vector<std::string> paths(const std::string& output) const;
};
/// @throws UsageError
Frames frames_of(const SceneOptions& options);

/// read_scene(), whose error about a missing texture names --allow-missing.
/// @param allow_missing absent where the command has no such option.
envmap::SceneGraph read_scene(const std::string& path, const envmap::ReadOptions& read,
                              std::optional<bool> allow_missing);
void add_allow_missing(Options& o, std::optional<bool>& allow_missing);

/// A scene with its environment. What it does not draw has been said.
struct LoadedScene : envmap::LitScene {
  std::vector<std::string> inputs = {};

  using LitScene::shot;
  [[nodiscard]] envmap::FrameState shot(double time, const SceneOptions& options) const;
};
/// As it is at the first moment.
LoadedScene load(const SceneOptions& options);

/// The first names of nodes, and the command that prints all.
std::string nodes_in_words(const envmap::SceneGraph& scene);

/// From where --at says: a node, whose `at` is to be found for each pose and which is left out; a place X,Y,Z; or the
/// origin.
/// @throws UsageError where it is neither. @param path of the scene's file.
envmap::Viewpoint viewpoint_of(const std::string& at, const envmap::SceneGraph& scene, const std::string& path);

/// A point X,Y,Z, or a name; of nothing nothing.
std::optional<std::variant<envmap::Direction, std::string>> camera_of(const std::string& text);

/// A line where it is dark. @return whether it is.
bool tell_darkness(const LoadedScene& loaded, const SceneOptions& options);

/// With -v, how many frames a second that was.
void tell_rate(const Frames& frames, double seconds);

}  // namespace tools

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "commands/tradeoff/scene_task.h"
#include "envmap/base/error.h"
#include "envmap/scenes/choose_maps.h"
#include "envmap/scenes/choose_mirrors.h"
#include "envmap/scenes/render/mirrors.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/stereo.h"
#include "envmap/scenes/viewpoints.h"
#include "scenes/mirror_options.h"

namespace tools {
namespace {

using namespace envmap;

constexpr int samples = 4;  // A pixel, at the same places in all ways, so that edges are even.

// A square picture as a map whose texels all count the same, which is how pixels count.
Outcome as_level(const std::vector<Colour>& pixels, int size) {
  Level level(Projection::equal_area, size);
  for (int j = 0; j < size; ++j) std::copy_n(pixels.begin() + std::ptrdiff_t{j} * size, size, level.row(0, j).begin());
  return {std::move(level)};
}

// What a picture is drawn of, once for all ways.
struct Stage {
  const LoadedScene& loaded;
  FrameState shot;
  View view;
  int size;
  std::vector<int> mirrors;

  [[nodiscard]] Eye eye() const { return eye_of({size, size, samples}, view); }
  [[nodiscard]] Outcome cast() const { return as_level(raycast_picture(shot, eye().from, {mirrors}), size); }
};

Outcome draw_once(Gl& gl, const Stage& stage, Projection maps, MirrorLookup lookup, const MirrorOptions& how) {
  FrameState shot = stage.shot;
  shot.look.lookup = lookup;
  return as_level(picture_through_maps(gl.renderer, shot, choose_mirrors(stage.loaded.scene, {}, maps), stage.eye(),
                                       how),
                  stage.size);
}

std::string setting_of(MirrorLookup lookup, const MirrorOptions& how) {
  std::string text;
  const auto add = [&](const std::string& option) { text += (text.empty() ? "" : " ") + option; };
  if (lookup != MirrorLookup::distance) add(fmt::format("--lookup {}", mirror_lookup_names[std::size_t(lookup)]));
  if (how.size > 0) add(fmt::format("--size {}", how.size));
  if (how.bounces) add(fmt::format("--bounces {}", *how.bounces));
  return text;
}

// Every lookup at every size, then how often mirrors draw each other.
std::vector<std::pair<MirrorLookup, MirrorOptions>> ways_of_maps() {
  std::vector<std::pair<MirrorLookup, MirrorOptions>> ways;
  for (const int size : {0, 64, 256, 1024})
    for (const MirrorLookup lookup : {MirrorLookup::distance, MirrorLookup::direction, MirrorLookup::vertex})
      ways.push_back({lookup, {.size = size}});
  for (const int bounces : {1, 2, 4}) ways.push_back({MirrorLookup::distance, {.bounces = bounces}});
  return ways;
}

void add_maps(const std::shared_ptr<const Stage>& stage, ContextKind kind, Task& task) {
  const auto gl = open_gl(stage->loaded, kind, stage->mirrors, "maps");
  if (!gl) return;
  for (const auto& [lookup, how] : ways_of_maps())
    for (const std::string_view maps : map_names)
      task.ways.push_back({fmt::format("--maps {}", maps), setting_of(lookup, how),
                           [gl, stage, to = *projection_named(maps), lookup = lookup, how = how] {
                             return draw_once(*gl, *stage, to, lookup, how);
                           }});
}

}  // namespace

Task make_view_task(const std::string& name, const LoadedScene& loaded, const SceneOptions& options,
                    const std::string& camera) {
  const std::vector<std::string> parts = parts_of(name);
  if (parts.size() > 2) throw UsageError(fmt::format("--task '{}' must be one of {}", name, task_words()));
  const int size = parts.size() == 2 ? size_of(name, parts[1]) : 256;
  const FrameState shot = loaded.shot(options.time, options);
  const View view =
      Viewpoints({.camera = camera_of(camera)}, 1, loaded.scene, options.path, shot.pose).view(shot.pose, 0);
  const std::vector<int> mirrors = nodes_of(choose_mirrors(loaded.scene, {}, Projection::cube));
  if (mirrors.empty()) throw UsageError(options.path, "has no mirror and no lens, whose maps 'view' is about");
  const auto stage = std::make_shared<const Stage>(Stage{loaded, shot, view, size, mirrors});
  const auto cast = [stage] { return stage->cast(); };
  Task task{.name = name, .reference = "--method raycast", .truth = cast};
  task.ways.push_back({"--method raycast", "", cast});
  add_maps(stage, options.context, task);
  return task;
}

}  // namespace tools

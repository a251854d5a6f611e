#include "envmap/scenes/render_map.h"

#include <fmt/format.h>

#include <future>

#include "envmap/base/error.h"
#include "envmap/base/part_progress.h"
#include "envmap/base/run_operation.h"
#include "envmap/maths/check_direction.h"
#include "envmap/scenes/check_drawing.h"
#include "envmap/scenes/lit_scene.h"
#include "envmap/scenes/render/choose_drawing.h"
#include "envmap/scenes/render/context.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/render/renderer.h"

namespace envmap {
namespace {

void check(const RenderOptions& o) {
  check_range(limits::size, o.size);
  check_drawing(o, o.method == DrawMethod::raycast);
  check_place("at", o.at);
  if (o.towards)
    if (const auto* const along = std::get_if<Direction>(&*o.towards)) (void)checked_direction("towards", *along);
  if (!can_draw(o.method, o.to.projection))
    throw UsageError(fmt::format("method '{}' cannot draw {} maps: resample or raycast can",
                                 draw_method_names[std::size_t(o.method)], name(o.to.projection)));
}

Viewpoint viewpoint(const RenderOptions& o, const Scene& scene, const Pose& pose, const std::string& path) {
  Viewpoint from{.to = o.to.projection,
                 .size = o.size,
                 .axes = image_to_world(o.to.forward),
                 .near = o.near_metres,
                 .far = o.far_metres,
                 .samples = o.samples};
  if (const auto* const place = std::get_if<Direction>(&o.at)) from.at = *place;
  if (const auto* const name = std::get_if<std::string>(&o.at)) {
    const auto node = find_node(scene, *name);
    if (!node) throw UsageError(fmt::format("at: '{}' is no node of {}: {}", *name, path, list_nodes(scene)));
    from.without = *node;
    from.at = centre_of(scene, pose, *node);
  }
  if (!o.towards) return from;
  if (const auto* const along = std::get_if<Direction>(&*o.towards)) from.axes = turned_to(*along);
  if (const auto* const name = std::get_if<std::string>(&*o.towards)) {
    const auto there = direction_to(scene, pose, from.at, *name);
    if (!there)
      throw UsageError(fmt::format("towards: '{}' is no node of {} and no camera: {}", *name, path, list_nodes(scene)));
    from.axes = turned_to(*there);
  }
  return from;
}

// In a thread of its own, so that the context that is current in the caller's stays current.
Drawn draw_by_opengl(const FrameState& shot, const Viewpoint& from, DrawMethod method, ContextKind kind) {
  const auto drawn = [&] {
    const Context context(kind);
    Renderer renderer(shot.scene, shot.environment);
    return draw(renderer, from, shot, method);
  };
  return std::async(std::launch::async, drawn).get();
}

}  // namespace

RenderedMap render(const std::string& path, const RenderOptions& o, const EnvironmentMap* environment, const Run& run) {
  check(o);
  return run_operation(run, [&](const Progress& progress) {
    const LitScene lit = read_lit_scene(path, environment, o.occlusion, Reflection::split_sum, o.time_seconds,
                                        part_progress(progress, 0, 0.5));
    const FrameState shot = lit.shot(o.time_seconds, o.ambient, o.shadows);
    const Viewpoint from = viewpoint(o, lit.scene, shot.pose, path);
    const DrawMethod method = o.method == DrawMethod::automatic ? cheapest(o.to.projection, o.size, draw_load(shot),
                                                                           o.context == ContextKind::automatic)
                                                                : o.method;
    Drawn drawn = method == DrawMethod::raycast ? raycast(shot, from, {}, part_progress(progress, 0.5, 0.5))
                                                : draw_by_opengl(shot, from, method, o.context);
    drawn.radiance.forward = o.towards ? Forward::plus_z : o.to.forward;
    return RenderedMap{std::move(drawn.radiance), method, drawn.missing_solid_angle, lit.remarks(o.ambient)};
  });
}

}  // namespace envmap

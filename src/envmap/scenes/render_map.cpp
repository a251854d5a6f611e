#include "envmap/scenes/render_map.h"

#include <fmt/format.h>

#include <optional>

#include "envmap/base/error.h"
#include "envmap/base/part_progress.h"
#include "envmap/base/run_operation.h"
#include "envmap/maths/check_direction.h"
#include "envmap/scenes/check_drawing.h"
#include "envmap/scenes/render/choose_drawing.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/scene_state.h"

namespace envmap {
namespace {

void check(const RenderOptions& o) {
  check_range(limits::size, o.size);
  check_drawing(o, o.method == DrawMethod::raycast);
  if (o.towards)
    if (const auto* const along = std::get_if<Direction>(&*o.towards)) (void)checked_direction("towards", *along);
  if (!can_draw(o.method, o.to.projection))
    throw UsageError(fmt::format("method '{}' cannot draw {} maps: resample or raycast can",
                                 draw_method_names[std::size_t(o.method)], name(o.to.projection)));
}

Viewpoint viewpoint(const ScenePlace& at, const RenderOptions& o, const SceneGraph& scene, const Pose& pose,
                    const std::string& path) {
  Viewpoint from{.to = o.to.projection,
                 .size = o.size,
                 .axes = image_to_world(o.to.forward),
                 .near = o.near_metres,
                 .far = o.far_metres,
                 .samples = o.samples};
  if (const auto* const place = std::get_if<Direction>(&at)) from.at = *place;
  if (const auto* const name = std::get_if<std::string>(&at)) {
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

DrawMethod method_for(const RenderOptions& o, const FrameState& shot) {
  if (o.method != DrawMethod::automatic) return o.method;
  return cheapest(o.to.projection, o.size, draw_load(shot), o.context == ContextKind::automatic);
}

}  // namespace

std::vector<RenderedMap> Scene::maps(std::span<const ScenePlace> at, const RenderOptions& o, const Light* light,
                                     const Run& run) const {
  check(o);
  for (const ScenePlace& place : at) check_place("at", place);
  State& state = *state_;
  const auto draw_all = [&](const Progress& progress) {
    constexpr double lighting = 0.5;  // Its share of the progress.
    state.prepare(light, o.occlusion, Reflection::split_sum, o.time_seconds, part_progress(progress, 0, lighting));
    const FrameState shot = state.lit.shot(o.time_seconds, o.ambient, o.shadows);
    const DrawMethod method = method_for(o, shot);
    std::vector<Viewpoint> viewpoints;
    for (const ScenePlace& place : at)
      viewpoints.push_back(viewpoint(place, o, state.lit.scene, shot.pose, state.path));
    std::vector<RenderedMap> made;
    for (const Viewpoint& from : viewpoints) {
      const double share = (1 - lighting) / double(at.size());
      const Progress of_map = part_progress(progress, lighting + share * double(made.size()), share);
      Drawn drawn;
      if (method == DrawMethod::raycast)
        drawn = raycast(shot, from, {}, of_map);
      else
        state.drawing_with(o.context).run(
            [&](DrawingSession& session) { drawn = draw(state.renderer(session), from, shot, method); }, of_map);
      if (of_map) of_map(1);
      drawn.radiance.forward = o.towards ? Forward::plus_z : o.to.forward;
      made.push_back({std::move(drawn.radiance), method, drawn.missing_solid_angle, state.lit.remarks(o.ambient)});
    }
    return made;
  };
  return run_operation(run, [&](const Progress& progress) {
    return state.in_turn(progress, [&] { return draw_all(progress); });
  });
}

RenderedMap Scene::map(const RenderOptions& o, const Light* light, const Run& run) const {
  return std::move(maps({&o.at, 1}, o, light, run).front());
}

RenderedMap render(const std::string& path, const RenderOptions& o, const EnvironmentMap* environment, const Run& run) {
  check(o);  // Before reading takes its time.
  return lit_by(environment, run,
                [&](const Light* light, const Run& rest) { return Scene::read(path).map(o, light, rest); });
}

}  // namespace envmap

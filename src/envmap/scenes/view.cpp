#include "envmap/scenes/view.h"

#include <optional>

#include "envmap/base/error.h"
#include "envmap/base/part_progress.h"
#include "envmap/base/run_operation.h"
#include "envmap/scenes/check_drawing.h"
#include "envmap/scenes/choose_maps.h"
#include "envmap/scenes/choose_mirrors.h"
#include "envmap/scenes/mirror_painter.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/scene_state.h"
#include "envmap/scenes/viewpoints.h"

namespace envmap {
namespace {

void check_map(Projection map) {
  if (map != Projection::sphere && map != Projection::paraboloid && map != Projection::cube)
    throw UsageError("maps of mirrors are sphere, paraboloid or cube");
}

void check(const ViewOptions& o) {
  check_range({"width", 1, 16384}, o.width);
  check_range({"height", 1, 16384}, o.height);
  check_range({"lobe_samples", 0, 65536}, o.lobe_samples);
  check_range({"largest_map", 4, 8192}, o.largest_map);
  if (o.map_size != 0) check_range({"map_size", 4, 8192}, o.map_size);
  if (o.vertical_field_degrees) check_range({"vertical_field_degrees", 0.01, 179}, *o.vertical_field_degrees);
  if (o.bounces) check_range({"bounces", 1, 64}, *o.bounces);
  if (o.max_error) check_range({"max_error", 1e-6, 10}, *o.max_error);
  check_enumerator("reflection", o.reflection);
  check_enumerator("lookup", o.lookup);
  check_map(o.maps);
  for (const MirrorWish& wish : o.mirrors) check_map(wish.map.value_or(o.maps));
  const bool by_rays = o.method == ViewMethod::raycast;
  if (o.lobe_samples > 0 && !by_rays && !o.max_error)
    throw UsageError("lobe_samples is for the method 'raycast' and for max_error");
  if (o.lobe_samples > 0 && by_rays && o.reflection != Reflection::split_sum)
    throw UsageError("lobe_samples and reflection 'sampled' exclude each other");
  check_drawing(o, by_rays);
  if (o.camera) check_place("camera", *o.camera);
  if (o.look_at) check_finite("look_at", Flux(o.look_at->x, o.look_at->y, o.look_at->z));
  if (o.max_error && by_rays) throw UsageError("max_error chooses maps, which the method 'raycast' does not draw");
}

// One picture, and what it is made of.
struct ViewSession {
  const ViewOptions& options;
  const LitScene& lit;
  const std::vector<Mirror>& mirrors;
  FrameState shot;
  Eye eye;
};

void cast(const ViewSession& s, const Progress& progress, ViewedScene& viewed) {
  const ViewOptions& o = s.options;
  viewed.method = ViewMethod::raycast;
  viewed.radiance =
      raycast_picture(s.shot, s.eye.from,
                      {nodes_of(s.mirrors), o.bounces.value_or(max_rounds), o.far_metres, o.lobe_samples}, progress);
}

// @param drawn_with its context is current. @return whether maps are good enough.
bool paint(ViewSession& s, DrawingSession& drawn_with, ViewedScene& viewed) {
  const ViewOptions& o = s.options;
  MirrorOptions drawing{
      .size = o.map_size, .largest = o.largest_map, .bounces = o.bounces, .near = o.near_metres, .far = o.far_metres};
  s.shot.look.lookup = o.lookup;
  MirrorPainter painter(s.lit, s.mirrors, drawn_with.programs);
  if (o.max_error && (!s.mirrors.empty() || o.lobe_samples > 0)) {
    const MapChoice choice =
        choose_maps(painter.renderer(), s.mirrors, {{s.shot, s.eye}}, drawing, *o.max_error, o.lobe_samples);
    viewed.error = choice.error;
    if (choice.rays) return false;
    s.shot.look.lookup = choice.lookup, drawing = choice.drawing;
  }
  s.shot.look.pictures = drawing.bounces.value_or(s.shot.look.pictures);
  viewed.radiance = std::move(painter.paint(s.shot, {}, {s.eye}, drawing).pictures.front());
  std::vector<PaintedMap> maps = painter.maps();
  for (std::size_t k = 0; k < maps.size(); ++k)
    viewed.mirrors.push_back(
        {s.lit.scene.nodes[std::size_t(s.mirrors[k].node)].name, s.mirrors[k].node, std::move(maps[k].radiance)});
  return true;
}

}  // namespace

ViewedScene Scene::view(const ViewOptions& o, const Light* light, const Run& run) const {
  check(o);
  State& state = *state_;
  const auto draw = [&](const Progress& progress) {
    state.prepare(light, o.occlusion, o.reflection, o.time_seconds, part_progress(progress, 0, 0.5));
    const LitScene& lit = state.lit;
    const std::vector<Mirror> mirrors = choose_mirrors(lit.scene, o.mirrors, o.maps);
    const FrameState shot = lit.shot(o.time_seconds, o.ambient, o.shadows);
    const Viewpoints viewpoints({o.camera, o.look_at, o.vertical_field_degrees}, double(o.width) / o.height, lit.scene,
                                state.path, shot.pose);
    ViewSession sitting{o, lit, mirrors, shot, eye_of({o.width, o.height, o.samples}, viewpoints.view(shot.pose, 0))};
    ViewedScene viewed{.width = o.width, .height = o.height, .radiance = {}, .mirrors = {}, .remarks = {}};
    bool by_rays = o.method == ViewMethod::raycast;
    const Progress drawing = part_progress(progress, 0.5, 0.5);
    if (!by_rays)
      state.drawing_with(o.context).run([&](DrawingSession& session) { by_rays = !paint(sitting, session, viewed); },
                                        drawing);
    if (by_rays) cast(sitting, drawing, viewed);
    viewed.remarks = lit.remarks(o.ambient);
    return viewed;
  };
  return run_operation(run, [&](const Progress& progress) {
    return state.in_turn(progress, [&] { return draw(progress); });
  });
}

ViewedScene view(const std::string& path, const ViewOptions& o, const EnvironmentMap* environment, const Run& run) {
  check(o);  // Before reading takes its time.
  return lit_by(environment, run,
                [&](const Light* light, const Run& rest) { return Scene::read(path).view(o, light, rest); });
}

}  // namespace envmap

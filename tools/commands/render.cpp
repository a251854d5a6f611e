#include <fmt/format.h>

#include "command.h"
#include "envmap/base/error.h"
#include "envmap/io/write_distances.h"
#include "envmap/scenes/render/choose_drawing.h"
#include "envmap/scenes/render/context.h"
#include "envmap/scenes/render/mirrors.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/render/renderer.h"
#include "maps/depfile.h"
#include "maps/map_options.h"
#include "maps/read_and_write_maps.h"
#include "scenes/mirror_options.h"
#include "scenes/scene_options.h"

namespace tools {
namespace {

using namespace envmap;

struct Request {
  SceneOptions scene;
  std::string output, at, forward;
  std::optional<Projection> to;
  Viewpoint from;
  DrawMethod method = DrawMethod::automatic;
  int bounces = 0, lobe_samples = 0;
  bool distance = false;  // A channel Z.
  WriteOptions write;
};

// Draws maps with OpenGL, mirrors in them through maps of their own.
class Painter {
 public:
  Painter(const Request& o, const LoadedScene& loaded, const std::vector<Mirror>& mirrors)
      : options_(o),
        context_(o.scene.context),
        renderer_(loaded.scene, loaded.environment.get(), nodes_of(mirrors)),
        found_(mirrors),
        mirrors_(loaded.scene, mirrors) {
    tell_renderer(context_);
  }

  // @param moved meshes whose vertices are others than in the last shot.
  [[nodiscard]] Drawn paint(FrameState shot, const std::vector<int>& moved, DrawMethod method) {
    for (const int mesh : moved) renderer_.update(shot.scene, mesh);
    const Viewpoint& from = options_.from;
    if (options_.bounces > 0) {
      const Viewer viewer{.at = from.at, .node = from.without, .pixel = 0.5 * pi / from.size};
      tell(mirrors_.update(renderer_, shot, {viewer},
                           {.bounces = options_.bounces, .moved = !moved.empty(), .near = from.near, .far = from.far}),
           shot.scene, found_);
      shot.mirrors = mirrors_.maps();
    }
    return draw(renderer_, from, shot, method);
  }

 private:
  const Request& options_;
  Context context_;
  Renderer renderer_;
  std::vector<Mirror> found_;
  Mirrors mirrors_;
};

// Says what a map of moved vertices lacks.
void warn_about_missing(const std::string& path, DrawMethod method, const Drawn& drawn) {
  if (drawn.missing_solid_angle == 0) return;
  warn(fmt::format("{}: {} left out surfaces near the singularity, up to {:.2g} sr: use --method exact", path,
                   draw_method_names[std::size_t(method)], drawn.missing_solid_angle));
}

bool is_black(const Level& level) {
  for (int face = 0; face < level.faces(); ++face)
    for (int row = 0; row < level.height(); ++row)
      for (const Colour& c : level.row(face, row))
        if (c != Colour(0)) return false;
  return true;
}

// @param black the first map that is black, or nothing.
void tell_blackness(const std::string& black, const LoadedScene& loaded, const Request& o) {
  if (tell_darkness(loaded, o.scene) || black.empty()) return;
  warn(fmt::format(
      "{}: is black: no texel shows a lit surface within {:g} m: change --at, raise --far or use --environment MAP",
      black, o.from.far));
}

void write_drawn(const std::string& path, const Drawn& drawn, const Direction& at, const Request& o) {
  if (o.distance)
    write_distances(path, drawn.radiance, drawn.distances, at, o.write);
  else
    write_map(path, all_rows_of(drawn.radiance), o.write, "write");
}

// From where the map is drawn to a node, or to the scene's first camera; or what is said.
Direction direction(const Request& o, const Scene& scene, const Pose& pose) {
  if (const auto along = triple_of(o.forward)) return *along;
  if (const auto there = direction_to(scene, pose, o.from.at, o.forward)) return *there;
  if (o.forward == "camera") throw UsageError(fmt::format("--forward: {} has no camera", o.scene.path));
  throw UsageError(fmt::format("--forward: '{}' must be +z, -z, +x, -x, X,Y,Z, a node of {} or 'camera': {}", o.forward,
                               o.scene.path, nodes_in_words(scene)));
}

void check(const Request& o) {
  if (o.from.near >= o.from.far) throw UsageError("--near must be less than --far");
  if (forward_named(o.forward) && !has_forward(o.from.to))
    throw UsageError("--forward: an axis needs a latlong or angular map: use a node, X,Y,Z or camera");
  if (o.method == DrawMethod::raycast) check_no_context(o.scene);
  if (o.lobe_samples > 0 && o.method != DrawMethod::raycast) throw UsageError("--lobe-samples is for --method raycast");
  const bool distorts = o.method == DrawMethod::distort || o.method == DrawMethod::tessellate;
  if (o.from.epsilon > 0 && !distorts) throw UsageError("--epsilon is for --method distort and tessellate");
  if (!can_draw(o.method, o.from.to))
    throw UsageError(fmt::format("--method {} cannot draw {} maps: {}resample or raycast",
                                 draw_method_names[std::size_t(o.method)], name(o.from.to),
                                 can_draw(DrawMethod::exact, o.from.to) ? "exact, " : ""));
  const bool measures =
      o.method == DrawMethod::automatic || o.method == DrawMethod::exact || o.method == DrawMethod::raycast;
  if (o.distance && !measures) throw UsageError("--distance is for --method exact and raycast");
}

// The method that --distance takes by itself.
DrawMethod method_with_distances(const Request& o) {
  if (o.scene.context == ContextKind::automatic) return DrawMethod::raycast;
  if (can_draw(DrawMethod::exact, o.from.to)) return DrawMethod::exact;
  throw UsageError(fmt::format("--distance: OpenGL cannot measure {} maps: remove --context", name(o.from.to)));
}

// For --method auto. Who says what OpenGL is drawn with wants it drawn with OpenGL. A card takes longer to start than
// rays take for a map, so only sequences look for one. Where nothing moves, shadow maps are drawn once.
DrawMethod method_for(const Request& o, const Frames& frames, const LoadedScene& loaded) {
  if (o.distance) return method_with_distances(o);
  const bool rays = o.scene.context == ContextKind::automatic;
  const bool card = frames.count() > 1 && o.scene.context != ContextKind::osmesa && finds_graphics_card();
  DrawLoad load = draw_load(loaded.shot(frames.time(frames.first), o.scene));
  if (loaded.scene.animations.empty()) load.shadow_texels /= std::size_t(frames.count());
  return cheapest(o.from.to, o.from.size, load, rays, card);
}

int run(Request& o, Report& report) {
  o.from.to = o.to.value_or(Projection::cube);
  const Forward forward = forward_named(o.forward).value_or(Forward::plus_z);
  o.from.axes = image_to_world(forward);
  check(o);
  const Frames frames = frames_of(o.scene);
  check_output(frames.path(o.output, frames.first), o.write, o.from.to);
  if (o.distance) check_distances(frames.path(o.output, frames.first), o.write);
  const std::vector<std::string> outputs = frames.paths(o.output);
  const FaceNames faces{.written = o.write.faces, .read = {}};
  check_files(outputs, {o.scene.path, o.scene.environment}, faces);  // Before reading takes its time.
  LoadedScene loaded = load(o.scene);
  check_files(outputs, loaded.inputs, faces);
  open_depfile();
  const Viewpoint place = viewpoint_of(o.at, loaded.scene, o.scene.path);
  o.from.at = place.at, o.from.without = place.without;
  const bool turned = !o.forward.empty() && !forward_named(o.forward);
  const DrawMethod method = o.method == DrawMethod::automatic ? method_for(o, frames, loaded) : o.method;
  const std::vector<Mirror> mirrors =
      o.bounces > 0 ? find_mirrors(loaded.scene, Projection::paraboloid) : std::vector<Mirror>{};
  std::optional<Painter> painter;
  if (method != DrawMethod::raycast) painter.emplace(o, loaded, mirrors);
  double seconds = 0;
  std::string black;
  report.put("input", o.scene.path);
  report.put("method", draw_method_names[std::size_t(method)]);
  const Progress progress = progress_line("render");
  for (int frame = frames.first; frame <= frames.last; ++frame) {
    const std::vector<int> moved = loaded.move_to(frames.time(frame));
    const FrameState shot = loaded.shot(frames.time(frame), o.scene);
    if (o.from.without >= 0) o.from.at = centre_of(loaded.scene, shot.pose, o.from.without);
    if (turned) o.from.axes = turned_to(direction(o, loaded.scene, shot.pose));
    const Progress of_frame = frames.part(progress, frame);
    const Stopwatch watch;
    Drawn drawn = painter ? painter->paint(shot, moved, method)
                          : raycast(shot, o.from, {nodes_of(mirrors), o.bounces, o.from.far, o.lobe_samples}, of_frame);
    if (of_frame) of_frame(1);
    const double took = watch.seconds();
    seconds += took;
    drawn.radiance.forward = forward;
    const std::string path = frames.path(o.output, frame);
    if (turned)
      note(fmt::format("{}: its +Z looks along {:.4g},{:.4g},{:.4g} of the scene, its +Y up", path, o.from.axes[2].x,
                       o.from.axes[2].y, o.from.axes[2].z));
    if (settings().verbose)
      note(fmt::format("{}: {} from {:.4g},{:.4g},{:.4g}, drawn in {:.1f} ms", path,
                       draw_method_names[std::size_t(method)], o.from.at.x, o.from.at.y, o.from.at.z, 1e3 * took));
    write_drawn(path, drawn, o.from.at, o);
    warn_about_missing(path, method, drawn);
    if (black.empty() && is_black(drawn.radiance.base())) black = path;
    report.append("maps[]");
    report.put("maps[].output", path);
    report.put("maps[].seconds", took);
    report.put("maps[].missing_solid_angle", drawn.missing_solid_angle);
  }
  tell_blackness(black, loaded, o);
  tell_rate(frames, seconds);
  return 0;
}

}  // namespace

Action define_render(Options& o) {
  const auto r = std::make_shared<Request>();
  add_scene(o, r->scene);
  o.writes("OUTPUT", r->output, "File to write, or '-' for stdout ({face}: six files, {frame}: one per frame)")
      .required = true;
  o.group = groups::output_map;
  o.add("--at", "NODE|X,Y,Z", &r->at,
        "Centre of the map: a node ('envmap info SCENE' lists them) or a point (default: 0,0,0)");
  add_projection(o, "--to PROJECTION", r->to, "{} (default: cube)");
  add_size(o, &r->from.size, "Height of the image or of one cube face (default: 256)");
  o.add("--forward", "AXIS|NODE|X,Y,Z|camera", &r->forward, "Axis, node, direction or camera at the centre");
  o.add("--near", "METRES", &r->from.near, {1e-9, 1e9}, "Distance of the near plane (default: 0.01)");
  o.add("--far", "METRES", &r->from.far, {1e-9, 1e12}, "Distance of the far plane (default: 1000)");
  add_layout(o, "--layout", r->write.layout, "Cube faces: {} (default: column)");
  add_faces(o, r->write);
  add_light(o, r->scene);
  add_context(o, r->scene);
  o.add("--method", one_of(r->method, draw_method_names), "{} (default: auto)");
  o.add("--samples", "N", &r->from.samples, {1, 1024}, "Rays per texel (default: 1)");
  o.add("--bounces", "N", &r->bounces, {0, 64},
        "Reflections between mirrors (0: of the environment only) (default: 0)");
  o.add("--lobe-samples", "N", &r->lobe_samples, {0, 65536},
        "raycast: samples per rough reflection (0: prefiltered levels) (default: 0)");
  o.add("--epsilon", "Z", &r->from.epsilon, {1e-6, 1},
        "distort, tessellate: move vertices with z < -1 + Z to infinity");
  o.flag("--distance", r->distance, "exact, raycast: write distances to channel Z of the EXR file");
  add_frames(o, r->scene);
  add_write_options(o, r->write, "float, or nearest");
  add_scene_input(o, r->scene);
  return [r](Report& report) { return run(*r, report); };
}

}  // namespace tools

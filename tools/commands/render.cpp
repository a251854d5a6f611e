#include <fmt/format.h>

#include "command.h"
#include "envmap/base/error.h"
#include "envmap/base/part_progress.h"
#include "envmap/io/write_distances.h"
#include "envmap/scenes/render/choose_drawing.h"
#include "envmap/scenes/render/context.h"
#include "envmap/scenes/render/mirrors.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/render/renderer.h"
#include "maps/depfile.h"
#include "maps/map_options.h"
#include "maps/read_and_write_maps.h"
#include "scenes/grid_options.h"
#include "scenes/mirror_options.h"
#include "scenes/place_files.h"
#include "scenes/scene_options.h"

namespace tools {
namespace {

using namespace envmap;

struct Request {
  SceneOptions scene;
  std::string output, forward;
  std::vector<std::string> at;
  std::optional<Projection> to;
  Viewpoint from;
  GridRequest grid;
  DrawMethod method = DrawMethod::automatic;
  std::optional<int> size;
  int bounces = 0, lobe_samples = 0;
  std::optional<TextureFilter> texture_filter;
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
  void move(const SceneGraph& scene, const std::vector<int>& moved) {
    for (const int mesh : moved) renderer_.update(scene, mesh);
    moved_ = !moved.empty();
  }

  [[nodiscard]] Drawn paint(FrameState shot, const Viewpoint& from, DrawMethod method) {
    if (options_.bounces > 0) {
      const Viewer viewer{.at = from.at, .node = from.without, .pixel = 0.5 * pi / from.size};
      tell(mirrors_.update(renderer_, shot, {viewer},
                           {.bounces = options_.bounces, .moved = moved_, .near = from.near, .far = from.far}),
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
  bool moved_ = false;
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

// A map of each frame to draw: where from, and the name of its files.
struct Place {
  std::string name;  // As --at has it; empty without --at.
  Viewpoint from;
  std::string output;
};

std::vector<Place> places_of(const Request& o, const std::vector<std::string>& files, const SceneGraph& scene) {
  std::vector<Place> places;
  for (std::size_t k = 0; k < files.size(); ++k) {
    Place& place = places.emplace_back(Place{o.at.empty() ? "" : o.at[k], o.from, files[k]});
    const Viewpoint from = viewpoint_of(place.name, scene, o.scene.path);
    place.from.at = from.at, place.from.without = from.without;
  }
  return places;
}

void write_drawn(const std::string& path, const Drawn& drawn, const Direction& at, const Request& o) {
  if (o.distance)
    write_distances(path, drawn.radiance, drawn.distances, at, o.write);
  else
    write_map(path, all_rows_of(drawn.radiance), o.write, "write");
}

// From where the map is drawn to a node, or to the scene's first camera; or what is said.
Direction direction(const Request& o, const Direction& from, const SceneGraph& scene, const Pose& pose) {
  if (const auto along = triple_of(o.forward)) return *along;
  if (const auto there = direction_to(scene, pose, from, o.forward)) return *there;
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
  if (o.texture_filter && o.method != DrawMethod::raycast)
    throw UsageError("--texture-filter is for --method raycast: OpenGL filters textures trilinearly");
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
// rays take for a map, so only several maps look for one. Where nothing moves, shadow maps are drawn once.
// @param places of each frame.
DrawMethod method_for(const Request& o, const Frames& frames, std::size_t places, const LoadedScene& loaded) {
  if (o.distance) return method_with_distances(o);
  const bool rays = o.scene.context == ContextKind::automatic;
  const bool card = frames.count() * places > 1 && o.scene.context != ContextKind::osmesa && finds_graphics_card();
  DrawLoad load = draw_load(loaded.shot(frames.time(frames.first), o.scene));
  load.shadow_texels /= places;
  if (loaded.scene.animations.empty()) load.shadow_texels /= std::size_t(frames.count());
  return cheapest(o.from.to, o.from.size, load, rays, card);
}

Drawn cast(const Request& o, const FrameState& shot, const Viewpoint& from, const std::vector<Mirror>& mirrors,
           const Progress& progress) {
  const RayPaths paths{.mirrors = nodes_of(mirrors),
                       .bounces = o.bounces,
                       .far = from.far,
                       .lobe_samples = o.lobe_samples,
                       .texture_filter = o.texture_filter.value_or(TextureFilter::bilinear)};
  return raycast(shot, from, paths, progress);
}

struct RenderedFile {
  std::string path, place;
  double seconds;
  double missing_solid_angle;
};

void put(Report& report, const RenderedFile& file) {
  report.append("maps[]");
  report.put("maps[].output", file.path);
  if (!file.place.empty()) report.put("maps[].at", file.place);
  report.put("maps[].seconds", file.seconds);
  report.put("maps[].missing_solid_angle", file.missing_solid_angle);
}

// With -v, how the map was drawn. @param turned whether --forward turns it.
void tell(const RenderedFile& file, const Viewpoint& from, DrawMethod method, bool turned) {
  if (turned)
    note(fmt::format("{}: its +Z looks along {:.4g},{:.4g},{:.4g} of the scene, its +Y up", file.path, from.axes[2].x,
                     from.axes[2].y, from.axes[2].z));
  if (settings().verbose)
    note(fmt::format("{}: {} from {:.4g},{:.4g},{:.4g}, drawn in {:.1f} ms", file.path,
                     draw_method_names[std::size_t(method)], from.at.x, from.at.y, from.at.z, 1e3 * file.seconds));
}

// The files of all frames and places, in the order in which they are written.
std::vector<std::string> all_files(const Frames& frames, const std::vector<std::string>& names) {
  std::vector<std::string> all;
  for (int frame = frames.first; frame <= frames.last; ++frame)
    for (const std::string& name : names) all.push_back(frames.path(name, frame));
  return all;
}

int run(Request& o, Report& report) {
  if (!o.grid.cells.empty()) {
    o.grid.size = o.size, o.grid.far = o.from.far;
    return write_grid(o.scene, o.grid, o.output, report);
  }
  o.from.size = o.size.value_or(256);
  o.from.to = o.to.value_or(Projection::cube);
  const Forward forward = forward_named(o.forward).value_or(Forward::plus_z);
  o.from.axes = image_to_world(forward);
  check(o);
  const Frames frames = frames_of(o.scene);
  const std::vector<std::string> names = place_files(o.output, o.at), outputs = all_files(frames, names);
  check_output(outputs.front(), o.write, o.from.to);
  if (o.distance) check_distances(outputs.front(), o.write);
  const FaceNames faces{.written = o.write.faces, .read = {}};
  check_files(outputs, {o.scene.path, o.scene.environment}, faces);  // Before reading takes its time.
  LoadedScene loaded = load(o.scene);
  check_files(outputs, loaded.inputs, faces);
  open_depfile();
  std::vector<Place> places = places_of(o, names, loaded.scene);
  const bool turned = !o.forward.empty() && !forward_named(o.forward);
  const DrawMethod method = o.method == DrawMethod::automatic ? method_for(o, frames, places.size(), loaded) : o.method;
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
    const Progress of_frame = frames.part(progress, frame);
    if (painter) painter->move(loaded.scene, moved);
    for (std::size_t k = 0; k < places.size(); ++k) {
      Viewpoint& from = places[k].from;
      if (from.without >= 0) from.at = centre_of(loaded.scene, shot.pose, from.without);
      if (turned) from.axes = turned_to(direction(o, from.at, loaded.scene, shot.pose));
      const Progress of_map = part_progress(of_frame, double(k) / double(places.size()), 1 / double(places.size()));
      const Stopwatch watch;
      Drawn drawn = painter ? painter->paint(shot, from, method) : cast(o, shot, from, mirrors, of_map);
      if (of_map) of_map(1);
      const RenderedFile file{frames.path(places[k].output, frame), places[k].name, watch.seconds(),
                              drawn.missing_solid_angle};
      seconds += file.seconds;
      drawn.radiance.forward = forward;
      tell(file, from, method, turned);
      write_drawn(file.path, drawn, from.at, o);
      warn_about_missing(file.path, method, drawn);
      if (black.empty() && is_black(drawn.radiance.base())) black = file.path;
      put(report, file);
    }
  }
  tell_blackness(black, loaded, o);
  tell_rate(frames, seconds);
  return 0;
}

}  // namespace

Action define_render(Options& o) {
  const auto r = std::make_shared<Request>();
  add_scene(o, r->scene);
  o.writes("OUTPUT", r->output,
           "File to write, or '-' for stdout ({face}: six files, {frame}: one per frame, {at}: one per place)")
      .required = true;
  o.group = groups::output_map;
  o.add("--at", "NODE|X,Y,Z", &r->at,
        "Centre of the map: a node ('envmap info SCENE' lists them) or a point; repeatable (default: 0,0,0)")
      .several = Several::repeated;
  add_projection(o, "--to PROJECTION", r->to, "{} (default: cube)");
  add_size(o, &r->size, "Height of the image or of one cube face (default: 256; with --grid 16)");
  o.add("--forward", "AXIS|NODE|X,Y,Z|camera", &r->forward, "Axis, node, direction or camera at the centre");
  o.add("--near", "METRES", &r->from.near, {1e-9, 1e9}, "Distance of the near plane (default: 0.01)");
  o.add("--far", "METRES", &r->from.far, {1e-9, 1e12}, "Distance of the far plane (default: 1000)");
  add_layout(o, "--layout", r->write.layout, "Cube faces: {} (default: column)");
  add_faces(o, r->write);
  add_light(o, r->scene);
  add_context(o, r->scene);
  o.add("--method", one_of(r->method, draw_method_names), "{} (default: auto)");
  o.add("--samples", "N", &r->from.samples, {1, 1024}, "Rays per texel (default: 1)");
  o.add("--bounces", "N", &r->bounces, {0, 64}, "Reflections between mirrors (default: 0, of the environment only)");
  o.add("--lobe-samples", "N", &r->lobe_samples, {0, 65536},
        "raycast: samples per rough reflection (default: 0, prefiltered levels)");
  add_texture_filter(o, r->texture_filter);
  o.add("--epsilon", "Z", &r->from.epsilon, {1e-6, 1},
        "distort, tessellate: move vertices with z < -1 + Z to infinity");
  o.flag("--distance", r->distance, "exact, raycast: write distances to channel Z of the EXR file");
  add_frames(o, r->scene);
  add_write_options(o, r->write, "float, or nearest");
  add_scene_input(o, r->scene);
  add_grid(o, r->grid);
  return [r](Report& report) { return run(*r, report); };
}

}  // namespace tools

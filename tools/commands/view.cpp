#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <ranges>
#include <set>
#include <span>

#include "command.h"
#include "envmap/base/error.h"
#include "envmap/base/part_progress.h"
#include "envmap/base/words.h"
#include "envmap/io/images/picture.h"
#include "envmap/io/write_distances.h"
#include "envmap/maths/portable.h"
#include "envmap/scenes/choose_maps.h"
#include "envmap/scenes/choose_mirrors.h"
#include "envmap/scenes/mirror_painter.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "envmap/scenes/viewpoints.h"
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
  ViewpointOptions from;
  std::string camera, output, format, saved;
  std::vector<std::string> mirrors;
  ViewMethod method = ViewMethod::maps;
  std::optional<Projection> maps;
  int width = 640, height = 480, samples = 4, lobe_samples = 0;
  double exposure = 0;
  std::optional<Display> display;
  std::optional<double> anaglyph, side_by_side;  // Metres from eye to eye.
  std::string map_format = "exr";
  std::optional<MirrorLookup> lookup;
  std::optional<TextureFilter> texture_filter;
  MirrorLook look;
  MirrorOptions drawing;
  std::optional<double> max_error;
  bool distance = false;  // A channel Z in saved maps.
};

// Red of the left eye, green and blue of the right: for red and cyan glasses.
std::vector<Colour> anaglyph(std::vector<Colour> left, const std::vector<Colour>& right) {
  for (std::size_t k = 0; k < left.size(); ++k) left[k] = {left[k].x, right[k].y, right[k].z};
  return left;
}

// The left eye's picture left of the right one's.
std::vector<Colour> side_by_side(const std::vector<Colour>& left, const std::vector<Colour>& right, int width) {
  std::vector<Colour> both;
  for (std::size_t row = 0; row < left.size(); row += std::size_t(width))
    for (const std::vector<Colour>* eye : {&left, &right}) {
      const auto pixels = std::span(*eye).subspan(row, std::size_t(width));
      both.insert(both.end(), pixels.begin(), pixels.end());
    }
  return both;
}

std::optional<double> eye_distance(const Request& o) { return o.anaglyph ? o.anaglyph : o.side_by_side; }

constexpr std::string_view eye_mark = "{eye}", eyes_of_files[] = {"left", "right", "both"};
bool is_by_eye(const std::string& path) { return path.find(eye_mark) != std::string::npos; }

// The files of a frame: one, or with {eye} in its name one an eye and the picture of both.
std::vector<std::string> eye_files(const std::string& path) {
  if (!is_by_eye(path)) return {path};
  std::vector<std::string> files;
  for (const std::string_view eye : eyes_of_files)
    files.push_back(std::string(path).replace(path.find(eye_mark), eye_mark.size(), eye));
  return files;
}

// Pictures of a moment, one for each eye.
using Pictures = std::vector<std::vector<Colour>>;

// @param moved meshes whose vertices are others than in the last shot. @param first whether no frame was drawn yet.
RenderedFrames paint(const Request& o, MirrorPainter& painter, FrameState shot, const std::vector<int>& moved,
                     const std::vector<Eye>& eyes, bool first) {
  MirrorOptions drawing = o.drawing;
  if (!drawing.bounces && !first && !o.max_error) drawing.bounces = 1;
  shot.look = o.look;
  shot.look.lookup = o.lookup.value_or(shot.look.lookup);
  shot.look.pictures = o.drawing.bounces.value_or(shot.look.pictures);
  return painter.paint(std::move(shot), moved, eyes, drawing);
}

// A mirror that nobody saw has no file.
void save(const MirrorPainter& painter, const Request& o, const std::vector<std::string>& paths) {
  const std::vector<PaintedMap> maps = painter.maps();
  std::error_code error;
  std::filesystem::create_directories(o.saved, error);
  if (error) throw OutputError(o.saved, error.message());
  for (std::size_t k = 0; k < maps.size(); ++k) {
    const EnvironmentMap& radiance = maps[k].radiance;
    if (radiance.levels.empty()) continue;
    if (o.distance)
      write_distances(paths[k], radiance, maps[k].distances, maps[k].at, {});
    else
      write_map(paths[k], all_rows_of(radiance), {}, "write");
  }
}

// Of all frames.
std::vector<std::string> all_maps(const std::vector<std::string>& maps, const Frames& frames) {
  if (!frames.sequence || maps.empty()) return maps;
  std::vector<std::string> all;
  for (int frame = frames.first; frame <= frames.last; ++frame)
    std::ranges::copy(numbered(maps, frame), std::back_inserter(all));
  return all;
}

Pictures cast(const Request& o, const std::vector<int>& mirrors, const FrameState& shot, const std::vector<Eye>& eyes,
              const Progress& progress) {
  Pictures pictures;
  const double part = 1.0 / double(eyes.size());
  for (const Eye& eye : eyes)
    pictures.push_back(raycast_picture(shot, eye.from,
                                       {mirrors, o.drawing.bounces.value_or(max_rounds), o.drawing.far, o.lobe_samples,
                                        o.texture_filter.value_or(TextureFilter::bilinear)},
                                       part_progress(progress, part * double(pictures.size()), part)));
  return pictures;
}

void check(const Request& o) {
  if (o.drawing.near >= o.drawing.far) throw UsageError("--near must be less than --far");
  if (o.method == ViewMethod::raycast) check_no_context(o.scene);
  const bool of_maps = o.maps || o.drawing.size > 0 || o.drawing.largest != MirrorOptions{}.largest || o.drawing.all ||
                       o.lookup || o.look.tinted || !o.saved.empty() ||
                       std::ranges::any_of(o.mirrors, [](const std::string& m) {
                         return m.find(':') != m.npos && !m.ends_with(":off");
                       });
  if (o.method == ViewMethod::raycast && of_maps)
    throw UsageError(
        "--method raycast draws no maps: remove --maps, --size, --max-size, --lookup, --show-maps, --save-maps, --all "
        "and NODE:MAP");
  if (o.lobe_samples > 0 && o.method != ViewMethod::raycast && !o.max_error)
    throw UsageError("--lobe-samples is for --method raycast and for --max-error");
  if (o.texture_filter && o.method != ViewMethod::raycast)
    throw UsageError("--texture-filter is for --method raycast: OpenGL filters textures trilinearly");
  if (o.lobe_samples > 0 && !o.max_error && o.scene.reflection != Reflection::split_sum)
    throw UsageError("--lobe-samples integrates what --reflection samples: remove one of them");
  if (o.max_error && (of_maps || o.method == ViewMethod::raycast || o.drawing.bounces))
    throw UsageError(
        "--max-error chooses how mirrors are drawn: remove --method, --maps, --size, --max-size, --lookup, --bounces, "
        "--show-maps, --save-maps, "
        "--all and NODE:MAP");
  if (o.anaglyph && o.side_by_side) throw UsageError("--anaglyph and --side-by-side exclude each other");
  if (is_by_eye(o.output) && !eye_distance(o))
    throw UsageError(o.output, "{eye} in a name goes with --anaglyph and --side-by-side");
}

// What is drawn of a frame.
struct Scenery {
  const Request& o;
  LoadedScene& loaded;
  const Viewpoints& viewpoints;
  const Frames& frames;

  [[nodiscard]] FrameState shot(int frame) const { return loaded.shot(frames.time(frame), o.scene); }
  // One, or two of a stereo picture.
  [[nodiscard]] std::vector<Eye> eyes(int frame, const Pose& pose) const {
    const View view = viewpoints.view(pose, double(frame - frames.first) / frames.count());
    const double separation = eye_distance(o).value_or(0);
    std::vector<Eye> eyes;
    for (const double aside : separation > 0 ? std::vector{-0.5 * separation, 0.5 * separation} : std::vector{0.0})
      eyes.push_back(eye_of({o.width, o.height, o.samples, !o.drawing.all}, view, aside, 30 * separation));
    return eyes;
  }
};

// For --max-error: tries maps in the first frame, the middle one and the last.
void choose(Request& o, const Scenery& scenery, const std::vector<Mirror>& mirrors,
            std::optional<MirrorPainter>& painter) {
  if (mirrors.empty() && o.lobe_samples == 0) return;
  const int first = scenery.frames.first, last = scenery.frames.last;
  std::vector<Moment> moments;
  for (const int frame : std::set{first, first + (last - first) / 2, last}) {
    const FrameState shot = scenery.shot(frame);
    moments.push_back({shot, scenery.eyes(frame, shot.pose)[0], [&scenery, &painter, frame] {
                         for (const int mesh : scenery.loaded.move_to(scenery.frames.time(frame)))
                           painter->renderer().update(scenery.loaded.scene, mesh);
                       }});
  }
  const MapChoice choice =
      choose_maps(painter->renderer(), mirrors, std::move(moments), o.drawing, *o.max_error, o.lobe_samples);
  if (choice.rays) {
    note(fmt::format("the picture is drawn by rays: OpenGL is off by {:.2g} of the picture (rms), more than {:g}",
                     choice.error, *o.max_error));
    o.method = ViewMethod::raycast;
    painter.reset();
    return;
  }
  if (mirrors.empty()) return note(fmt::format("off by {:.2g} of the picture (rms) against rays", choice.error));
  note(fmt::format("mirrors by --lookup {} --max-size {}{}: off by {:.2g} of the picture (rms) against rays",
                   mirror_lookup_names[std::size_t(choice.lookup)], choice.drawing.largest,
                   choice.drawing.bounces ? fmt::format(" --bounces {}", *choice.drawing.bounces) : "", choice.error));
  o.lookup = choice.lookup, o.drawing = choice.drawing;
}

void put(Report& report, const Request& o, int frames, const std::vector<std::string>& outputs) {
  report.put("outputs", outputs);
  report.put("method", view_method_names[std::size_t(o.method)]);
  report.put("width", o.width);
  report.put("height", o.height);
  report.put("frames", frames);
  if (o.method == ViewMethod::maps)
    report.put("lookup", mirror_lookup_names[std::size_t(o.lookup.value_or(o.look.lookup))]);
}

// The files of --save-maps. Their folder may be made later, so only their names are checked.
std::vector<std::string> map_paths(const Request& o, const SceneGraph& scene, const std::vector<Mirror>& mirrors) {
  if (o.saved.empty()) return {};
  std::vector<std::string> paths = map_files(o.saved, scene, nodes_of(mirrors), o.map_format);
  for (std::size_t k = 0; k < paths.size(); ++k) {
    const std::string name = std::filesystem::path(paths[k]).filename().string();
    o.distance ? check_distances(name, {}) : check_output(name, {}, mirrors[k].to);
  }
  return paths;
}

int run(Request& o, Report& report) {
  check(o);
  const Frames frames = frames_of(o.scene);
  const PictureOptions how{o.format, o.display.value_or(Display::clip), settings().commit};
  if (!is_picture(frames.path(o.output, frames.first), how))
    throw UsageError(o.output, "the picture must be a .png, .jpg, .exr or .hdr");
  if (o.display && is_linear_picture(frames.path(o.output, frames.first), how))
    throw UsageError(o.output, "holds radiance as it is: remove --display");
  std::vector<std::string> outputs;
  for (const std::string& path : frames.paths(o.output))
    std::ranges::copy(eye_files(path), std::back_inserter(outputs));
  check_files(outputs, {o.scene.path, o.scene.environment});  // Before reading takes its time.
  LoadedScene loaded = load(o.scene);
  const SceneGraph& scene = loaded.scene;
  o.from.camera = camera_of(o.camera);
  const Viewpoints viewpoints(o.from, double(o.width) / o.height, scene, o.scene.path,
                              pose(scene, frames.time(frames.first)));
  std::vector<MirrorWish> wishes;
  for (const std::string& text : o.mirrors) wishes.push_back(mirror_wish(scene, text));
  const std::vector<Mirror> mirrors = choose_mirrors(scene, wishes, o.maps.value_or(Projection::paraboloid));
  if (mirrors.empty() && (!o.saved.empty() || o.look.tinted))
    warn(fmt::format("{}: has no mirrors for {}: choose nodes with --mirror", o.scene.path,
                     o.saved.empty() ? "--show-maps" : "--save-maps"));
  const std::vector<int> nodes = nodes_of(mirrors);
  const std::vector<std::string> maps = map_paths(o, scene, mirrors);
  check_files(outputs, loaded.inputs, {}, all_maps(maps, frames));  // Mirrors that nobody sees have no map.
  open_depfile();
  std::optional<Context> context;
  std::optional<MirrorPainter> painter;
  if (o.method == ViewMethod::maps) {
    context.emplace(o.scene.context);
    tell_renderer(*context);
    painter.emplace(loaded, mirrors);
  }
  if (viewpoints.is_framed()) note(fmt::format("{}: has no camera; all of it is in sight", o.scene.path));
  const Scenery scenery{o, loaded, viewpoints, frames};
  if (o.max_error) choose(o, scenery, mirrors, painter);
  MirrorTable table(scene, mirrors);
  const Progress progress = progress_line("view");
  const auto gain = float(portable::exp2(o.exposure));
  double seconds = 0;
  for (int frame = frames.first; frame <= frames.last; ++frame) {
    const std::vector<int> moved = loaded.move_to(frames.time(frame));
    const FrameState shot = scenery.shot(frame);
    const std::vector<Eye> eyes = scenery.eyes(frame, shot.pose);
    const Stopwatch watch;
    const Progress of_frame = frames.part(progress, frame);
    Pictures pictures;
    if (painter) {
      RenderedFrames painted = paint(o, *painter, shot, moved, eyes, frame == frames.first);
      tell(painted.updates, scene, mirrors);
      table.add(painted.updates);
      pictures = std::move(painted.pictures);
    } else {
      pictures = cast(o, nodes, shot, eyes, of_frame);
    }
    if (of_frame) of_frame(1);
    seconds += watch.seconds();
    if (!maps.empty()) save(*painter, o, frames.sequence ? numbered(maps, frame) : maps);
    if (eye_distance(o))
      pictures.push_back(o.anaglyph ? anaglyph(pictures[0], pictures[1])
                                    : side_by_side(pictures[0], pictures[1], o.width));
    const std::vector<std::string> files = eye_files(frames.path(o.output, frame));
    if (files.size() < pictures.size()) pictures.erase(pictures.begin(), pictures.end() - 1);
    for (std::size_t k = 0; k < files.size(); ++k) {
      for (Colour& c : pictures[k]) c *= gain;
      write_picture(files[k], int(pictures[k].size() / std::size_t(o.height)), pictures[k], how);
    }
  }
  tell_darkness(loaded, o.scene);
  tell_rate(frames, seconds);
  put(report, o, frames.count(), outputs);
  if (o.method == ViewMethod::maps) table.put(report);
  report.put("drawing_seconds", seconds);
  report.put_seconds();
  return 0;
}

}  // namespace

Action define_view(Options& o) {
  const auto r = std::make_shared<Request>();
  add_scene(o, r->scene);
  o.writes("OUTPUT", r->output, "Picture: .png .jpg .exr .hdr, or '-' for stdout ({frame}: one per frame)").required =
      true;
  o.group = "Camera";
  o.add("--camera", "NAME|X,Y,Z", &r->camera,
        "Camera ('envmap info SCENE' lists them) or a point (default: the first, or one for all)");
  o.add("--look-at", "X,Y,Z", Triple{&r->from.look_at},
        "Point at the centre (default: the camera's, or the scene's middle)");
  o.add("--fov", "DEGREES", &r->from.vertical_field_degrees, {0.01, 179},
        "Vertical field of view (default: the camera's, or 40)");
  o.add("--orbit", "DEGREES", &r->from.orbit_degrees, {-36000, 36000},
        "Orbit the camera by this angle during --frames (default: 0)");
  o.group = "Picture";
  o.add("--width", "N", &r->width, {1, 16384}, "Width in pixels (default: 640)");
  o.add("--height", "N", &r->height, {1, 16384}, "Height in pixels (default: 480)");
  o.add("--samples", "N", &r->samples, {1, 1024}, "Rays per pixel (default: 4)");
  o.add("--exposure", "STOPS", &r->exposure, {-100, 100}, "Multiply radiance by 2^STOPS (default: 0)");
  add_display(o, r->display, Display::clip);
  o.add("--anaglyph", "METRES", &r->anaglyph, {1e-9, 1e9},
        "Red-cyan stereo picture with this eye distance ({eye}: three files)");
  o.add("--side-by-side", "METRES", &r->side_by_side, {1e-9, 1e9},
        "Stereo picture of double width, the left eye's view left ({eye}: three files)");
  o.add("--format", "EXT", &r->format, "File type for '-' or a name without extension (default: png)");
  add_light(o, r->scene);
  o.group = "Mirrors";
  o.add("--method", one_of(r->method, view_method_names), "How mirrors are drawn: {}, the reference (default: maps)");
  o.add(
      "--maps PROJECTION", joined(map_names, "|"),
      [&maps = r->maps](const std::string& word) {
        if (index_of(word, map_names) >= 0) maps = projection_named(word);
        return index_of(word, map_names) >= 0;
      },
      "Projection of mirror maps: {} (default: paraboloid)");
  o.add("--size", "N", &r->drawing.size, {4, 8192},
        "Height of a mirror's map or cube face (default: as the picture needs)");
  o.add("--max-size", "N", &r->drawing.largest, {4, 8192}, "Upper limit of the automatic size (default: 1024)");
  o.add("--mirror", "NODE[:HOW]", &r->mirrors, "Draw a node as a mirror (HOW: sphere paraboloid cube off), repeatable")
      .several = Several::repeated;
  o.add("--bounces", "N", &r->drawing.bounces, {1, 64},
        "Reflections between mirrors per frame (default: first all, then 1)");
  o.add("--reflection", one_of(r->scene.reflection, reflection_names),
        "Reflections of the environment on rough surfaces: {} (default: split-sum)");
  o.add("--lobe-samples", "N", &r->lobe_samples, {0, 65536},
        "raycast, --max-error: samples per rough reflection (default: 0, prefiltered levels)");
  add_texture_filter(o, r->texture_filter);
  o.add("--lookup", one_of(r->lookup, mirror_lookup_names), "How maps are looked up: {} (default: distance)");
  o.add("--max-error", "E", &r->max_error, {1e-6, 10},
        "Use the smallest maps whose picture is within rms E of ray casting");
  o.add("--near", "METRES", &r->drawing.near, {1e-9, 1e9}, "Distance of the near plane of maps (default: 0.01)");
  o.add("--far", "METRES", &r->drawing.far, {1e-9, 1e12}, "Distance of the far plane of maps (default: 1000)");
  o.flag("--all", r->drawing.all, "Draw every part of every map, needed or not");
  o.flag("--show-maps", r->look.tinted, "Tint reflections by the face of the map that they come from");
  o.add("--save-maps", "FOLDER", &r->saved,
        "Write the map of each mirror into this folder (made if missing) as NODE.exr");
  o.add("--map-format", "EXT", &r->map_format, "--save-maps: file type of the maps (default: exr)");
  o.flag("--distance", r->distance, "--save-maps: write distances to channel Z of the EXR files");
  add_context(o, r->scene);
  add_frames(o, r->scene);
  o.need("--environment", {"--reflection"});
  o.need("--frames", {"--orbit"});
  o.need("--save-maps", {"--distance", "--map-format"});
  add_scene_input(o, r->scene);
  return [r](Report& report) { return run(*r, report); };
}

}  // namespace tools

#include "scenes/scene_options.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/console.h"
#include "envmap/base/error.h"
#include "envmap/io/files/scene_folder.h"
#include "envmap/operate/check_options.h"
#include "envmap/scenes/read/read_scene.h"
#include "envmap/scenes/scene/own_light.h"
#include "maps/map_facts.h"
#include "maps/map_options.h"
#include "maps/read_and_write_maps.h"

namespace tools {

using namespace envmap;

void add_scene(Options& o, SceneOptions& s) {
  o.reads("SCENE", s.path, "Scene to read: .gltf, .glb or .obj, '-' for stdin").required = true;
}

void add_light(Options& o, SceneOptions& s) {
  o.group = groups::light;
  o.add("--environment", "FILE", &s.environment, "Environment map for background and lighting").file = File::input;
  o.add("--ambient", "R,G,B", Triple{&s.ambient, true},
        "Uniform radiance from all directions, without occlusion (default: 0)");
  o.flag("--no-shadows", s.no_shadows, "Draw point, spot and directional lights without shadows");
  o.add("--occlusion", "N", &s.occlusion, {0, max_distant_lights},
        "Lights that approximate the environment's shadows, 0 for none (default: 64)")
      .needs = "--environment";
  o.flag("--suns", s.suns, "Make the environment's suns lights that cast shadows, in place of their texels").needs =
      "--environment";
}

void add_frames(Options& o, SceneOptions& s) {
  o.group = "Animation";
  o.add("--time", "T", &s.time, {-1e6, 1e6}, "Time of the animation in seconds (default: 0)");
  o.add("--frames", "A:B", &s.frames, "Draw frames A to B, one file each (put {frame} or %04d into OUTPUT)");
  o.add("--fps", "F", &s.rate, {1e-3, 1e6}, "Frames per second (default: 24)").needs = "--frames";
}

void add_context(Options& o, SceneOptions& s) {
  o.group = "Drawing";
  o.add("--context", one_of(s.context, context_names), "OpenGL renderer: {} (default: auto)");
}

void add_texture_filter(Options& o, std::optional<TextureFilter>& filter) {
  o.add("--texture-filter", one_of(filter, texture_filter_names),
        "raycast: filter of textures: {} (default: bilinear)");
}

void add_allow_missing(Options& o, std::optional<bool>& allow_missing) {
  allow_missing = false;
  o.add(
      "--allow-missing", "", [&allow_missing](const std::string&) { return allow_missing = true, true; },
      "Draw surfaces whose texture file is missing without it");
}

void add_scene_input(Options& o, SceneOptions& s) {
  o.group = groups::input_map;
  add_allow_missing(o, s.allow_missing);
  add_max_pixels(o, s.read);
  add_repair(o, s.read);
}

void check_no_context(const SceneOptions& o) {
  if (o.context != ContextKind::automatic)
    throw UsageError("--context is for OpenGL, which --method raycast does not use: remove one of them");
}

namespace {

// What stands for a frame in a name: {frame}, of four digits at least, %d, or %04d of so many.
struct FrameMark {
  std::size_t begin, end;
  int digits;
};

std::optional<FrameMark> frame_mark(const std::string& name, std::size_t from = 0) {
  constexpr std::string_view mark = "{frame}";
  const auto digit_at = [&](std::size_t at) { return at < name.size() && name[at] >= '0' && name[at] <= '9'; };
  for (std::size_t begin = from; begin < name.size(); ++begin) {
    if (name.compare(begin, mark.size(), mark) == 0) return FrameMark{begin, begin + mark.size(), 4};
    if (name[begin] != '%') continue;
    std::size_t end = begin + 1;
    if (end < name.size() && name[end] == '0') ++end;
    const int digits = digit_at(end) ? name[end++] - '0' : 1;
    if (end < name.size() && name[end] == 'd') return FrameMark{begin, end + 1, digits};
  }
  return {};
}

}  // namespace

void tell_renderer(const Context& context) {
  if (!context.passed_over().empty()) note(fmt::format("the graphics card does not draw: {}", context.passed_over()));
  if (settings().verbose) note(context.renderer());
}

bool is_numbered(const std::string& output) {
  const auto folder = output.rfind('/') + 1;  // 0 where there is none.
  for (auto mark = frame_mark(output, folder); mark; mark = frame_mark(output, mark->end))
    if (output[mark->begin] == '{' || output[mark->begin + 1] == '0') return true;
  return false;
}

std::string Frames::path(const std::string& output, int frame) const {
  if (!sequence && is_numbered(output)) throw UsageError(output, "{frame} or %04d in a name goes with --frames");
  if (!sequence) return output;
  const auto mark = frame_mark(output);
  if (!mark) throw UsageError(fmt::format("{}: the name must contain {{frame}} or %04d for --frames", output));
  return output.substr(0, mark->begin) + fmt::format("{:0{}}", frame, mark->digits) + output.substr(mark->end);
}

std::vector<std::string> Frames::paths(const std::string& output) const {
  std::vector<std::string> all;
  for (int frame = first; frame <= last; ++frame) all.push_back(path(output, frame));
  return all;
}

Frames frames_of(const SceneOptions& o) {
  constexpr int most_frames = 1'000'000;
  if (o.frames.empty()) return {.start = o.time};
  const std::vector<std::string> ends = split(o.frames, ':');
  const auto is_number = [](const std::string& s) {
    return !s.empty() && s.size() <= 9 && s.find_first_not_of("0123456789") == s.npos;
  };
  if (ends.size() != 2 || !std::ranges::all_of(ends, is_number) || std::stoi(ends[0]) > std::stoi(ends[1]))
    throw UsageError(fmt::format("--frames: '{}' is not A:B with A <= B", o.frames));
  const Frames frames{std::stoi(ends[0]), std::stoi(ends[1]), true, o.time, o.rate};
  if (frames.count() > most_frames)
    throw UsageError(
        fmt::format("--frames: '{}' has more than {} frames: draw them in several runs", o.frames, most_frames));
  return frames;
}

namespace {

std::optional<Colour> ambient_of(const SceneOptions& o) {
  if (!o.ambient) return {};
  const Colour ambient(*o.ambient);
  check_not_negative("--ambient", Flux(ambient));
  return ambient;
}

}  // namespace

FrameState LoadedScene::shot(double time, const SceneOptions& o) const {
  return LitScene::shot(time, ambient_of(o), !o.no_shadows);
}

SceneGraph read_scene(const std::string& path, const ReadOptions& read, std::optional<bool> allow_missing) {
  try {
    return envmap::read_scene(path, read.max_pixels, allow_missing.value_or(false));
  } catch (const MissingFile& e) {
    throw InputError(std::string(e.what()) + (allow_missing ? ", or use --allow-missing" : ""));
  }
}

namespace {

// With -v, the lights that were found.
FoundLights suns_of(const EnvironmentMap& map, const SceneOptions& o) {
  if (!o.suns) return {};
  FoundLights suns = find_lights(map, {}, {.progress = progress_line("suns")});
  if (suns.lights.empty())
    warn(fmt::format("{}: no light for --suns: texels light everything ('envmap lights' tells more)", o.environment));
  if (!settings().verbose) return suns;
  for (const DiscLight& sun : suns.lights) {
    const auto [azimuth, elevation] = tools::angles_of(sun.towards);
    note(fmt::format("sun at azimuth {:.3f}, elevation {:.3f}: radius {}{:.4f} degrees, {:.2g}% of the light", azimuth,
                     elevation, sun.radius_is_bound ? "<" : "", sun.radius_degrees, 100 * sun.share));
  }
  return suns;
}

// Lights of glTF are in lux and candela: beside a map whose radiance 1 is not one cd/m^2 they would be too bright.
void match_unit(SceneGraph& scene, const SceneOptions& o, const Source& map) {
  const double white = map.provenance.white_luminance.value_or(1.0F);
  if (white == 1 || !has_light(scene)) return;
  divide_own_light(scene, white);
  note(fmt::format("{}: radiance 1 is {:g} cd/m^2: lights of the scene are divided by that", o.environment, white));
}

}  // namespace

LoadedScene load(const SceneOptions& o) {
  LoadedScene loaded{{.scene = read_scene(o.path, o.read, o.allow_missing)}};
  loaded.move_to(frames_of(o).time(frames_of(o).first));
  const SceneGraph& scene = loaded.scene;
  loaded.inputs = scene.files;
  for (const std::string& remark : remarks_on(scene)) warn(fmt::format("{}: {}", o.path, remark));
  if (settings().verbose)
    note(fmt::format("{}: {} triangles in {} meshes, {} materials, {} lights", o.path, triangles(scene),
                     instances(scene).size(), scene.materials.size(), scene.lights.size()));
  if (o.environment.empty()) return loaded;
  loaded.inputs.push_back(o.environment);
  Source map = read_map(o.environment, o.read);
  match_unit(loaded.scene, o, map);
  FoundLights suns = suns_of(map.map, o);
  loaded.light_by(PreparedEnvironment(std::move(map.map), {}, std::move(suns)), o.occlusion, o.reflection,
                  progress_line("light of the environment"));
  return loaded;
}

std::string nodes_in_words(const SceneGraph& scene) { return list_nodes(scene) + " ('envmap info SCENE' lists all)"; }

Viewpoint viewpoint_of(const std::string& at, const SceneGraph& scene, const std::string& path) {
  Viewpoint from;
  if (at.empty()) return from;
  if (const auto node = find_node(scene, at)) {
    from.without = *node;
  } else if (const auto place = triple_of(at)) {
    from.at = *place;
  } else {
    throw UsageError(
        fmt::format("--at: '{}' is neither a node of {} nor a point X,Y,Z: {}", at, path, nodes_in_words(scene)));
  }
  return from;
}

std::optional<std::variant<Direction, std::string>> camera_of(const std::string& text) {
  if (text.empty()) return {};
  if (const auto point = triple_of(text)) return *point;
  return text;
}

bool tell_darkness(const LoadedScene& loaded, const SceneOptions& o) {
  const bool dark = loaded.is_dark(ambient_of(o));
  if (dark) warn(fmt::format("{}: the scene has no light and is black: use --environment MAP or --ambient 1", o.path));
  return dark;
}

void tell_rate(const Frames& frames, double seconds) {
  if (!settings().verbose) return;
  note(fmt::format("{} frame{}, {:.1f} a second without writing", frames.count(), frames.count() == 1 ? "" : "s",
                   frames.count() / seconds));
}

}  // namespace tools

#include <fmt/format.h>

#include "command.h"
#include "costs_file.h"
#include "depfile.h"
#include "envmap/base/error.h"
#include "envmap/render/choose.h"
#include "envmap/render/mirrors.h"
#include "envmap/render/raycast.h"
#include "envmap/render/renderer.h"
#include "envmap/render/turn.h"
#include "scene_options.h"

namespace tools {
namespace {

using namespace envmap;
struct Options {
  SceneOptions scene;
  std::string output, at, forward, costs;
  std::optional<Projection> to;
  Viewpoint from;
  DrawMethod method = DrawMethod::automatic;
  int bounces = 0;
  WriteOptions write;
};

// Draws maps with OpenGL, mirrors in them through maps of their own.
class Painter {
 public:
  Painter(const Options& o, const Common& common, const LoadedScene& loaded, const std::vector<Mirror>& mirrors)
      : options_(o),
        common_(common),
        context_(o.scene.context),
        renderer_(loaded.scene, loaded.environment.get(), nodes_of(mirrors)),
        mirrors_(loaded.scene, mirrors) {
    if (common.verbose) note(common, context_.renderer());
  }

  // @param moved meshes whose vertices are others than in the last shot.
  [[nodiscard]] Drawn paint(Shot shot, const std::vector<int>& moved, DrawMethod method) {
    for (const int mesh : moved) renderer_.update(shot.scene, mesh);
    const Viewpoint& from = options_.from;
    if (options_.bounces > 0) {
      const Viewer viewer{.at = from.at, .node = from.without, .pixel = 0.5 * pi / from.size};
      mirrors_.update(renderer_, shot, {viewer}, {.bounces = options_.bounces, .moved = !moved.empty(), .far = from.far}, [&](const std::string& line) {
        if (common_.verbose) note(common_, line);
      });
      shot.mirrors = mirrors_.maps();
    }
    return draw(renderer_, from, shot, method);
  }

 private:
  const Options& options_;
  const Common& common_;
  Context context_;
  Renderer renderer_;
  Mirrors mirrors_;
};

// Says what a map of moved vertices lacks.
void warn_about_missing(const std::string& path, DrawMethod method, const Drawn& drawn) {
  if (drawn.missing_solid_angle == 0) return;
  warn(fmt::format("{}: {} left out surfaces near the singularity, up to {:.2g} sr: use --method exact", path,
                   draw_method_names[std::size_t(method)], drawn.missing_solid_angle));
}

// From where the map is drawn to a node, or to the scene's first camera; or what is said.
Direction direction(const Options& o, const Scene& scene, const Pose& pose) {
  if (const auto along = triple_of(o.forward)) return *along;
  if (const auto there = direction_to(scene, pose, o.from.at, o.forward)) return *there;
  if (o.forward == "camera") throw UsageError(fmt::format("--forward: {} has no camera", o.scene.path));
  throw UsageError(fmt::format("--forward: '{}' is no axis (+z, -z, +x, -x), no X,Y,Z, no node of {} and not 'camera'",
                               o.forward, o.scene.path));
}

void check(const Options& o) {
  if (o.from.near >= o.from.far) throw UsageError("--near: not below --far");
  if (forward_named(o.forward) && !has_forward(o.from.to))
    throw UsageError("--forward: an axis is for latlong and angular maps; others take a node, X,Y,Z or camera");
  if (o.method == DrawMethod::raycast) check_no_context(o.scene);
  const bool distorts = o.method == DrawMethod::distort || o.method == DrawMethod::tessellate;
  if (o.from.epsilon > 0 && !distorts) throw UsageError("--epsilon is for --method distort and tessellate");
  if (!can_draw(o.method, o.from.to))
    throw UsageError(fmt::format("--method {} cannot draw {} maps: {}resample or raycast",
                                 draw_method_names[static_cast<std::size_t>(o.method)], name(o.from.to),
                                 can_draw(DrawMethod::exact, o.from.to) ? "exact, " : ""));
}

int run(Options& o, const Common& common) {
  o.from.to = o.to.value_or(Projection::cube);
  const Forward forward = forward_named(o.forward).value_or(Forward::plus_z);
  o.from.axes = image_to_world(forward);
  check(o);
  const Frames frames = frames_of(o.scene);
  check_report(o.output, common);
  check_output(frames.path(o.output, frames.first), o.write, o.from.to);
  const std::vector<std::string> outputs = frames.paths(o.output);
  check_files(outputs, {o.scene.path, o.scene.environment}, common);
  const Costs costs = read_costs(o.costs, common);
  LoadedScene loaded = load(o.scene, common);
  check_files(outputs, loaded.inputs, common);
  const auto depfile = open_depfile(outputs, loaded.inputs, common);
  const Viewpoint place = viewpoint_of(o.at, loaded.scene, o.scene.path);
  o.from.at = place.at, o.from.without = place.without;
  const bool turned = !o.forward.empty() && !forward_named(o.forward);
  // Who says what OpenGL is drawn with wants it drawn with OpenGL.
  const bool rays = o.scene.context == ContextKind::automatic;
  const DrawMethod method =
      o.method == DrawMethod::automatic ? cheapest(o.from.to, o.from.size, triangles(loaded.scene), costs, rays) : o.method;
  const std::vector<Mirror> mirrors =
      o.bounces > 0 ? find_mirrors(loaded.scene, Projection::paraboloid) : std::vector<Mirror>{};
  std::optional<Painter> painter;
  if (method != DrawMethod::raycast) painter.emplace(o, common, loaded, mirrors);
  double seconds = 0;
  nlohmann::ordered_json report{{"input", o.scene.path}, {"method", draw_method_names[std::size_t(method)]}};
  for (int frame = frames.first; frame <= frames.last; ++frame) {
    const std::vector<int> moved = loaded.move_to(frames.time(frame));
    const Shot shot = loaded.shot(frames.time(frame), o.scene);
    if (o.from.without >= 0) o.from.at = centre_of(loaded.scene, shot.pose, o.from.without);
    if (turned) o.from.axes = turned_to(direction(o, loaded.scene, shot.pose));
    const Stopwatch watch;
    Drawn drawn = painter ? painter->paint(shot, moved, method)
                          : raycast(shot, o.from, {nodes_of(mirrors), o.bounces, o.from.far}, progress_line(common, "cast"));
    const double took = watch.seconds();
    seconds += took;
    drawn.radiance.forward = forward;
    const std::string path = frames.path(o.output, frame);
    if (turned)
      note(common, fmt::format("{}: its +Z looks along {:.4g},{:.4g},{:.4g} of the scene, its +Y up", path, o.from.axes[2].x,
                               o.from.axes[2].y, o.from.axes[2].z));
    if (common.verbose)
      note(common, fmt::format("{}: {} from {:.4g},{:.4g},{:.4g}, drawn in {:.1f} ms", path,
                               draw_method_names[static_cast<std::size_t>(method)], o.from.at.x, o.from.at.y,
                               o.from.at.z, 1e3 * took));
    write_one_map(path, all_rows_of(drawn.radiance), o.write, "write", common);
    warn_about_missing(path, method, drawn);
    report["maps"].push_back({{"output", path}, {"seconds", took}, {"missing_solid_angle", drawn.missing_solid_angle}});
  }
  if (depfile) depfile->commit();
  tell_darkness(loaded, o.scene);
  tell_rate(frames, seconds, common);
  if (common.json) print_report(report);
  return 0;
}

constexpr std::string_view description =
    "Draws a scene (glTF 2.0: .gltf, .glb; OBJ) from a point into an environment map. Directions are the world's axes "
    "of "
    "the scene (glTF: right-handed, +Y up), as in every other map. --at is a place or a node: then the centre of what "
    "the node holds, and the node itself is left out.\n\n"
    "Methods. 'exact': each triangle is drawn over the true bounds of its curved outline, and every texel's ray meets "
    "the "
    "triangle itself; right for triangles of any size. 'resample': six faces of a cube of the same size, then the "
    "bilinear filter of envmap convert. 'raycast': the reference, by Embree, without OpenGL. 'distort': vertices are "
    "moved by the map's formula (Heidrich and Seidel 1998) and sides stay straight: fast, and wrong where triangles are "
    "large. 'tessellate': triangles are first cut until they are right to a quarter of a pixel. distort and tessellate "
    "leave out each triangle (or piece) that holds the singularity: -Z of sphere and angular maps, the axis behind each "
    "half of a paraboloid map. A warning and --json state the solid angle of these triangles. Neither draws latlong maps. "
    "'auto' chooses the cheapest of exact, resample and raycast by the "
    "number of triangles and texels.\n\n"
    "Light: emission, KHR_lights_punctual, --ambient and --environment, by glTF's metallic-roughness model. Punctual "
    "lights cast shadows (--no-shadows), and surfaces keep diffuse light of the environment from each other (--occlusion). "
    "Surfaces are seen between the spheres of --near and --far.\n\n"
    "--context: 'egl' draws on a graphics card or the processor without a display, 'osmesa' on the processor. 'auto' tries a "
    "card through EGL, then OSMesa, then the processor through EGL. A --context other than 'auto' excludes raycast from "
    "--method auto. -v prints what draws. The exit status is 5 if nothing does.\n\n"
    "--frames A:B draws frame k at the time --time + k / --fps into a file each: put {frame} or %04d into the name.";

}  // namespace

Command render_command() {
  return {.name = "render",
          .summary = "Draw a 3D scene round a point or an object into an environment map",
          .description = std::string(description),
          .examples = {{"envmap render cellar.glb cube.exr --at 0,1.5,0", "a cube map of 256 round a point"},
                       {"envmap render cellar.glb ball.exr --to sphere --size 512 --at Ball --environment probe.exr",
                        "what the node Ball would mirror, as a sphere map, under a sky"},
                       {"envmap render cellar.glb 'frames/{frame}.exr' --to paraboloid --frames 0:47 --fps 24 -v",
                        "two seconds of an animated scene, with times"},
                       {"envmap render cellar.glb seen.exr --to sphere --at Ball --forward camera",
                        "the classic sphere map, turned to who looks at the ball"},
                       {"envmap render room.obj map.exr --to latlong --ambient 1 --samples 8",
                        "base colours alone, eight samples a texel"}},
          .keys = {{"input", "text", "INPUT"},
                   {"method", "text", "the drawing method, also if --method auto chose it"},
                   {"maps[].output", "text", "file name"},
                   {"maps[].seconds", "number", "time to draw the map, without writing"},
                   {"maps[].missing_solid_angle", "number",
                    "solid angle in steradians of the triangles near the singularity that distort or tessellate left out: an "
                    "upper bound of what the map lacks"}},
          .reports = true,
          .writes = true,
          .define = [](CLI::App& app, const Common& common) -> std::function<int()> {
            auto o = std::make_shared<Options>();
            add_scene(app, o->scene);
            app.add_option(
                   "OUTPUT", o->output,
                   "File to write, '-' for standard output; {face} in the name writes six files, {half} a paraboloid's two, {frame} or %04d one "
                   "a frame")
                ->required();
            add_projection(app, "--to", o->to, "Projection of the map (default: cube)");
            app.add_option("--at", o->at, "Where from: a node of the scene, or a place (default: 0,0,0)")
                ->type_name("NODE|X,Y,Z");
            add_size(app, o->from.size, "Height of a face (default: 256)");
            app.add_option("--samples", o->from.samples, "Rays a texel (default: 1)")->type_name("N")->check(CLI::Range(1, 1024));
            app.add_option("--near", o->from.near, "Nothing nearer is drawn (default: 0.01)")
                ->type_name("METRES")
                ->check(number_in({1e-9, 1e9}));
            app.add_option("--far", o->from.far, "Nothing further is drawn (default: 1000)")
                ->type_name("METRES")
                ->check(number_in({1e-9, 1e12}));
            app.add_option("--bounces", o->bounces,
                           "Mirrors and glass show what is round them, and each other: so many rounds of their maps, or so often a "
                           "ray is followed (default: 0; they show the environment alone)")
                ->type_name("N")
                ->check(CLI::Range(0, 64));
            add_choice(app, "--method", o->method, joined(draw_method_names), one_of<DrawMethod>(draw_method_names),
                       "How it is drawn (default: auto)");
            app.add_option("--forward", o->forward,
                           "World axis at the centre of latlong and angular maps: +z, -z, +x or -x (default: +z). Of any map, what "
                           "its +Z looks at: a node, a direction, or 'camera', the scene's first, as the sphere maps of viewers "
                           "have it; the map is turned then")
                ->type_name("AXIS|NODE|X,Y,Z|camera");
            app.add_option("--epsilon", o->from.epsilon,
                           "distort, tessellate: move vertices with z < -1 + Z to infinity (default: paraboloids 0.5, other maps "
                           "0.05 for distort and 0.01 for tessellate)")
                ->type_name("Z")
                ->check(number_in({1e-6, 1.0}));
            add_layout(app, "--layout", o->write.layout, "Where cube faces lie (default: column)");
            add_costs(app, o->costs);
            add_write_options(app, o->write);
            return [o, &common] { return run(*o, common); };
          }};
}

}  // namespace tools

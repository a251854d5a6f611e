#include <fmt/format.h>

#include <array>
#include <cmath>
#include <span>

#include "colour_options.h"
#include "command.h"
#include "costs_file.h"
#include "depfile.h"
#include "engine_maps.h"
#include "engine_options.h"
#include "envmap/base/error.h"
#include "envmap/io/rounding.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/convert.h"
#include "envmap/operate/measure.h"
#include "photograph.h"
#include "shard.h"

namespace tools {
namespace {

using namespace envmap;

// What --to says: a projection, or a lens for a picture.
struct To {
  std::optional<Projection> projection;
  std::optional<CameraModel> lens;
};

struct Options {
  std::string input, output, costs;
  const Engine* engine = nullptr;
  ReadOptions read;
  To to;
  std::optional<Forward> forward;
  bool one_level = false;  // --level was given.
  std::optional<Direction> turn;  // Yaw, pitch, roll.
  double exposure = 0;
  ConvertOptions convert;
  WriteOptions write;
  GradeOptions grade;
  Shard shard;
  std::optional<double> ball_distance, ball_fov;
  // Of pictures:
  std::optional<Direction> look_at;
  std::optional<double> fov;
  std::optional<int> width, samples;
  std::optional<Display> display;
};

std::optional<To> to_named(std::string_view word) {
  if (const auto lens = one_of<CameraModel>(camera_model_names)(word)) return To{.projection = std::nullopt, .lens = lens};
  if (const auto projection = projection_named(word)) return To{.projection = projection, .lens = std::nullopt};
  return std::nullopt;
}

// Options that only maps have, or only pictures.
constexpr std::array of_maps{"--for", "--layout", "--area-error", "--max-error", "--ball-distance", "--ball-fov", "--forward", "--depth",
                             "--border", "--zstd", "--openexr-envmap", "--compression", "--clamp", "--shard", "--output-space", "--encoded", "--max-memory"};
constexpr std::array of_pictures{"--look-at", "--fov", "--width", "--display"};

void refuse_options(const CLI::App& app, bool picture) {
  const std::span<const char* const> others = picture ? std::span<const char* const>(of_maps) : of_pictures;
  const char* const why = picture ? "is for maps; --to perspective, fisheye and cylinder make pictures"
                                  : "is for pictures: --to perspective, fisheye or cylinder";
  for (const char* option : others)
    if (app.get_option(option)->count() > 0) throw UsageError(fmt::format("{} {}", option, why));
}

int run_photograph(const Options& o, const Common& common) {
  PhotographJob job{.input = o.input, .output = o.output, .format = o.write.format, .read = o.read, .grade = o.grade,
                    .photograph = {.lens = *o.to.lens, .samples = o.samples, .gain = portable::exp2(o.exposure)},
                    .field = o.fov, .width = o.width, .height = o.convert.size, .display = o.display};
  job.photograph.filter = o.convert.filter.value_or(Filter::bilinear);
  if (o.look_at) job.photograph.towards = *o.look_at;
  if (o.turn) job.photograph.rotation = rotation(o.turn->x, o.turn->y, o.turn->z);
  return take_photograph(job, common);
}

// What of the world the photo of a ball does not show, which no option fills in.
std::optional<BallCamera> ball_camera(const Options& o, const EnvironmentMap& source, const Common& common) {
  if (!o.ball_distance && !o.ball_fov) return std::nullopt;
  if (source.projection() != Projection::sphere)
    throw UsageError(fmt::format("--ball-{} is for the photo of a mirror ball (--from sphere); {} is a{} {} map",
                                 o.ball_fov ? "fov" : "distance", o.input,
                                 std::string_view("aeo").find(*name(source.projection())) != std::string_view::npos ? "n" : "", name(source.projection())));
  const BallCamera camera = o.ball_fov ? BallCamera::of_field_of_view(*o.ball_fov) : BallCamera{*o.ball_distance};
  note(common, fmt::format("envmap convert: {} does not show what is within {:.3g} degrees of -Z, behind the ball, {:.2g}% of all "
                           "directions: there the colours of the ball's rim are continued",
                           o.input, camera.blind_angle() * (180 / pi), 100 * camera.blind_part()));
  return camera;
}

std::string words(Filter filter, int samples) {
  return std::string(name(filter)) + (samples > 1 ? fmt::format(" --samples {}", samples) : "");
}

// Tells which filter was chosen for the error asked for, and what it was measured to do. False where none reached it.
bool tell_choice(const FilterChoice& choice, double max_error, const Common& common) {
  const auto line = [&](const FilterTrial& t) {
    return fmt::format("{}: max {:.2e}, rms {:.2e} in {} texels, {:.2g} us a texel", words(t.filter, t.samples), t.maximum,
                       t.rms, choice.texels, 1e6 * t.seconds_per_texel);
  };
  if (common.verbose)
    for (const FilterTrial& t : choice.trials) note(common, "tried " + line(t));
  const std::string chosen = line(choice.trials.back());
  if (choice.reached)
    note(common, chosen);
  else
    warn(fmt::format("envmap convert: --max-error {:g} is not reached: {}", max_error, chosen));
  return choice.reached;
}

nlohmann::ordered_json report_of(const Options& o, const Resampler& resampler) {
  nlohmann::ordered_json report;
  report["input"] = o.input;
  report["filter"] = name(resampler.filter().filter);
  report["samples"] = resampler.filter().samples;
  report["error"] = nullptr;
  if (const auto& choice = resampler.choice()) {
    const FilterTrial& trial = choice->trials.back();
    report["error"] = {{"max", trial.maximum}, {"rms", trial.rms}, {"texels", choice->texels}, {"within", choice->reached}};
  }
  report["output"] = nullptr;
  return report;
}

const std::vector<Key> keys{{"input", "text", "INPUT"},
                            {"filter", "text", "how it was sampled"},
                            {"samples", "count", "N x N in a texel"},
                            {"error", "object or null", "null without --max-error"},
                            {"error.max", "number", "against 'area': largest |a-b| / max(|b|, 0.001 x mean of b)"},
                            {"error.rms", "number", "against 'area': root of sum w |a-b|^2 / sum w |b|^2"},
                            {"error.texels", "count", "in how many texels that was measured"},
                            {"error.within", "boolean", "whether it is below --max-error; false: exit status 1, nothing is written. Where the depth alone rounds by more nothing is printed either"},
                            {"lens", "text?", "of a picture"},
                            {"width", "count?", "of a picture"},
                            {"height", "count?", "of a picture"},
                            {"seconds", "number", "from start to end"}};

void refuse(const Options& o, double max_error, const std::string& what) {
  warn(fmt::format("envmap convert: {}: --max-error {:g} is not held by the file: {}; --depth float in .exr holds it", o.output,
                   max_error, what));
}

std::string words(const Rounding& r, double rounded) { return fmt::format("{} rounds by up to {:.1e}", name(r), rounded); }

// Leaves of the error asked for what the depth of the file rounds by; half of it where that is known of the result alone.
// False where nothing is left.
bool leave_to_filter(Options& o, const std::optional<Rounding>& rounding) {
  const double asked = *o.convert.max_error;
  const double rounded = rounding ? rounding->largest.value_or(0.5 * asked) : 0;
  o.convert.max_error = asked - rounded;
  if (rounding && rounded < asked) return true;
  refuse(o, asked, rounding ? words(*rounding, rounded) : "integers, compressions that lose and --openexr-envmap have no bound");
  return false;
}

// Whether filter and file together keep to the error asked for, of a result of which that is known when it is made.
bool holds(const Options& o, const Rounding& rounding, const Level& made, double filtered, double max_error) {
  const double rounded = rounding_error(rounding, made, 0.001 * mean_radiance(made));
  if (filtered + rounded * (1 + filtered) <= max_error) return true;
  refuse(o, max_error, words(rounding, rounded));
  return false;
}

// A sentence for each filter.
std::string filter_words() {
  std::string text;
  for (const FilterInfo& f : filters()) text += fmt::format(" '{}' {}.", f.name, f.summary);
  return text;
}

void add_to(CLI::App& app, Options& o) {
  std::vector<std::string_view> words;
  for (const Projection p : all_projections) words.emplace_back(name(p));
  words.insert(words.end(), camera_model_names.begin(), camera_model_names.end());
  add_choice(app, "--to", o.to, joined(words), to_named, "Projection of the output (default: as the input), or the lens of a picture");
  add_triple(app, "--look-at", o.look_at, "X,Y,Z", false, "Of pictures: world direction in the middle (default: 0,0,1)");
  app.add_option("--fov", o.fov,
                 "Of pictures: angle from the bottom to the top (default: perspective 60, fisheye 180, cylinder 90)")
      ->type_name("DEGREES")
      ->check(number_in({0.01, 360.0}));
  app.add_option("--width", o.width, "Of pictures; --size is their height, 480 if nothing is said (default: 4 to 3; square; once round)")
      ->type_name("N")
      ->check(CLI::Range(1, 65536));
  add_display(app, o.display, Display::clip);
}

int run(Options& o, const Common& common) {
  o.read.assumed_forward = o.forward;
  const Stopwatch watch;
  // What can be known to fail is said before any work is done.
  check_report(o.output, common);
  o.convert.costs = read_costs(o.costs, common);
  choose_working_space(o.read, o.write);
  if (o.convert.max_error && out_of_working(o.write.colour).apply)
    throw UsageError("--max-error is that of linear values: choose a linear --output-space");
  const EngineMap* engine = o.engine ? &environment_of(*o.engine) : nullptr;
  if (engine) settle(*o.engine, *engine, o.output, o.to.projection, o.forward, o.write);
  if (o.to.projection) check_output(o.output, o.write, *o.to.projection);
  check_files({o.output}, {o.input}, common);
  Source source = read_map(o.input, o.read, common);
  if (source.levels > 1 && !o.one_level)
    warn(fmt::format("{}: of {} levels {} is converted; say --level 0 if that is meant, and make levels of the result with "
                     "'envmap mipmap'",
                     o.input, source.levels, o.read.level));
  o.convert.ball = ball_camera(o, source.map, common);
  grade(source, o.grade, o.read.colour, common);
  if (engine) tell_what_is_cut(*o.engine, source.map.base(), "convert");
  const Frame from = source.map.frame();
  const Projection to = o.to.projection.value_or(from.projection);
  o.convert.to = {to, o.forward.value_or(o.to.projection ? Forward::plus_z : from.forward)};
  if (o.forward && !has_forward(to) && !has_forward(from.projection))
    throw UsageError("--forward is for latlong and angular maps; neither input nor output is one");
  if (o.turn) o.convert.rotation = rotation(o.turn->x, o.turn->y, o.turn->z);
  o.convert.gain = portable::exp2(o.exposure);
  o.convert.size = size_inside_border(o.convert.size.value_or(matching_size(from.projection, source.map.base().height(), to)), o.write);
  o.write.source_depth = source.depth;
  o.write.provenance = source.provenance;
  if (auto& luminance = o.write.provenance.white_luminance)
    luminance = static_cast<float>(*luminance / o.convert.gain);  // The same light is now so many times (1,1,1).
  check_output(o.output, o.write, to);
  const std::optional<double> max_error = o.convert.max_error;
  const Mirror mirror = engine ? engine->mirror : Mirror::none;
  const std::optional<Rounding> rounding = mirrored(rounding_of(o.output, o.write), mirror);
  if (max_error && !leave_to_filter(o, rounding)) return 1;

  if (source.map.base().max_memory() > 0 && o.convert.filter == Filter::sat)
    throw UsageError(
        "--filter sat needs a table of all texels in memory: leave out --max-memory or choose another filter");
  const std::string made_of = o.shard.part ? digest(source.map) : "";
  const Resampler resampler(std::move(source.map), o.convert);
  const auto& choice = resampler.choice();
  nlohmann::ordered_json report = report_of(o, resampler);
  if (engine) add_frame(report, *o.engine, *engine);
  bool within = !choice || tell_choice(*choice, *max_error, common);
  Rows rows = resampler.rows();
  std::optional<Level> made;
  if (choice && within && !rounding->largest) {
    made = level_of(rows);
    rows = rows_of(*made, rows.forward);
    within = holds(o, *rounding, *made, choice->trials.back().maximum, *max_error);
    report["error"]["within"] = within;
  }
  if (!within) {
    if (common.json) print_report(report);
    return 1;
  }
  if (common.verbose)
    note(common, fmt::format("{} to {}: {}", name(from.projection), name(to),
                             words(resampler.filter().filter, resampler.filter().samples)));
  // At most with the root, where the source can be divided: 4 and 8 times at 1e-6 was measured. Else it is hundreds of times.
  if (const auto error = o.convert.area_error; error && *error < 1e-5 && resampler.filter().filter == Filter::area)
    note(common, fmt::format("envmap convert: --area-error {:g} takes some {:.0f} times as long as 1e-4", *error,
                             std::sqrt(1e-4 / *error)));
  if (max_error && o.shard.part) o.write.facts["whole-max-error"] = "yes";
  const WriteOptions how = part_or_whole(o.shard, o.write, rows, made_of);
  add_written(report, o.output, write_map(o.output, mirrored({rows}, mirror), how, {o.input}, "convert", common));
  if (engine) tell_frame(o.output, *o.engine, *engine, common);
  report["seconds"] = watch.seconds();
  if (common.json) print_report(report);
  return 0;
}

}  // namespace

Command convert_command() {
  return {
      .name = "convert",
      .summary = "Convert an environment map to another projection, size, layout or file format",
      .description =
          std::string("Reads an environment map, resamples it and writes it. Directions keep their meaning: world axes are "
          "right-handed "
          "with +Y up, +Z lies at the centre of latlong and angular images unless --forward says otherwise, and "
          "nothing is mirrored. Texels outside the disc of sphere and angular maps are written as 0.\n\n") +
          "Filters, from fast to exact." + filter_words() + " --samples N takes N x N places a texel instead of one, with "
          "the first three; --area-error is what the last may err by. 'auto' is area where the result is coarser than the source (a texel spans over 1.25 times as "
          "many degrees), else bilinear, with --samples 2 where it is less than twice as fine.\n\n"
          "--rotate turns the environment about +Z by the roll, then +X by the pitch, then +Y by the yaw, "
          "right-handed: "
          "with --rotate 90,0,0 what was seen towards +Z is seen towards +X.\n\n"
          "A sphere map is a mirror ball as seen from infinitely far away. Of a photo by a real camera, cropped to the ball's "
          "silhouette, --ball-distance or --ball-fov says how near the camera was, whose axis leads through the ball's centre: a "
          "ball that fills 20 degrees of the view is 5.76 radii away. Towards the camera is +Z. What lies hidden behind the "
          "ball, within half of that angle of -Z, is told, and gets the colours of the ball's rim.\n\n"
          "--to perspective, fisheye (equidistant) or cylinder takes a picture, which is no map: what a camera in the middle sees "
          "towards --look-at, --fov degrees from the bottom to the top, in a .png, .jpg, .exr or .hdr. Pixels are means of N x N "
          "places (--samples; by itself two for each texel that a pixel spans), as --filter nearest, bilinear or bicubic has them.\n\n"
          "--forward names the world axis at the centre of the latlong or angular images that are read without "
          "metadata and that are written; --from-forward names the input's alone.\n\n"
          "--for ENGINE makes the file that 'envmap bake' writes as the environment of that engine: projection, frame, file type and "
          "depth are its own, left-handed worlds get their mirrored map, and what is done to the frame is printed. --depth beside it is "
          "obeyed, another --to, --forward or file type is refused.\n\n"
          "Colours are linear Rec.709 in memory, or in the linear space of --output-space, so that nothing that it holds is lost. What "
          "an EXR file's chromaticities, an ACES container or Radiance's PRIMARIES say of the input is believed unless "
          "--input-space says another; 'envmap info' shows it. White points are adapted by Bradford's cones; XYZ are relative to "
          "D65. Colours outside of the working space are brought to its border at their luminance, and counted. EXR, Radiance "
          "and KTX2 files say what primaries they hold; PNG, JPEG and TIFF files of integers in another space than sRGB hold an ICC "
          "profile. --white, --gain and --saturation are applied in this order before sampling, "
          "then --scale-to.\n\n"
          "An EXR file's comments, owner and whiteLuminance (divided by what --exposure multiplies; 1 after --scale-to) are "
          "carried along as far as the output has a place for them.",
      .examples = {{"envmap convert probe.hdr probe.exr --to cube",
                    "a cube of the same density, faces in a column +X -X +Y -Y +Z -Z"},
                   {"envmap convert probe.exr 'face_{face}.exr' --to cube --size 512",
                    "six files face_px.exr ... face_nz.exr"},
                   {"envmap convert cross.hdr pano.exr --to latlong --forward -z",
                    "from a cube cross to a panorama with -Z at its centre"},
                   {"envmap convert probe.exr small.exr --to cube --size 64 --max-error 1e-3",
                    "the cheapest filter that is found right to 0.1%, rounding to the depth of the file counted"},
                   {"envmap convert probe.hdr view.png --to perspective --fov 50 --look-at 1,0.2,0 --exposure 1",
                    "a picture of what lies towards +X"},
                   {"envmap convert probe.hdr sky.dds --for babylon", "a cube of halves, mirrored for its left-handed world"},
                   {"envmap convert probe.exr aces.exr --output-space ACEScg", "for a renderer that works in ACEScg"},
                   {"envmap convert probe.hdr lit.exr --white 0,0,1 --scale-to lux=20000",
                    "a grey card seen towards +Z made grey, and the light that of an overcast noon"},
                   {"envmap convert photo.hdr probe.exr --from sphere --to latlong --ball-distance 12 --rotate 180,0,0",
                    "a photo of a ball from 12 radii away, with what was behind the ball in the middle"},
                   {"envmap convert ball.hdr - --from sphere --to angular | envmap info -",
                    "a mirror ball as light probe, through a pipe"}},
      .keys = with_frame(with_written(keys)),
      .reports = true,
      .writes = true,
      .define = [](CLI::App& app, const Common& common) -> std::function<int()> {
        auto o = std::make_shared<Options>();
        app.add_option("INPUT", o->input, "File to read, '-' for standard input; {face} in the name reads six files, {half} a paraboloid's two")->required();
        app.add_option("OUTPUT", o->output,
                       "File to write, '-' for standard output; {face} in the name writes six files, {half} a paraboloid's two")
            ->required();
        add_engine(app, o->engine,
                   "Make what this engine loads as its environment: projection, frame, file type and depth; 'list' prints the engines");
        add_to(app, *o);
        add_size(app, o->convert.size, "Height of a face (default: the input's degrees per texel)");
        add_layout(app, "--layout", o->write.layout, "Where the output's cube faces lie (default: column)");
        add_filter(app, o->convert.filter, "How the input is sampled (default: auto)");
        app.add_option("--samples", o->samples,
                       "N x N samples a texel, of nearest, bilinear and bicubic (default: 1; of auto as above)")
            ->type_name("N")
            ->check(CLI::Range(1, 64));
        app.add_option("--area-error", o->convert.area_error,
                       "Error of a texel, relative to it, at which 'area' stops refining (default: 1e-4; 1e-3 where "
                       "'auto' chose it); 1e-6 takes some 10 times as long")
            ->type_name("E")
            ->check(number_in({1e-7, 1.0}));
        app.add_option(
               "--max-error", o->convert.max_error,
               "Take the cheapest filter whose max and rms errors against 'area', measured in some texels of this map, and "
               "what the file's depth rounds the largest channel by are together below E; exit status 1 where none is")
            ->type_name("E")
            ->check(number_in({1e-6, 10.0}));
        add_triple(app, "--rotate", o->turn, "Y,P,R", false, "Turn the environment by yaw, pitch, roll in degrees");
        app.add_option("--ball-distance", o->ball_distance,
                       "The input is the photo of a mirror ball by a camera R ball radii from the ball's centre (default: infinitely far)")
            ->type_name("R")
            ->check(number_in({BallCamera::nearest, BallCamera::farthest}));
        app.add_option("--ball-fov", o->ball_fov, "The same by the angle that the ball fills at the camera, from one side to the other")
            ->type_name("DEGREES")
            ->check(number_in({1.2e-4, 157.0}))
            ->excludes("--ball-distance");
        add_forward(app, "--forward", o->forward,
                    "World axis at the centre of latlong and angular images (default: +z)");
        auto* const exposure = app.add_option("--exposure", o->exposure, "Multiply radiance by 2^STOPS");
        exposure->type_name("STOPS")->check(number_in({-100.0, 100.0}));
        add_grade(app, o->grade);
        app.get_option("--scale-to")->excludes(exposure);
        add_border(app, o->write, "--size counts them");
        add_costs(app, o->costs);
        add_write_options(app, o->write);
        add_shard(app, o->shard);
        add_read_options(app, o->read);
        add_output_space(app, o->write);
        add_max_memory(app, o->read);
        add_repair(app, o->read);
        return [o, &app, &common] {
          o->one_level = app.count("--level") > 0;
          refuse_options(app, o->to.lens.has_value());
          if (o->to.lens) return run_photograph(*o, common);
          o->convert.samples = o->samples.value_or(1);
          return run(*o, common);
        };
      }};
}

}  // namespace tools

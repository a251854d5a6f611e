#include "envmap/operate/convert.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <span>

#include "cli/console.h"
#include "command.h"
#include "engines/engine_options.h"
#include "envmap/base/error.h"
#include "envmap/base/words.h"
#include "envmap/engine/baked_maps.h"
#include "envmap/io/error_budget.h"
#include "envmap/io/files/face_names.h"
#include "envmap/io/texels/rounding.h"
#include "envmap/io/write_plan.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/grade.h"
#include "envmap/operate/measure.h"
#include "envmap/projection/matching_size.h"
#include "maps/colour_and_light_options.h"
#include "maps/gain_map.h"
#include "maps/read_and_write_maps.h"
#include "maps/rotation_options.h"
#include "maps/shard_options.h"
#include "maps/sun_options.h"
#include "photos/camera_picture.h"
#include "photos/photo.h"

namespace tools {
namespace {

using namespace envmap;

struct Convert {
  std::string input, output, added;
  const Engine* engine = nullptr;
  ReadOptions read;
  std::optional<Projection> to;
  std::optional<CameraModel> lens;  // Of --to, for a picture.
  std::optional<Forward> forward;
  bool one_level = false;  // --level was given.
  std::optional<Turn> turn;
  double exposure = 0;
  ConvertOptions convert;
  WriteOptions write;
  GradeOptions grade;
  SunOptions sun;
  Shard shard;
  GainMapRequest gain_map;
  PhotoOptions photo;
  std::optional<double> ball_distance, ball_fov;
  // Of pictures:
  std::optional<Direction> look_at;
  std::optional<double> fov;
  std::optional<int> width, samples;
  std::optional<Display> display;
};

// Options that only maps have, or only pictures.
constexpr std::array of_maps{"--for",           "--layout",   "--faces",          "--area-error",     "--max-error",
                             "--ball-distance", "--ball-fov", "--forward",        "--mirror",         "--add",
                             "--depth",         "--border",   "--zstd",           "--openexr-envmap", "--compression",
                             "--clamp",         "--shard",    "--output-space",   "--encoded",        "--max-memory",
                             "--circle",        "--back",     "--circle-picture", "--back-circle",    "--gain-map",
                             "--max-bytes",     "--restore-sun", "--sun-radius"};
constexpr std::array of_pictures{"--look-at", "--width"};

void refuse_options(const Options& options, bool picture) {
  const std::span<const char* const> others = picture ? std::span<const char* const>(of_maps) : of_pictures;
  const char* const why = picture ? "is for maps; --to perspective, fisheye and cylinder make pictures"
                                  : "is for pictures: --to perspective, fisheye or cylinder";
  for (const char* option : others)
    if (options.given(option)) throw UsageError(fmt::format("{} {}", option, why));
}

int run_photograph(const Convert& o, Report& report) {
  PhotographJob job{.input = o.input,
                    .output = o.output,
                    .format = o.write.format,
                    .read = o.read,
                    .grade = o.grade,
                    .photograph = {.lens = *o.lens, .samples = o.samples, .gain = portable::exp2(o.exposure)},
                    .field = o.fov,
                    .width = o.width,
                    .height = o.convert.size,
                    .display = o.display};
  job.photograph.filter = o.convert.filter.value_or(Filter::bilinear);
  if (o.look_at) job.photograph.towards = *o.look_at;
  job.turn = o.turn;
  return take_photograph(job, report);
}

// What of the world the photo of a ball does not show, which no option fills in.
std::optional<BallCamera> ball_camera(const Convert& o, const EnvironmentMap& source) {
  if (!o.ball_distance && !o.ball_fov) return std::nullopt;
  if (source.projection() != Projection::sphere)
    throw UsageError(
        fmt::format("--ball-{} is for the photo of a mirror ball (--from sphere); {} is a{} {} map",
                    o.ball_fov ? "fov" : "distance", o.input,
                    std::string_view("aeo").find(*name(source.projection())) != std::string_view::npos ? "n" : "",
                    name(source.projection())));
  const BallCamera camera = o.ball_fov ? BallCamera::of_field_of_view(*o.ball_fov) : BallCamera{*o.ball_distance};
  note(fmt::format(
      "envmap convert: {} does not show what is within {:.3g} degrees of -Z, behind the ball, {:.2g}% of all "
      "directions: there the colours of the ball's rim are continued",
      o.input, camera.blind_angle() * (180 / pi), 100 * camera.blind_part()));
  return camera;
}

std::string words(Filter filter, int samples) {
  return std::string(name(filter)) + (of_points(filter) && samples > 1 ? fmt::format(" --samples {}", samples) : "");
}

// Tells which filter was chosen for the error asked for, and what it was measured to do. False where none reached it.
bool tell_choice(const FilterChoice& choice, double max_error) {
  const auto line = [&](const FilterTrial& t) {
    return fmt::format("{}: max {:.2e}, rms {:.2e} in {} texels, {:.2g} us a texel", words(t.filter, t.samples),
                       t.maximum, t.rms, choice.texels, 1e6 * t.seconds_per_texel);
  };
  for (const FilterTrial& t : choice.trials) detail("tried " + line(t));
  const std::string chosen = line(choice.trials.back());
  if (choice.reached)
    note(chosen);
  else
    warn(fmt::format("envmap convert: cannot meet --max-error {:g}: {}", max_error, chosen));
  return choice.reached;
}

void tell(Report& report, const Convert& o, const Resampler& resampler) {
  report.put("input", o.input);
  report.put("filter", name(resampler.filter().filter));
  report.put("samples", resampler.filter().samples);
  report.put("error", nullptr);
  if (const auto& choice = resampler.choice()) {
    const FilterTrial& trial = choice->trials.back();
    report.put("error.max", trial.maximum);
    report.put("error.rms", trial.rms);
    report.put("error.texels", choice->texels);
    report.put("error.within", choice->reached);
  }
  report.put("output", nullptr);
}

void refuse(const Convert& o, double max_error, const std::string& what) {
  warn(fmt::format("envmap convert: {}: cannot meet --max-error {:g}: {}: use an .exr file with --depth float",
                   o.output, max_error, what));
}

// Leaves of the error asked for what the depth of the file rounds by; half of it where that is known of the result
// alone. False where nothing is left.
bool leave_to_filter(const Convert& o, const std::optional<Rounding>& rounding, ConvertOptions& how) {
  const double asked = *o.convert.max_error;
  try {
    how.max_error = left_to_filter({asked, rounding});
    return true;
  } catch (const AccuracyError& e) {
    refuse(o, asked, rounding ? e.what() : "integers, lossy compression and --openexr-envmap have no bound");
    return false;
  }
}

// Whether filter and file together keep to the error asked for, of a result of which that is known when it is made.
bool holds(const Convert& o, const Rounding& rounding, const Level& made, double filtered, double max_error) {
  const double rounded = rounding_error(rounding, made, 0.001 * mean_radiance(made));
  if (filtered + rounded * (1 + filtered) <= max_error) return true;
  refuse(o, max_error, rounding_words(rounding, rounded));
  return false;
}

// A map, or a photo that becomes one.
Source read_input(const Convert& o, std::optional<Picture>& circle, Report& report) {
  if (!o.photo.of) {
    Source source = read_map(o.input, o.read);
    if (source.map.projection() == Projection::sphere) tell_range(o.input, source);  // A cropped photo of a ball.
    return source;
  }
  PhotoSource photo = read_photo(o.input, o.photo, o.read, report);
  circle = std::move(photo.circle);
  return std::move(photo.source);
}

// What the options say of the input's projection does not hold for a second map.
Source read_added(const Convert& o) {
  ReadOptions read = o.read;
  read.projection.reset(), read.layout.reset(), read.forward.reset(), read.border.reset(), read.level = 0;
  read.border_samples = read.apply_pose = false;
  if (!has_face(o.added)) read.faces.clear();
  return read_map(o.added, read);
}

// In the unit of the input, where both files state theirs.
void add(Source& source, const Source& other, const Convert& o) {
  const std::optional<float>&unit = source.provenance.white_luminance, &others = other.provenance.white_luminance;
  if (unit.has_value() != others.has_value())
    warn(fmt::format("{} does not state its unit, and {} does: their numbers are added as they are",
                     unit ? o.added : o.input, unit ? o.input : o.added));
  add_light(source.map, other.map, unit && others ? double(*others) / *unit : 1);
  check_finite(source.map.base(), "--add", "dim one of the maps first");
}

// Radiance as a screen shows it, for files of integers. `clip` reports its loss as --clamp does.
Rows displayed(const Convert& o, WriteOptions& write, const Rows& rows) {
  const FileFormat* const format = format_with_extension(extension(o.output, write));
  if (!format || !is_integer(choose_depth(*format, write)))
    throw UsageError(o.output,
                     "holds radiance as it is: remove --display, or use --depth uint8 where the format has it");
  if (o.display == Display::clip && !out_of_working(write.colour).apply) {
    write.clamp = true;
    return rows;
  }
  Rows shown = rows;
  shown.fill = [rows, display = *o.display](int face, int row, std::span<Colour> out) {
    rows.fill(face, row, out);
    show(out, display);
  };
  return shown;
}

void check_filter_options(const Convert& o) {
  const std::optional<Filter>& filter = o.convert.filter;
  if (o.convert.max_error && (filter || o.samples || o.convert.area_error))
    throw UsageError(fmt::format("--max-error chooses the filter: remove {}", filter      ? "--filter"
                                                                              : o.samples ? "--samples"
                                                                                          : "--area-error"));
  if (o.samples && filter && !of_points(*filter))
    throw UsageError(
        fmt::format("--samples is for nearest, bilinear and bicubic: remove it or --filter {}", name(*filter)));
}

// --gain-map: the display curve is that of its picture, and limits are those of its file.
void resolve_gain_map(Convert& o) {
  if (!o.gain_map.wanted) return;
  if (o.engine || o.shard.part)
    throw UsageError(fmt::format("--gain-map cannot be used with {}", o.engine ? "--for" : "--shard"));
  o.gain_map.display = o.display;
  if (o.to) check_gain_map(o.output, gain_map_options(o.gain_map), o.write, *o.to);
}

// What options say before the input is known: the frame and the file that an engine wants, colours, the output's name.
const EngineMap* resolve_options(Convert& o) {
  o.photo.field = o.fov;
  resolve_photo_options(o.photo, o.read);
  if (o.to && !has_forward(*o.to)) o.read.assumed_forward = o.forward;  // The output has no axis to choose.
  choose_working_space(o.read, o.write);
  if (o.convert.max_error && out_of_working(o.write.colour).apply)
    throw UsageError("--max-error is that of linear values: choose a linear --output-space");
  check_filter_options(o);
  if (o.engine) o.engine = &row_for(*o.engine, o.output, o.write);
  const EngineMap* engine = o.engine ? &environment_of(*o.engine) : nullptr;
  if (engine) resolve_for_engine(*o.engine, *engine, o.shard.part ? "" : o.output, o.to, o.forward, o.write);
  if (o.to) check_output(o.shard.whole(o.output), o.write, *o.to);
  resolve_gain_map(o);
  return engine;
}

// The light that is converted: the input, with the light of --add, graded.
Source light_of(const Convert& o, const EngineMap* engine, std::optional<Picture>& circle, Report& report) {
  Source source = read_input(o, circle, report);
  if (source.levels > 1 && !o.one_level)
    warn(fmt::format("{}: has {} levels, and only level {} is converted: use --level 0 to confirm, {}", o.input,
                     source.levels, o.read.level,
                     is_prefiltered_chain(source) ? "or 'envmap mipmap --keep' to keep all levels"
                                                  : "and 'envmap mipmap' to add levels"));
  restore(source, o.input, o.sun, report);
  if (!o.added.empty()) add(source, read_added(o), o);
  grade(source, o.grade, o.read.colour);
  if (engine) warn_about_clamping(*o.engine, source.map.base(), portable::exp2(o.exposure), "convert");
  return source;
}

// How the source is resampled: its frame, size, rotation and gain.
ConvertOptions resampling_of(const Convert& o, const EnvironmentMap& source) {
  const Frame from = source.frame();
  const Projection to = o.to.value_or(from.projection);
  if (o.forward && !has_forward(to) && !has_forward(from.projection))
    throw UsageError("--forward is for latlong and angular maps; neither input nor output is one");
  ConvertOptions how = o.convert;
  how.ball = ball_camera(o, source);
  if (o.turn && o.turn->of_sun() && how.ball)
    throw UsageError("--rotate sun:TO is for maps: convert the photo first, then rotate the result");
  if (source.base().max_memory() > 0 && how.filter == Filter::sat)
    throw UsageError(
        "--filter sat needs a table of all texels in memory: remove --max-memory or choose another filter");
  how.to = {to, o.forward.value_or(o.to ? Forward::plus_z : from.forward)};
  if (o.turn) how.rotation = rotation_of(*o.turn, source);
  how.gain = portable::exp2(o.exposure);
  how.size = size_inside_border(how.size.value_or(matching_size(from.projection, source.base().height(), to)), o.write);
  return how;
}

// How the result is written: what the source was, in the unit that the gain leaves.
WriteOptions writing_of(const Convert& o, const Source& source, double gain) {
  WriteOptions how = o.write;
  how.source_depth = source.depth;
  how.provenance = source.provenance;
  if (auto& luminance = how.provenance.white_luminance)
    luminance = float(*luminance / gain);  // The same light is now so many times (1,1,1).
  if (o.convert.max_error && o.shard.part) how.facts["whole-max-error"] = "yes";
  return how;
}

// The rows of the result, on which the error asked for holds in the file; nothing where it does not.
// @param made what the rows read, where all of it had to be made to know its rounding: it must outlive them.
std::optional<Rows> result_of(const Convert& o, const Resampler& resampler, const std::optional<Rounding>& rounding,
                              std::optional<Level>& made, Report& report) {
  const auto& choice = resampler.choice();
  if (choice && !tell_choice(*choice, *o.convert.max_error)) return std::nullopt;
  const Rows rows = resampler.rows();
  if (!choice || o.gain_map.wanted ||
      bounds_every_channel(*rounding, resampler.filter().floor * portable::exp2(o.exposure)))
    return rows;
  made = level_of(rows);
  const bool within = holds(o, *rounding, *made, choice->trials.back().maximum, *o.convert.max_error);
  report.put("error.within", within);
  return within ? std::optional(rows_of(*made, rows.forward)) : std::nullopt;
}

void tell_filter(const Convert& o, const Frame& from, const Frame& to, const Resampler& resampler) {
  detail(fmt::format("{} to {}: {}", name(from.projection), name(to.projection),
                     words(resampler.filter().filter, resampler.filter().samples)));
  // At most with the root, where the source can be divided: 4 and 8 times at 1e-6 was measured.
  // Else it is hundreds of times.
  if (const auto error = o.convert.area_error; error && *error < 1e-5 && resampler.filter().filter == Filter::area)
    note(fmt::format("envmap convert: --area-error {:g} takes some {:.0f} times as long as 1e-4", *error,
                     std::sqrt(1e-4 / *error)));
}

// Gain maps round by what the result and the limits make of them: known when it is written.
std::optional<Rounding> rounding_in_file(const Convert& o, const WriteOptions& write, MirroredAxis mirror) {
  if (o.gain_map.wanted) return Rounding{.depth = Depth::uint8, .largest = std::nullopt};
  return mirrored(rounding_of(o.output, write), mirror);
}

// Writes the file with the error that is left to it. False where a limit cannot be met.
bool put_gain_map(const Convert& o, const Rows& rows, const WriteOptions& write,
                  const std::optional<FilterChoice>& choice, Report& report) {
  GainMapOptions how = gain_map_options(o.gain_map);
  if (const auto& most = o.convert.max_error) {
    const double filtered = choice ? choice->trials.back().maximum : 0;
    how.max_error = (*most - filtered) / (1 + filtered);
  }
  return write_gain_map(o.output, rows, how, o.convert.max_error, write, report);
}

int run(Convert& o, Report& report) {
  const EngineMap* engine = resolve_options(o);
  const MirroredAxis mirror = engine ? engine->mirror : MirroredAxis::none;
  std::optional<Picture> circle;
  Source source = light_of(o, engine, circle, report);
  const Frame from = source.map.frame();
  ConvertOptions how = resampling_of(o, source.map);
  WriteOptions write = writing_of(o, source, how.gain);
  check_output(o.shard.whole(o.output), write, how.to.projection);
  if (o.gain_map.wanted) check_gain_map(o.output, gain_map_options(o.gain_map), write, how.to.projection);
  const std::optional<Rounding> rounding = rounding_in_file(o, write, mirror);
  if (o.convert.max_error && !leave_to_filter(o, rounding, how)) return 1;

  const std::string made_of = o.shard.part ? digest(source.map) : "";
  const Resampler resampler(std::move(source.map), how);
  tell(report, o, resampler);
  if (engine) add_frame(report, *o.engine, *engine);
  std::optional<Level> made;
  std::optional<Rows> rows = result_of(o, resampler, rounding, made, report);
  if (!rows) {
    report.put_seconds();
    return 1;
  }
  if (o.display && !o.gain_map.wanted) rows = displayed(o, write, *rows);
  tell_filter(o, from, how.to, resampler);
  if (o.gain_map.wanted) {
    if (!put_gain_map(o, *rows, write, resampler.choice(), report)) return 1;
  } else {
    record_mirror(write.facts, mirror);
    const WriteOptions part = part_or_whole(o.shard, write, *rows, made_of);
    report.put_written(o.output, write_map(o.output, mirrored({*rows}, mirror), part, "convert"));
  }
  if (circle) write_circle(o.photo, *circle);
  if (engine) tell_frame(o.output, *o.engine, *engine);
  tell_lost_facts(o.output, {how.to.projection, rows->forward}, write);
  report.put_seconds();
  return 0;
}

// --to, which takes projections of maps and lenses of camera views.
void add_target(Options& o, Convert& c) {
  o.add(
      "--to PROJECTION", projection_words() + "|" + joined(camera_model_names, "|"),
      [&c](const std::string& word) {
        const int lens = index_of(word, camera_model_names);
        if (lens >= 0) c.lens = CameraModel(lens);
        c.to = lens >= 0 ? std::nullopt : projection_named(word);
        return lens >= 0 || c.to;
      },
      "{} (default: the input's)");
}

}  // namespace

Action define_convert(Options& o) {
  const auto c = std::make_shared<Convert>();
  o.reads("INPUT", c->input, "File to read, or '-' for stdin ({face} in the name: six files, {half}: two)").required =
      true;
  o.writes("OUTPUT", c->output, "File to write, or '-' for stdout ({face} and {half} as for INPUT)").required = true;
  o.group = groups::output_map;
  add_target(o, *c);
  add_size(o, &c->convert.size, "Height of the image or of one cube face (default: same texels per degree)");
  add_engine(o, c->engine, "Projection, orientation and file format of an engine ('list' lists engines)");
  add_rotate(o, c->turn);
  o.add(
       "--mirror", "x|y|z",
       [&mirror = c->convert.mirror](const std::string& word) {
         const int axis = index_of(word, mirrored_axis_names);
         if (axis > 0) mirror = MirroredAxis(axis);
         return axis > 0;
       },
       "Exchange the directions of this axis, after --rotate: {}")
      .excludes = "--for";
  add_forward(o, "--forward AXIS", c->forward, "Axis at the centre of latlong and angular maps: {} (default: +z)");
  add_layout(o, "--layout", c->write.layout, "Cube faces: {} (default: column)");
  add_faces(o, c->write);
  add_border(o, c->write, "part of --size");
  add_write_options(o, c->write);
  add_gain_map(o, c->gain_map);
  o.group = groups::quality;
  o.add("--max-error", "E", &c->convert.max_error, {1e-6, 10},
        "Use the fastest filter with errors in the file below E, or exit with 1");
  add_filter(o, c->convert.filter, "{} (default: auto)");
  add_max_bytes(o, c->gain_map);
  o.add("--samples", "N", &c->samples, range_of(limits::samples),
        "nearest, bilinear, bicubic: N x N samples a texel (default: 1; auto: 1, 2)");
  o.add("--area-error", "E", &c->convert.area_error, range_of(limits::area_error),
        "Relative error at which 'area' stops (default: 1e-4; with auto 1e-3)");
  add_read_options(o, c->read);
  add_photo_words(o, c->photo, c->read);
  add_repair(o, c->read);
  o.group = groups::colour;
  o.add("--add", "FILE", &c->added, "Add a map's light; --restore-sun HOW, --sun-radius R: a clipped sun's").file =
      File::input;
  add_restore_sun(o, c->sun);
  add_exposure(o, c->exposure);
  add_grade(o, c->grade);
  o["--scale-to"].excludes = "--exposure";
  std::string& display = add_display(o, c->display, Display::clip).help;
  display.replace(display.find("files of "), 9, "");
  display.replace(display.find("(default"), display.npos, "(default of views: clip)");
  add_output_space(o, c->write);
  o.group = "Photo of a mirror ball (--from sphere) or by a fisheye lens (--from fisheye)";
  add_circle(o, c->photo);
  o.add("--ball-distance", "R", &c->ball_distance, {BallCamera::nearest, BallCamera::farthest},
        "Camera distance in ball radii, or --ball-fov DEGREES (default: infinite)");
  Option& field = o.add("--ball-fov", "DEGREES", &c->ball_fov, {1.2e-4, 157},
                        "Angle that the ball subtends at the camera, instead of --ball-distance");
  field.excludes = "--ball-distance", field.folded = true;
  o.group = "Camera view (--to perspective, fisheye or cylinder)";
  o.add("--look-at", "X,Y,Z", Triple{&c->look_at}, "World direction at the centre (default: 0,0,1), see also --width");
  o.add("--fov", "DEGREES", &c->fov, {0.01, 360},
        "Field of view (default: perspective 60, cylinder 90, fisheye in or out 180)");
  o.add("--width", "N", &c->width, range_of(limits::picture_width),
        "Width, with --size as height (default: height 480, width by projection)")
      .folded = true;
  add_shard(o, "convert", c->shard);
  add_max_memory(o, c->read);
  return [c, &o](Report& report) {
    c->one_level = o.given("--level");
    refuse_options(o, c->lens.has_value());
    if (c->lens && c->photo.of) throw UsageError("a photo becomes a map first: convert that map to a picture");
    if (c->lens) return run_photograph(*c, report);
    c->convert.samples = c->samples.value_or(1);
    return run(*c, report);
  };
}

}  // namespace tools

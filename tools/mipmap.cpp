#include <fmt/format.h>

#include "colour_options.h"
#include "command.h"
#include "depfile.h"
#include "engine_maps.h"
#include "engine_options.h"
#include "envmap/base/error.h"
#include "envmap/operate/convert.h"
#include "envmap/operate/levels.h"
#include "envmap/operate/measure.h"
#include "shard.h"

namespace tools {
namespace {

using namespace envmap;

struct Options {
  std::string input, output;
  const Engine* engine = nullptr;
  ReadOptions read;
  int levels = 0;  // 0: all.
  bool keep = false;
  Weights weights = Weights::solid_angle;
  WriteOptions write;
  Shard shard;
};

// A part of level 0: the other levels are made when it is joined with the others.
void make_part(Options& o, const EnvironmentMap& map, const Common& common) {
  if (common.json) throw UsageError("--json reports of all levels: leave it out with --shard");
  if (o.keep) throw UsageError("--shard makes level 0 alone, and merge the others anew: leave out --keep");
  o.write.facts["whole-levels"] = std::to_string(o.levels);
  o.write.facts["whole-weights"] = weight_names[static_cast<std::size_t>(o.weights)];
  const Rows rows = rows_of(map);
  write_map(o.output, rows, part_or_whole(o.shard, o.write, rows, digest(map)), {o.input}, "write", common);
}

// The map in the frame that an engine wants, resampled where it stands in another.
EnvironmentMap in_frame(EnvironmentMap map, const Frame& frame, const Common& common) {
  const Frame is = map.frame();
  if (is.projection == frame.projection && is.forward == frame.forward) return map;
  return convert(map, {.to = frame}, progress_line(common, "convert"));
}

int run(Options& o, const Common& common) {
  if (o.keep && o.engine) throw UsageError("--for makes levels anew: leave out --keep");
  if (o.keep && o.read.level > 0) throw UsageError("--keep takes all levels of the input: leave out --level");
  const Stopwatch watch;
  check_report(o.output, common);
  check_files({o.output}, {o.input}, common);
  o.read.all_levels = o.keep;
  choose_working_space(o.read, o.write);
  const EngineMap* engine = o.engine ? &environment_of(*o.engine) : nullptr;
  if (engine) settle(*o.engine, *engine, o.output, o.write);
  Source source = read_map(o.input, o.read, common);
  if (engine) source.map = in_frame(std::move(source.map), engine->frame, common);
  EnvironmentMap& map = source.map;
  o.write.source_depth = source.depth;
  o.write.provenance = source.provenance;
  if (o.keep) o.write.facts = source.facts;
  if (o.shard.part) {
    make_part(o, map, common);
    return 0;
  }
  check_output(o.output, o.write, map.projection(), o.levels != 1 && has_next(map.base()));
  if (o.levels > 0 && map.levels.size() > static_cast<std::size_t>(o.levels))
    map.levels.erase(map.levels.begin() + o.levels, map.levels.end());
  if (o.write.border > 0)
    add_levels_with_border(map.levels, o.write.border, o.weights, o.levels);
  else
    add_levels(map.levels, o.weights, o.levels);
  const std::vector<Rows> rows = mirrored(all_rows_of(map), engine ? engine->mirror : Mirror::none);
  const Written written = write_map(o.output, rows, o.write, {o.input}, "write", common);
  if (engine) tell_frame(o.output, *o.engine, *engine, common);
  if (!common.json) return 0;
  nlohmann::ordered_json report;
  report["input"] = o.input;
  if (engine) add_frame(report, *o.engine, *engine);
  report["weights"] = weight_names[static_cast<std::size_t>(o.weights)];
  for (const Level& level : map.levels)
    report["levels"].push_back({{"face_width", level.width()},
                                {"face_height", level.height()},
                                {"flux_difference", to_json(flux_difference(level, map.base()))}});
  add_written(report, o.output, written);
  report["seconds"] = watch.seconds();
  print_report(report);
  return 0;
}

}  // namespace

Command mipmap_command() {
  return {.name = "mipmap",
          .summary = "Write an environment map with mip levels that keep the light",
          .description =
              "Each level halves each side of the one before, rounded down, to one texel. Every texel is the mean of "
              "what it "
              "covers, weighted by exact solid angle and summed in float64: the flux of every level is that of the "
              "map, and "
              "white stays white. Of texels on the rim of a disc the part inside counts. Beyond the disc of a "
              "paraboloid map "
              "each level goes on with what its other half shows; of sphere and angular maps texels there are 0.\n\n"
              "--for ENGINE resamples the map as 'envmap convert --for' does and gives it levels; those of rough surfaces, which some "
              "engines want instead, 'envmap prefilter --for' makes.\n\n"
              "--weights uniform takes plain means of the image instead, as glGenerateMipmap does: for comparison.\n\n"
              "EXR files hold levels as tiled mip-maps. Other formats take a file for each: put {level} into the name.",
          .examples = {{"envmap mipmap probe.hdr probe.exr", "a tiled EXR file with all levels, for renderers"},
                       {"envmap mipmap cube.exr 'cube_{level}.hdr'", "cube_0.hdr, cube_1.hdr ..."},
                       {"envmap mipmap cube.exr plain.exr --weights uniform && envmap info plain.exr --levels",
                        "how far plain means are off"}},
          .keys = with_frame(with_written({{"input", "text", "INPUT"},
                                {"weights", "text", "solid-angle or uniform"},
                                {"levels[].face_width", "count", "in texels"},
                                {"levels[].face_height", "count", "in texels"},
                                {"levels[].flux_difference", "triple",
                                 "of each channel, relative to level 0: how far the light is off"},
                                {"seconds", "number", "from start to end"}})),
          .reports = true,
          .writes = true,
          .define = [](CLI::App& app, const Common& common) -> std::function<int()> {
            auto o = std::make_shared<Options>();
            app.add_option(
                   "INPUT", o->input,
                   "File to read, '-' for standard input; {face} in the name reads six files, {level} one a level")
                ->required();
            app.add_option(
                   "OUTPUT", o->output,
                   "File to write, '-' for standard output; {face} in the name writes six files, {level} one a level")
                ->required();
            add_engine(app, o->engine,
                       "Make what this engine loads as its environment, with levels: projection, frame, file type and depth; 'list' prints "
                       "the engines");
            app.add_option("--levels", o->levels, "How many, with the map itself (default: down to one texel)")
                ->type_name("N")
                ->check(CLI::Range(1, 32));
            add_choice(app, "--weights", o->weights, joined(weight_names), one_of<Weights>(weight_names),
                       "What texels count for in a mean (default: solid-angle)");
            app.add_flag("--keep", o->keep, "Keep the levels that the input has, and make those that it lacks");
            add_layout(app, "--layout", o->write.layout, "Where the output's cube faces lie (default: column)");
            add_border(app, o->write, "they come round the map as it is, and each level halves with them");
            add_write_options(app, o->write);
            add_shard(app, o->shard);
            add_read_options(app, o->read);
            add_output_space(app, o->write);
            add_max_memory(app, o->read);
            add_repair(app, o->read);
            return [o, &common] { return run(*o, common); };
          }};
}

}  // namespace tools

#include <fmt/format.h>

#include "command.h"
#include "engines/engine_options.h"
#include "envmap/base/error.h"
#include "envmap/engine/baked_maps.h"
#include "envmap/operate/convert.h"
#include "envmap/operate/levels.h"
#include "envmap/operate/measure.h"
#include "maps/colour_and_light_options.h"
#include "maps/map_options.h"
#include "maps/read_and_write_maps.h"
#include "maps/shard_options.h"

namespace tools {
namespace {

using namespace envmap;

struct MipmapRequest {
  std::string input, output;
  const Engine* engine = nullptr;
  ReadOptions read;
  int levels = 0;                        // 0: all.
  bool keep = false, one_level = false;  // --level was given.
  Weights weights = Weights::solid_angle;
  WriteOptions write;
  Shard shard;
};

// A part of level 0: the other levels are made when it is joined with the others.
void make_part(MipmapRequest& o, const EnvironmentMap& map, MirroredAxis mirror) {
  if (settings().json) throw UsageError("--json reports of all levels: leave it out with --shard");
  if (o.keep) throw UsageError("--shard makes level 0 alone, and merge the others anew: remove --keep");
  o.write.facts["whole-levels"] = std::to_string(o.levels);
  o.write.facts["whole-weights"] = weight_names[std::size_t(o.weights)];
  leave_mirror_to_merge(o.write, mirror);
  const Rows rows = rows_of(map);
  write_map(o.output, rows, part_or_whole(o.shard, o.write, rows, digest(map)), "write");
}

// The map in the frame that an engine wants, resampled where it stands in another.
EnvironmentMap in_frame(EnvironmentMap map, const Frame& frame) {
  const Frame is = map.frame();
  if (is.projection == frame.projection && is.forward == frame.forward) return map;
  return convert(map, {.to = frame}, {.progress = progress_line("convert")});
}

// Levels of a lobe must not become plain ones unnoticed.
void settle_chain(MipmapRequest& o, const Source& source) {
  const int has = source.levels;
  const std::string& lobe = source.facts.at("lobe");
  if (!o.keep && !o.one_level)
    warn(fmt::format("{}: has {} levels of {}, and plain levels replace them: use {}--level 0 to confirm", o.input, has,
                     lobe, o.engine || o.shard.part ? "" : "--keep to keep them, or "));
  if (o.keep && o.levels > has)
    warn(
        fmt::format("{}: has {} levels of {}, and plain levels follow them: use --levels {}", o.input, has, lobe, has));
  if (o.keep && o.levels == 0) o.levels = has;
}

int run(MipmapRequest& o, Report& report) {
  if (o.keep && o.engine) throw UsageError("--for makes levels anew: remove --keep");
  if (o.keep && o.read.level > 0) throw UsageError("--keep takes all levels of the input: remove --level");
  o.read.all_levels = o.keep;
  choose_working_space(o.read, o.write);
  if (o.engine) o.engine = &row_for(*o.engine, o.output, o.write);
  const EngineMap* engine = o.engine ? &environment_of(*o.engine) : nullptr;
  if (engine) resolve_for_engine(*o.engine, *engine, o.shard.part ? "" : o.output, o.write);
  const MirroredAxis mirror = engine ? engine->mirror : MirroredAxis::none;
  Source source = read_map(o.input, o.read);
  if (engine) source.map = in_frame(std::move(source.map), engine->frame);
  EnvironmentMap& map = source.map;
  if (is_prefiltered_chain(source)) settle_chain(o, source);
  o.write.source_depth = source.depth;
  o.write.provenance = source.provenance;
  if (o.keep) o.write.facts = source.facts;
  if (o.shard.part) {
    make_part(o, map, mirror);
    return 0;
  }
  check_output(o.output, o.write, map.projection(), o.levels != 1 && has_next(map.base()));
  if (o.levels > 0 && map.levels.size() > std::size_t(o.levels))
    map.levels.erase(map.levels.begin() + o.levels, map.levels.end());
  if (o.write.border > 0)
    add_levels_with_border(map.levels, o.write.border, o.weights, o.levels);
  else
    add_levels(map.levels, o.weights, o.levels);
  const std::vector<Rows> rows = mirrored(all_rows_of(map), mirror);
  record_mirror(o.write.facts, mirror);
  const Written written = write_map(o.output, rows, o.write, "write");
  if (engine)
    tell_frame(o.output, *o.engine, *engine);
  else
    tell_lost_facts(o.output, map.frame(), o.write);
  if (!settings().json) return 0;
  report.put("input", o.input);
  if (engine) add_frame(report, *o.engine, *engine);
  report.put("weights", weight_names[std::size_t(o.weights)]);
  for (const Level& level : map.levels) {
    report.append("levels[]");
    report.put("levels[].face_width", level.width());
    report.put("levels[].face_height", level.height());
    report.put("levels[].flux_difference", Direction(flux_difference(level, map.base())));
  }
  report.put_written(o.output, written);
  report.put_seconds();
  return 0;
}

}  // namespace

Action define_mipmap(Options& o) {
  const auto r = std::make_shared<MipmapRequest>();
  o.reads("INPUT", r->input, "File to read, or '-' for stdin ({face}: six files, {level}: one per level)").required =
      true;
  o.writes("OUTPUT", r->output, "File to write, or '-' for stdout ({face} and {level} as for INPUT)").required = true;
  o.group = groups::output_map;
  o.add("--levels", "N", &r->levels, range_of(limits::levels),
        "Number of levels, the map included (default: down to one texel)");
  o.add("--weights", one_of(r->weights, weight_names), "Weights of texels in a mean: {} (default: solid-angle)");
  o.flag("--keep", r->keep, "Keep the levels of the input, and compute the missing ones");
  add_engine(o, r->engine, "Projection, orientation and file format of an engine ('list' lists engines)");
  add_layout(o, "--layout", r->write.layout, "Cube faces: {} (default: column)");
  add_faces(o, r->write);
  add_border(o, r->write, "added outside");
  add_write_options(o, r->write);
  add_read_options(o, r->read);
  add_repair(o, r->read);
  add_output_space(o, r->write);
  add_shard(o, "mipmap", r->shard);
  add_max_memory(o, r->read);
  return [r, &o](Report& report) {
    r->one_level = o.given("--level");
    return run(*r, report);
  };
}

}  // namespace tools

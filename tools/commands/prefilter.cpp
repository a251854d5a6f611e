#include "envmap/prefilter/prefilter.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "cli/console.h"
#include "command.h"
#include "engines/engine_options.h"
#include "envmap/base/error.h"
#include "envmap/base/words.h"
#include "envmap/engine/baked_maps.h"
#include "envmap/engine/level_roughness.h"
#include "envmap/io/files/face_names.h"
#include "envmap/io/read_lobe.h"
#include "envmap/io/texels/rounding.h"
#include "envmap/io/write_table.h"
#include "envmap/map/atlas.h"
#include "envmap/maths/portable.h"
#include "envmap/prefilter/brdf_table.h"
#include "envmap/projection/matching_size.h"
#include "maps/colour_and_light_options.h"
#include "maps/depfile.h"
#include "maps/read_and_write_maps.h"
#include "maps/shard_options.h"

namespace tools {
namespace {

using namespace envmap;

struct Request {
  std::string input, output, table, lobe_table;
  ReadOptions read;
  WriteOptions write;
  const Engine* engine = nullptr;
  std::optional<LobeShape> lobe;
  std::optional<Lobe> tabulated;         // Of `lobe_table`.
  LobeShape shape = LobeShape::diffuse;  // Of `lobe`, the table, or the engine's map.
  PrefilterOptions map;
  std::optional<int> size, levels;
  bool one_level = false;  // --level was given.
  int table_size = 128;
  std::optional<Projection> to;
  std::optional<Forward> forward;
  std::optional<double> exponent, roughness, scale, max_error;
  std::vector<double> exponents, roughnesses;
  Shard shard;
};

std::string_view name_of(LobeShape shape) { return lobe_shape_names[std::size_t(shape)]; }
bool has_exponent(LobeShape shape) { return shape == LobeShape::phong || shape == LobeShape::blinn_phong; }
bool has_roughness(LobeShape shape) { return shape == LobeShape::ggx || shape == LobeShape::charlie; }

// Of level k of a chain of Phong lobes: a quarter of that before, as texels have four times the area, or more of it, so
// that the last is no less than 1, Lambert's cosine: below, lobes break off at the horizon, and see no more of the map.
double exponent_of(double first, int k, int levels) {
  const double left = first / portable::exp2(2 * (levels - 1));
  if (left >= 1 || k == 0) return first / portable::exp2(2 * k);
  return first <= 1 ? first : portable::pow(first, 1 - double(k) / (levels - 1));
}

// What to make for each level: as many as were asked for, or as parameters were given.
std::vector<PrefilterOptions> levels_of(const Request& o) {
  const int levels = o.levels.value_or(1);
  std::vector<double> parameters = has_exponent(o.shape) ? o.exponents : o.roughnesses;
  const auto only = [&](bool given, const char* option, bool has, const char* lobes) {
    if (given && !has) throw UsageError(fmt::format("{} is for --lobe {}", option, lobes));
  };
  only(o.exponent || !o.exponents.empty(), o.exponent ? "--exponent" : "--exponents", has_exponent(o.shape),
       "phong and blinn-phong");
  only(o.roughness || !o.roughnesses.empty(), o.roughness ? "--roughness" : "--roughnesses", has_roughness(o.shape),
       "ggx and charlie");
  if (!parameters.empty() && (o.exponent || o.roughness))
    throw UsageError(o.exponent ? "--exponent and --exponents: give one of them"
                                : "--roughness and --roughnesses: give one of them");
  if (o.shape == LobeShape::diffuse && levels > 1) throw UsageError("--levels: a diffuse map has one");
  if (o.tabulated && levels > 1) throw UsageError("--levels: a map of a table has one");
  if (!parameters.empty() && levels > 1 && levels != int(parameters.size()))
    throw UsageError(fmt::format("--levels {}: {} parameters are given", levels, parameters.size()));
  if (parameters.empty()) {
    for (int k = 0; k < levels; ++k) {
      if (has_exponent(o.shape))
        parameters.push_back(exponent_of(o.exponent.value_or(0), k, levels));
      else if (o.roughness || levels == 1)
        parameters.push_back(o.roughness.value_or(0));
      else
        parameters.push_back(double(k) / (levels - 1));
    }
    if (has_exponent(o.shape) && !o.exponent)
      throw UsageError(fmt::format("--lobe {}: needs --exponent M or --exponents A,B,...", name_of(o.shape)));
    if (has_roughness(o.shape) && !o.roughness && levels == 1)
      throw UsageError(
          fmt::format("--lobe {}: needs --roughness R, --roughnesses A,B,... or --levels N", name_of(o.shape)));
    if (o.roughness && levels > 1) throw UsageError("--roughness is for one map; --roughnesses A,B,... for a chain");
  }
  if (const std::size_t possible = std::bit_width(unsigned(o.map.size));
      parameters.size() > possible && !has_level(o.output))
    throw UsageError(fmt::format("--size {} has at most {} levels, not {}", o.map.size, possible, parameters.size()));
  std::vector<PrefilterOptions> all;
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    PrefilterOptions p = o.map;
    if (o.tabulated)
      p.lobe = *o.tabulated;
    else if (o.shape != LobeShape::diffuse)
      p.lobe = Lobe(o.shape, parameters[k]);
    p.size = size_inside_border(std::max(1, o.map.size >> k), o.write);
    check_method(p);
    all.push_back(p);
  }
  return all;
}

std::string words(const Lobe& lobe) {
  const std::string_view name = name_of(lobe.shape());
  return std::isnan(lobe.parameter()) ? std::string(name) : fmt::format("{} {:g}", name, lobe.parameter());
}

// What the file says of its lobes: one number for each level.
Facts record(const std::vector<PrefilterOptions>& levels) {
  const PrefilterOptions& first = levels.front();
  const LobeShape shape = first.lobe.shape();
  Facts facts{{"lobe", std::string(name_of(shape))}};
  const std::string numbers =
      joined(levels, ",", [](const PrefilterOptions& p) { return fmt::format("{:g}", p.lobe.parameter()); });
  if (has_exponent(shape)) facts["exponent"] = numbers;
  if (has_roughness(shape)) facts["roughness"] = numbers;
  if (first.scale) facts["scale"] = fmt::format("{:g}", *first.scale);
  return facts;
}

// The file does not hold what --max-error asks for: says which depth does.
[[noreturn]] void refuse(const Request& o, const AccuracyError& e, const std::string& what) {
  const bool too_bright = e.remedy() == Remedy::clamp_or_dim;
  std::string depth = depth_for_error(o.output, o.write, too_bright ? below_half : *o.max_error);
  if (depth.empty()) depth = "an .exr file with --depth float";
  const std::optional<Rounding> rounding = rounding_of(o.output, o.write);
  const bool exact = rounding && !rounding->read_back;
  throw AccuracyError(fmt::format("{}: cannot meet --max-error {:g}: {}: {}", o.output, *o.max_error, what,
                                  exact ? "raise --max-error" : "use " + depth));
}

void tell(const PrefilterOptions& p, const LevelInFile& made) {
  const Prefiltered& done = made.done;
  std::string line = fmt::format("{}, {}: {}, {:.3f} s", words(p.lobe), p.size, method_name(done), done.seconds);
  if (done.error > 0)
    line += fmt::format(", {} to {:.1e}", made.sampled ? "the texels measured" : "every texel", done.error);
  if (done.method != Method::exact && done.exact > 0) line += fmt::format(", {} summed exactly", done.exact);
  note(line);
  std::string work;
  for (const StepCount& s : done.work) work += fmt::format("{}{} {}", work.empty() ? "" : ", ", s.step, s.count);
  if (!work.empty()) detail("steps: " + work);
}

void add_level(Report& report, const PrefilterOptions& p, const LevelInFile& made) {
  const Prefiltered& done = made.done;
  report.append("levels[]");
  report.put("levels[].parameter", std::isnan(p.lobe.parameter()) ? ReportValue(nullptr) : p.lobe.parameter());
  report.put("levels[].size", p.size);
  report.put("levels[].method", method_name(done));
  report.put("levels[].seconds", done.seconds);
  report.put("levels[].max", done.method == Method::exact && done.error == 0 ? ReportValue(nullptr) : done.error);
  report.put("levels[].exact", done.exact);
}

// Of Charlie its own table; of GGX, and of the diffuse map that goes with it, GGX's.
void write_brdf_table(const Request& o) {
  const bool sheen = o.lobe == LobeShape::charlie;
  const std::vector<Colour> table =
      (sheen ? sheen_table : brdf_table)(o.table_size, {.progress = progress_line("brdf table")});
  write_table(o.table, table, o.table_size, sheen ? "charlie" : "ggx", settings().commit);
}

void check_brdf_table(const Request& o) {
  if (o.table.empty()) return;
  if (!o.lobe_table.empty()) throw UsageError("--brdf-table: a tabulated lobe has no table: remove --brdf-table");
  if (o.lobe && has_exponent(*o.lobe))
    throw UsageError(fmt::format("--brdf-table: --lobe {} has no table: {}", name_of(*o.lobe),
                                 o.input.empty() ? "choose --lobe ggx or --lobe charlie" : "remove --brdf-table"));
  check_table(o.table);
}

int table_alone(const Request& o) {
  open_depfile(1);
  write_brdf_table(o);
  return 0;
}

// What the file is asked to hold, less what its depth rounds by.
void leave_to_prefilter(Request& o, const ErrorBudget& error) {
  try {
    if (o.max_error) o.map.max_error = left_to_prefilter(error);
  } catch (const AccuracyError& e) {
    refuse(o, e, e.what());
  }
}

std::vector<int> sizes_of(const std::vector<PrefilterOptions>& levels) {
  std::vector<int> sizes;
  for (const PrefilterOptions& p : levels) sizes.push_back(p.size);
  return sizes;
}

// Of each level, what --shard leaves to this run.
void choose_rows(const Request& o, const std::optional<Rounding>& rounding, const WriteOptions& how,
                 std::vector<PrefilterOptions>& wanted) {
  if (!o.shard.part) return;
  if (!o.table.empty()) throw UsageError("--shard: use a separate command for --brdf-table");
  if (o.max_error && (!rounding || rounding->read_back))
    throw UsageError(
        "--shard: --max-error needs --depth float, because the rounding of other depths depends on the whole map");
  const Grid grid = part_grid(o.write, o.map.to);
  for (std::size_t k = 0; k < wanted.size(); ++k) wanted[k].rows = shown_rows(grid, wanted[k].size, how.rows[k]);
}

// What an engine's row settles: the frame and the file, and the roughness of its levels where no others were asked for.
const EngineMap* resolve_engine(Request& o) {
  if (!o.engine) return nullptr;
  if (o.tabulated) throw UsageError("--for: engines look for the lobes that they name: remove --lobe-table");
  o.engine = &row_for(*o.engine, o.output, o.write);
  const EngineMap& map = prefiltered_of(*o.engine, o.lobe == LobeShape::diffuse);
  if (!map.chain && map.diffuse == 0 && !o.lobe)
    throw UsageError(
        fmt::format("--for {0}: {1} makes rough and diffuse light itself: use 'envmap bake --for {0}', or "
                    "name a --lobe",
                    o.engine->name, o.engine->title));
  resolve_for_engine(*o.engine, map, o.shard.part ? "" : o.output, o.to, o.forward, o.write);
  if (map.diffuse > 0 && !o.size) o.size = map.diffuse;
  if (!map.chain) return &map;
  if (o.scale)
    throw UsageError(fmt::format("--for {}: its levels keep white as it is: remove --scale", o.engine->name));
  if (!o.size) o.size = map.chain->size;
  o.shape = o.lobe.value_or(LobeShape::ggx);
  if (o.shape == LobeShape::ggx && !o.roughness && o.roughnesses.empty())
    o.roughnesses = level_roughnesses(map, *o.size, o.levels, "--size");
  return &map;
}

// Sizes and frame, now that the source is known.
void choose_frame(Request& o, const EnvironmentMap& source) {
  o.map.size = o.size                          ? *o.size
               : o.shape == LobeShape::diffuse ? matching_size(Projection::cube, 64, o.map.to)
                                               : matching_size(source.projection(), source.base().height(), o.map.to);
  o.map.forward = has_forward(o.map.to) ? o.forward.value_or(Forward::plus_z) : Forward::plus_z;
}

// A level as the file will hold it. A mirror's level of an engine's chain is the environment as `convert` makes it:
// what the engine shows is then no sharper than its texels.
LevelInFile make_one(const Prefilterer& prepared, const EngineMap* engine, const EnvironmentMap& source,
                     const ErrorBudget& budget, const PrefilterOptions& wanted) {
  if (engine && wanted.lobe.is_mirror())
    return resample_level(source, {wanted.to, wanted.forward}, wanted.size, budget, settings().verbose, wanted.rows);
  return make_level(prepared, wanted, budget, settings().verbose, progress_line("prefilter " + words(wanted.lobe)));
}

EnvironmentMap make_levels(const Request& o, const EngineMap* engine, const EnvironmentMap& source,
                           const Prefilterer& prepared, const ErrorBudget& budget,
                           const std::vector<PrefilterOptions>& wanted, Report& report) {
  if (const EnvironmentMap& cube = prepared.source(); settings().verbose && &cube != &source)
    note(fmt::format(
        "{}: prefiltered as the cube of {} that 'convert --filter area' makes of it; errors count from that", o.input,
        cube.base().height()));
  EnvironmentMap made{.levels = {}, .forward = o.map.forward};
  for (const PrefilterOptions& p : wanted) {
    if (!p.rows.empty() && std::ranges::find(p.rows, 1) == p.rows.end()) {  // Another part has them all.
      made.levels.emplace_back(p.to, p.size);
      continue;
    }
    try {
      LevelInFile level = make_one(prepared, engine, source, budget, p);
      tell(p, level);
      add_level(report, p, level);
      if (level.rounded > 0 && settings().verbose)
        note(fmt::format("{}: in the file as {}", words(p.lobe), rounding_words(*budget.rounding, level.rounded)));
      made.levels.push_back(std::move(level.done.map.base()));
    } catch (const AccuracyError& e) {
      refuse(o, e, fmt::format("{}: {}", words(p.lobe), e.what()));
    }
  }
  return made;
}

// How to write the map, or this run's part of it. The first part has what the file holds beside texels.
WriteOptions options_of(const Request& o, const Source& source, const Prefilterer& prepared, const EngineMap* engine,
                        const std::vector<PrefilterOptions>& levels) {
  WriteOptions how = o.write;
  how.facts = record(levels);
  how.provenance = source.provenance;
  if (o.scale) how.provenance.white_luminance.reset();
  if (engine && (!o.shard.part || o.shard.part->index == 1))
    how.pairs = irradiance_pairs(*engine, source.map, prepared, progress_line("spherical harmonics"));
  if (!o.shard.part) {
    if (engine) record_mirror(how.facts, engine->mirror);
    return how;
  }
  if (o.max_error) how.facts["whole-max-error"] = "yes";
  if (engine) leave_mirror_to_merge(how, engine->mirror);
  return part_or_whole(o.shard, how, o.map.to, sizes_of(levels), digest(source.map));
}

void check_request(const Request& o) {
  if (o.input.empty() != o.output.empty() || (o.input.empty() && o.table.empty()))
    throw UsageError("needs INPUT and OUTPUT, or only --brdf-table FILE");
  if (settings().json && o.input.empty()) throw UsageError("--json: needs INPUT and OUTPUT");
  check_brdf_table(o);
}

// What options say before the input is known: the lobe, the frame and the file, also those that an engine wants.
const EngineMap* resolve_options(Request& o) {
  choose_working_space(o.read, o.write);
  if (out_of_working(o.write.colour).apply)
    throw UsageError("--output-space: must be a linear space for prefiltered light");
  if (!has_forward(o.to.value_or(Projection::cube))) o.read.assumed_forward = o.forward;
  o.shape = o.lobe.value_or(LobeShape::diffuse);
  if (!o.lobe_table.empty()) o.tabulated = read_lobe(o.lobe_table), o.shape = LobeShape::table;
  const EngineMap* engine = resolve_engine(o);
  o.map.to = o.to.value_or(Projection::cube);
  o.map.scale = o.scale;
  check_output(o.shard.whole(o.output), o.write, o.map.to);
  return engine;
}

Source read_source(const Request& o) {
  Source source = read_map(o.input, o.read);
  if (is_prefiltered_chain(source) && !o.one_level)
    warn(
        fmt::format("{}: has {} levels of {}, and only level 0 is filtered: use the map that they were made of, or "
                    "--level 0 to confirm",
                    o.input, source.levels, source.facts.at("lobe")));
  return source;
}

int run(Request& o, Report& report) {
  check_request(o);
  if (o.input.empty()) return table_alone(o);
  const EngineMap* engine = resolve_options(o);
  const MirroredAxis mirror = engine ? engine->mirror : MirroredAxis::none;
  const Source source = read_source(o);
  choose_frame(o, source.map);
  o.write.source_depth = is_integer(source.depth) ? Depth::half : source.depth;
  const ErrorBudget budget{o.max_error, mirrored(rounding_of(o.output, o.write), mirror)};
  leave_to_prefilter(o, budget);
  std::vector<PrefilterOptions> wanted = levels_of(o);
  const Prefilterer prepared(borrowed(source.map));
  const WriteOptions how = options_of(o, source, prepared, engine, wanted);
  choose_rows(o, budget.rounding, how, wanted);
  check_output(o.output, how, o.map.to, wanted.size() > 1);

  report.put("input", o.input);
  report.put("lobe", name_of(o.shape));
  report.put("max_error", o.max_error.value_or(o.map.max_error));
  if (engine) add_frame(report, *o.engine, *engine);
  const EnvironmentMap made = make_levels(o, engine, source.map, prepared, budget, wanted, report);
  const std::vector<Rows> rows = mirrored(all_rows_of(made), o.shard.part ? MirroredAxis::none : mirror);
  report.put_written(o.output, write_map(o.output, rows, how, "write"));
  if (!o.table.empty()) write_brdf_table(o);
  if (engine)
    tell_frame(o.output, *o.engine, *engine);
  else
    tell_lost_facts(o.output, made.frame(), o.write);
  if (const std::string words = equal_brightest("prefilter", o.input, source.map); !words.empty()) note(words);
  report.put_seconds();
  return 0;
}

}  // namespace

Action define_prefilter(Options& o) {
  const auto r = std::make_shared<Request>();
  o.reads("INPUT", r->input, "File to read, or '-' for stdin ({face}: six files, {level}: one per level)");
  o.writes("OUTPUT", r->output, "File to write, or '-' for stdout ({face} and {level} as for INPUT)");
  o.group = "Lobe and levels";
  o.add("--lobe", one_of(r->lobe, parametric_lobe_names), "{} (default: diffuse, or the engine's)");
  Option& table = o.add("--lobe-table", "FILE", &r->lobe_table, "A lobe by cosines and values, or a MERL material");
  table.file = File::input, table.excludes = "--lobe";
  o.add("--roughness", "R", &r->roughness, range_of(limits::roughness),
        "Perceptual roughness of ggx and charlie, 0 to 1");
  o.add("--exponent", "M", &r->exponent, range_of(limits::exponent), "Exponent of phong and blinn-phong, 0 to 1e9");
  o.add("--levels", "N", &r->levels, {1, 17}, "Levels of the chain (default: 1; with --for, the engine's number)");
  o.add("--roughnesses", "R,...", &r->roughnesses, range_of(limits::roughness), "Roughness of each level");
  o.add("--exponents", "M,...", &r->exponents, range_of(limits::exponent), "Exponent of each level");
  o.add("--scale", "K", &r->scale, range_of(limits::scale), "Multiply the map by K instead of keeping white at 1");
  add_engine(o, r->engine, "Levels, orientation and file format of an engine ('list' lists engines)");
  o.group = groups::output_map;
  add_projection(o, "--to PROJECTION", r->to, "{} (default: cube)");
  add_size(o, &r->size, "Height of a face (default: diffuse 64 per cube face; others the engine's or input's)");
  add_forward(o, "--forward AXIS", r->forward, "Axis at the centre of latlong and angular maps: {} (default: +z)");
  add_layout(o, "--layout", r->write.layout, "Cube faces: {} (default: column)");
  add_faces(o, r->write);
  add_border(o, r->write, "part of --size");
  o.group = groups::quality;
  o.add("--max-error", "E", &r->max_error, {1e-7, 10},
        "Largest error of a texel, rounding included (default: 1e-3 + rounding)");
  o.add("--method", one_of(r->map.method, method_names), "{} (default: auto)").former = {
      former_name_of_treecode, method_names[std::size_t(Method::treecode)]};
  add_write_options(o, r->write);
  o.group = "BRDF table";
  o.add("--brdf-table", "FILE", &r->table,
        "Write the split-sum table of ggx or the sheen albedo of charlie (.exr, .hdr or .tif)")
      .file = File::output;
  o.add("--table-size", "N", &r->table_size, range_of(limits::table_size),
        "Width and height of the table (default: 128)")
      .needs = "--brdf-table";
  add_read_options(o, r->read);
  add_repair(o, r->read);
  add_output_space(o, r->write);
  add_shard(o, "prefilter", r->shard);
  add_max_memory(o, r->read);
  return [r, &o](Report& report) {
    r->one_level = o.given("--level");
    return run(*r, report);
  };
}

}  // namespace tools

#include "envmap/prefilter/prefilter.h"

#include <fmt/format.h>

#include <cmath>

#include "colour_options.h"
#include "command.h"
#include "costs_file.h"
#include "depfile.h"
#include "engine_maps.h"
#include "engine_options.h"
#include "envmap/base/error.h"
#include "envmap/io/rounding.h"
#include "envmap/io/write_table.h"
#include "envmap/maths/portable.h"
#include "envmap/map/page.h"
#include "envmap/prefilter/brdf_table.h"
#include "shard.h"

namespace tools {
namespace {

using namespace envmap;

struct Options {
  std::string input, output, table, costs;
  ReadOptions read;
  WriteOptions write;
  const Engine* engine = nullptr;
  std::optional<Shape> lobe;
  Prefilter map;
  std::optional<int> size, levels;
  int table_size = 128;
  std::optional<Projection> to;
  std::optional<Forward> forward;
  std::optional<double> exponent, roughness, scale, max_error;
  std::vector<double> exponents, roughnesses;
  Shard shard;
};

std::string_view name_of(Shape shape) { return shape_names[static_cast<std::size_t>(shape)]; }
bool has_exponent(Shape shape) { return shape == Shape::phong || shape == Shape::blinn_phong; }
bool has_roughness(Shape shape) { return shape == Shape::ggx || shape == Shape::charlie; }

// Of level k of a chain of Phong lobes: a quarter of that before, as texels have four times the area, or more of it, so that
// the last is no less than 1, Lambert's cosine: below, lobes break off at the horizon, and see no more of the map.
double exponent_of(double first, int k, int levels) {
  const double left = first / portable::exp2(2 * (levels - 1));
  if (left >= 1 || k == 0) return first / portable::exp2(2 * k);
  return first <= 1 ? first : portable::pow(first, 1 - static_cast<double>(k) / (levels - 1));
}

// What to make for each level: as many as were asked for, or as parameters were given.
std::vector<Prefilter> levels_of(const Options& o) {
  const int levels = o.levels.value_or(1);
  std::vector<double> parameters = has_exponent(o.map.shape) ? o.exponents : o.roughnesses;
  const auto only = [&](bool given, const char* option, bool has, const char* lobes) {
    if (given && !has) throw UsageError(fmt::format("{} is for --lobe {}", option, lobes));
  };
  only(o.exponent || !o.exponents.empty(), o.exponent ? "--exponent" : "--exponents", has_exponent(o.map.shape),
       "phong and blinn-phong");
  only(o.roughness || !o.roughnesses.empty(), o.roughness ? "--roughness" : "--roughnesses", has_roughness(o.map.shape),
       "ggx and charlie");
  if (o.map.shape == Shape::charlie && o.map.method == Method::spectral)
    throw UsageError("--method spectral is for lobes that fall with the angle, not for charlie; --method auto");
  if (!parameters.empty() && (o.exponent || o.roughness))
    throw UsageError(o.exponent ? "--exponent and --exponents: give one of them"
                                : "--roughness and --roughnesses: give one of them");
  if (o.map.shape == Shape::diffuse && levels > 1) throw UsageError("--levels: a diffuse map has one");
  if (!parameters.empty() && levels > 1 && levels != static_cast<int>(parameters.size()))
    throw UsageError(fmt::format("--levels {}: {} parameters are given", levels, parameters.size()));
  if (parameters.empty()) {
    for (int k = 0; k < levels; ++k) {
      if (has_exponent(o.map.shape))
        parameters.push_back(exponent_of(o.exponent.value_or(0), k, levels));
      else if (o.roughness || levels == 1)
        parameters.push_back(o.roughness.value_or(0));
      else
        parameters.push_back(static_cast<double>(k) / (levels - 1));
    }
    if (has_exponent(o.map.shape) && !o.exponent)
      throw UsageError(fmt::format("--lobe {}: say --exponent M or --exponents A,B,...", name_of(o.map.shape)));
    if (has_roughness(o.map.shape) && !o.roughness && levels == 1)
      throw UsageError(fmt::format("--lobe {}: say --roughness R, --roughnesses A,B,... or --levels N", name_of(o.map.shape)));
    if (o.roughness && levels > 1) throw UsageError("--roughness is for one map; --roughnesses A,B,... for a chain");
  }
  std::vector<Prefilter> all;
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    Prefilter p = o.map;
    p.parameter = parameters[k];
    p.size = size_inside_border(std::max(1, o.map.size >> k), o.write);
    lobe_of(p);
    all.push_back(p);
  }
  return all;
}

std::string words(const Prefilter& p) {
  return p.shape == Shape::diffuse ? std::string(name_of(p.shape)) : fmt::format("{} {:g}", name_of(p.shape), p.parameter);
}

// What the file says of its lobes: one number for each level.
Facts record(const std::vector<Prefilter>& levels) {
  const Prefilter& first = levels.front();
  Facts facts{{"lobe", std::string(name_of(first.shape))}};
  std::string numbers;
  for (const Prefilter& p : levels) numbers += (numbers.empty() ? "" : ",") + fmt::format("{:g}", p.parameter);
  if (has_exponent(first.shape)) facts["exponent"] = numbers;
  if (has_roughness(first.shape)) facts["roughness"] = numbers;
  if (first.scale) facts["scale"] = fmt::format("{:g}", *first.scale);
  return facts;
}

// The file does not hold what --max-error asks for: says which depth does.
[[noreturn]] void refuse(const Options& o, const std::string& what) {
  const std::string depth = depth_that_holds(o.output, o.write, *o.max_error);
  throw NotReached(fmt::format("{}: --max-error {:g} is not held by {}; by {} it is", o.output, *o.max_error, what,
                               depth.empty() ? ".exr of --depth float" : depth));
}

void report(const Prefilter& p, const MadeLevel& made, const Common& common) {
  const Prefiltered& done = made.done;
  std::string line = fmt::format("{}, {}: {}, {:.3f} s", words(p), p.size, made.method(), done.seconds);
  if (done.method != Method::exact) line += fmt::format(", every texel to {:.1e}", done.error);
  if (done.method != Method::exact && done.exact > 0) line += fmt::format(", {} summed exactly", done.exact);
  note(common, line);
}

nlohmann::ordered_json report_of(const Prefilter& p, const MadeLevel& made) {
  const Prefiltered& done = made.done;
  nlohmann::ordered_json level{{"parameter", nullptr}, {"size", p.size}, {"method", made.method()},
                               {"seconds", done.seconds}, {"max", nullptr}, {"exact", done.exact}};
  if (p.shape != Shape::diffuse) level["parameter"] = p.parameter;
  if (done.method != Method::exact) level["max"] = done.error;
  return level;
}

// Of Charlie its own table; of GGX, and of the diffuse map that goes with it, GGX's.
void write_brdf_table(const Options& o, const Common& common) {
  const auto table = o.lobe == Shape::charlie ? sheen_table : brdf_table;
  write_table(o.table, table(o.table_size, progress_line(common, "brdf table")), o.table_size, common.commit);
}

void check_brdf_table(const Options& o) {
  if (o.table.empty()) return;
  if (o.lobe && has_exponent(*o.lobe))
    throw UsageError(fmt::format("--brdf-table: --lobe {} has no table: {}", name_of(*o.lobe),
                                 o.input.empty() ? "choose --lobe ggx or --lobe charlie" : "leave out --brdf-table"));
  check_table(o.table);
}

int table_alone(const Options& o, const Common& common) {
  check_files({o.table}, {}, common);
  const auto depfile = open_depfile({o.table}, {}, common);
  write_brdf_table(o, common);
  if (depfile) depfile->commit();
  return 0;
}

// What the file is asked to hold, less what its depth rounds by.
void leave_to_prefilter(Options& o, const FileError& error) {
  try {
    if (o.max_error) o.map.max_error = left_to_prefilter(error);
  } catch (const NotReached& e) {
    refuse(o, e.what());
  }
}

// Of the one map that is made, what --shard leaves to this run.
void choose_rows(const Options& o, const std::optional<Rounding>& rounding, std::vector<Prefilter>& wanted) {
  if (!o.shard.part) return;
  if (wanted.size() > 1) throw UsageError("--shard: a chain is made a level at a time");
  if (!o.table.empty()) throw UsageError("--shard: --brdf-table is made by itself");
  if (o.max_error && (!rounding || rounding->read_back))
    throw UsageError("--shard: --max-error needs --depth float, since what a depth rounds by is known of the whole map alone");
  Prefilter& p = wanted.front();
  const Grid grid = part_grid(o.write, p.to);
  p.rows = shown_rows(grid, p.size, band_of(grid.rows * p.size, *o.shard.part));
}

// What an engine's row settles: the frame and the file, and the roughness of its levels where no others were asked for.
const EngineMap* settle_engine(Options& o) {
  if (!o.engine) return nullptr;
  const EngineMap& map = prefiltered_of(*o.engine, o.lobe == Shape::diffuse);
  settle(*o.engine, map, o.output, o.to, o.forward, o.write);
  if (map.diffuse > 0 && !o.size) o.size = map.diffuse;
  if (!map.chain) return &map;
  if (o.scale) throw UsageError(fmt::format("--for {}: its levels keep white as it is: leave out --scale", o.engine->name));
  if (!o.size) o.size = map.chain->size;
  o.map.shape = o.lobe.value_or(Shape::ggx);
  if (o.map.shape == Shape::ggx && !o.roughness && o.roughnesses.empty())
    o.roughnesses = roughnesses_of(map, *o.size, o.levels, "--size");
  return &map;
}

// Sizes and frame, now that the source is known.
void choose_frame(Options& o, const EnvironmentMap& source) {
  o.map.size = o.size ? *o.size
               : o.map.shape == Shape::diffuse
                   ? matching_size(Projection::cube, 64, o.map.to)
                   : matching_size(source.projection(), source.base().height(), o.map.to);
  o.map.forward = has_forward(o.map.to) ? o.forward.value_or(Forward::plus_z) : Forward::plus_z;
}

struct Making {
  const Options& o;
  const EngineMap* engine;
  const EnvironmentMap& source;
  FileError error;
  const Common& common;
};

// All levels. A mirror's level of an engine's chain is the environment as `convert` makes it: what the engine shows is then no
// sharper than its texels.
EnvironmentMap make_levels(const Making& m, const std::vector<Prefilter>& wanted, nlohmann::ordered_json& told) {
  const Options& o = m.o;
  const PrefilterSource prepared(m.source);
  if (const EnvironmentMap& cube = prepared.source(); m.common.verbose && &cube != &m.source)
    note(m.common, fmt::format("{}: prefiltered as the cube of {} that 'convert --filter area' makes of it; errors count from that",
                               o.input, cube.base().height()));
  EnvironmentMap made{.levels = {}, .forward = o.map.forward};
  for (const Prefilter& p : wanted) {
    try {
      MadeLevel level = m.engine && is_mirror(p)
                            ? resample_level(m.source, {p.to, p.forward}, p.size, m.error, m.common.verbose)
                            : make_level(prepared, p, m.error, m.common.verbose, progress_line(m.common, "prefilter " + words(p)));
      report(p, level, m.common);
      told["levels"].push_back(report_of(p, level));
      if (level.rounded > 0 && m.common.verbose)
        note(m.common, fmt::format("{}: in the file as {}", words(p), rounding_words(*m.error.rounding, level.rounded)));
      made.levels.push_back(std::move(level.done.map.base()));
    } catch (const NotReached& e) {
      refuse(o, fmt::format("{} in {}", words(p), e.what()));
    }
  }
  return made;
}

int run(Options& o, const Common& common) {
  if (o.input.empty() != o.output.empty() || (o.input.empty() && o.table.empty()))
    throw UsageError("name an INPUT and an OUTPUT, or --brdf-table FILE alone");
  const Stopwatch watch;
  check_report(o.output, common);
  if (common.json && o.input.empty()) throw UsageError("--json reports of a map: name an INPUT and an OUTPUT");
  check_brdf_table(o);
  if (o.input.empty()) return table_alone(o, common);
  check_files({o.output, o.table}, {o.input}, common);
  choose_working_space(o.read, o.write);
  if (out_of_working(o.write.colour).apply) throw UsageError("--output-space: light that was averaged is written to a linear space");
  o.read.assumed_forward = o.forward;
  o.map.shape = o.lobe.value_or(Shape::diffuse);
  const EngineMap* engine = settle_engine(o);
  o.map.to = o.to.value_or(Projection::cube);
  o.map.scale = o.scale;
  o.map.costs = read_costs(o.costs, common);
  check_output(o.output, o.write, o.map.to);
  const Source source = read_map(o.input, o.read, common);
  choose_frame(o, source.map);
  o.write.source_depth = is_integer(source.depth) ? Depth::half : source.depth;
  const Mirror mirror = engine ? engine->mirror : Mirror::none;
  const FileError error{o.max_error, mirrored(rounding_of(o.output, o.write), mirror), o.map.costs};
  leave_to_prefilter(o, error);
  std::vector<Prefilter> wanted = levels_of(o);
  choose_rows(o, error.rounding, wanted);
  check_output(o.output, o.write, o.map.to, wanted.size() > 1);

  nlohmann::ordered_json told{{"input", o.input},
                              {"lobe", name_of(o.map.shape)},
                              {"max_error", o.max_error.value_or(o.map.max_error)}};
  if (engine) add_frame(told, *o.engine, *engine);
  const EnvironmentMap made = make_levels({o, engine, source.map, error, common}, wanted, told);
  o.write.facts = record(wanted);
  o.write.provenance = source.provenance;
  if (o.scale) o.write.provenance.white_luminance.reset();
  if (engine) o.write.pairs = irradiance_pairs(*engine, source.map, common);
  const auto depfile = open_depfile({o.output, o.table}, {o.input}, common, static_cast<int>(made.levels.size()));
  if (o.max_error && o.shard.part) o.write.facts["whole-max-error"] = "yes";
  const std::vector<Rows> rows = mirrored(all_rows_of(made), mirror);
  const WriteOptions how = part_or_whole(o.shard, o.write, rows.front(), o.shard.part ? digest(source.map) : "");
  add_written(told, o.output, write_one_map(o.output, rows, how, "write", common));
  if (!o.table.empty()) write_brdf_table(o, common);
  if (depfile) depfile->commit();
  if (engine) tell_frame(o.output, *o.engine, *engine, common);
  told["seconds"] = watch.seconds();
  if (common.json) print_report(told);
  return 0;
}

}  // namespace

Command prefilter_command() {
  return {
      .name = "prefilter",
      .summary = "Blur a map by a lobe: diffuse, Phong, Blinn-Phong, GGX and sheen maps for renderers",
      .description =
          "Makes the map of what a surface reflects: for each direction, the environment weighted by the lobe of a "
          "material round it. Radiance is taken as constant over each texel of the input.\n\n"
          "diffuse: E(n) = k/pi integral L(l) cos(n,l) dl, the irradiance over pi; a diffuse surface of albedo a has "
          "the "
          "radiance a E. phong: R(r) = k integral L(l) cos(r,l)^M dl with k = (M+1)/(2 pi), or what --scale says. ggx: "
          "the first half of the split sum, R(r) = k integral L(l) D(h) cos(n,l) dl over the same of a white map, with "
          "n = v = r, h half way between r and l, and Trowbridge and Reitz's D of alpha = roughness^2; --brdf-table "
          "writes the other half. blinn-phong: the same with Blinn's D(h) = cos(n,h)^M, without a table. charlie: the same "
          "with the D(h) = sin(n,h)^(1/alpha) of Estevez and Kulla, alpha = roughness^2 and no less than 9e-4: the sheen of "
          "cloth, as glTF's viewers prefilter it; it is 0 straight ahead and largest towards the horizon. With k = 1 (and "
          "phong's own) a white map stays unchanged. Roughness 0 of ggx is a mirror: each "
          "texel is that of the input in its direction. A lobe narrower than a texel of the output leaves gaps between "
          "the texels, as point samples do: choose a larger --size.\n\n"
          "--levels N makes a chain, level k of a face of --size / 2^k: phong and blinn-phong take M at level 0 and a "
          "quarter of it at each level more, as its texels have four times the area. A chain that would fall below 1, "
          "Lambert's cosine, takes equal "
          "ratios that end there: 2048, 790, 304, 117, 45, 17, 6.7, 2.6 and 1 for 9 levels. An M below 1 is that of all levels. "
          "ggx and charlie take roughness 0 to 1 over the levels. --exponents and --roughnesses list them instead.\n\n"
          "--for ENGINE makes the chain that 'envmap bake' writes for it: frame, file type, depth, size, the roughness that its shader "
          "looks for in each level, the environment itself as the first, and irradiance beside them where its file holds that. With "
          "--lobe diffuse it is the engine's diffuse map. For engines that make rough light themselves it sets frame, file type and "
          "depth. --size, --levels, --roughnesses, --lobe and --depth beside it are obeyed, another --to, --forward or file type is refused.\n\n"
          "Maps other than cubes and latlong maps are prefiltered as the cube that 'convert --to cube --filter area' makes "
          "of them: the two commands by hand give the same bytes, and errors count from that cube.\n\n"
          "Methods: 'hierarchical' is a treecode, which sums over a quad-tree of the input, coarse where the lobe is faint and "
          "smooth, fine in its core and round bright texels. 'spectral' goes through a spherical transform of as many degrees "
          "as the lobe needs, which is quick for narrow lobes in large maps. 'exact' sums over every texel in float64. 'auto' "
          "takes what is quickest. Every texel has its own error figure, and what one method is not sure of is made by the "
          "next, exact at last, so that --max-error holds in every texel, as it is read from the file: where the depth rounds by "
          "more (half by 5e-4, rgb9e5 and Radiance by 2e-3 and 4e-3 of the largest channel, bc6h by what its blocks are found to "
          "have lost), the exit status is 1 and the "
          "message names a depth that does. The mean is the source's over the sphere. A part of the estimate is proved and a part measured: "
          "see envmap-prefilter(7); -v prints the largest.\n\n"
          "--brdf-table: the second half of the split sum for GGX and Smith's height-correlated masking: row by "
          "row perceptual roughness, column by column cos(n,v), both at (i + 0.5) / N; red times F0 plus green is the "
          "part of white light reflected, right to 1e-5. With --lobe charlie the table is the directional albedo of white sheen in "
          "all three channels, with Ashikhmin and Premoze's visibility, as Khronos' glTF-IBL-Sampler has it, right to 1e-6 of its value. "
          "It exceeds 1 at grazing angles of small roughness: clamp it where a shader takes 1 minus it. phong and blinn-phong have no table.",
      .examples = {{"envmap prefilter probe.hdr diffuse.exr --lobe diffuse",
                    "a cube of 64 with the irradiance over pi"},
                   {"envmap prefilter probe.hdr gloss.exr --lobe phong --exponent 100 --to latlong --size 128",
                    "a Phong lobe, as a panorama"},
                   {"envmap prefilter probe.exr ggx.exr --lobe ggx --roughness 0.3 --size 128 --max-error 1e-4",
                    "GGX of one roughness, right to 0.01% in every texel"},
                   {"envmap prefilter probe.exr chain.ktx2 --lobe ggx --size 256 --levels 6 --brdf-table brdf.exr",
                    "what a renderer of glTF materials wants: roughness 0 to 1 over six levels, and the table"},
                   {"envmap prefilter probe.exr 'phong_{level}.hdr' --lobe phong --exponent 2048 --size 256 --levels 9",
                    "a file for each level: exponents 2048, 790, 304 ... 1"},
                   {"envmap prefilter probe.exr ibl.ktx --for filament", "the levels and the irradiance that Filament lights with"},
                   {"envmap prefilter --brdf-table brdf.exr", "the table that goes with every GGX map"},
                   {"envmap prefilter --lobe charlie --brdf-table sheen.exr", "the albedo of sheen, for maps of charlie"}},
      .keys = with_frame(with_written({{"input", "text", "INPUT"},
                            {"lobe", "text", "diffuse, phong, ggx, blinn-phong or charlie"},
                            {"max_error", "number", "what --max-error says"},
                            {"levels[].parameter", "number", "exponent of phong and blinn-phong, roughness of ggx and charlie, null of diffuse"},
                            {"levels[].size", "count", "height of a face"},
                            {"levels[].method", "text", "how it was worked out; of a mirror's level of an engine, the filter"},
                            {"levels[].seconds", "number", "that this took"},
                            {"levels[].max", "number", "the largest figure of a texel, of |a-b| / max(|b|, 0.001 x mean of b); null of exact, the reference"},
                            {"levels[].exact", "count", "texels that were summed exactly, as nothing faster was sure of them"},
                            {"seconds", "number", "from start to end"}})),
      .reports = true,
      .writes = true,
      .define = [](CLI::App& app, const Common& common) -> std::function<int()> {
        auto o = std::make_shared<Options>();
        app.add_option("INPUT", o->input,
                       "File to read, '-' for standard input; {face} in the name reads six files, {level} one a level");
        app.add_option(
            "OUTPUT", o->output,
            "File to write, '-' for standard output; {face} in the name writes six files, {level} one a level");
        add_engine(app, o->engine,
                   "Make what this engine loads: its frame, file type and depth, and its levels of GGX or, with --lobe diffuse, its "
                   "diffuse map; 'list' prints the engines");
        add_choice(app, "--lobe", o->lobe, joined(shape_names), one_of<Shape>(shape_names),
                   "The material's lobe (default: diffuse; ggx for engines that take a chain of it)");
        app.add_option("--exponent", o->exponent, "M of phong and blinn-phong, 0 to 1e9")->type_name("M")->check(number_in({0.0, 1e9}));
        app.add_option("--exponents", o->exponents, "One for each level")
            ->type_name("M,...")
            ->delimiter(',')
            ->check(number_in({0.0, 1e9}));
        app.add_option("--roughness", o->roughness, "Perceptual roughness of ggx and charlie, 0 to 1")->type_name("R")->check(number_in({0.0, 1.0}));
        app.add_option("--roughnesses", o->roughnesses, "One for each level")
            ->type_name("R,...")
            ->delimiter(',')
            ->check(number_in({0.0, 1.0}));
        app.add_option("--levels", o->levels, "Levels of the chain (default: 1; with --for as many as the engine takes)")->type_name("N")->check(CLI::Range(1, 17));
        app.add_option("--scale", o->scale, "The factor k (default: white stays 1)")->type_name("K")->check(number_in({0.0, 1e30}));
        add_projection(app, "--to", o->to, "Projection of the output (default: cube)");
        add_size(app, o->size,
                 "Height of a face (default: 64 a cube's face for diffuse, the engine's for --for, else the input's degrees per texel)");
        add_layout(app, "--layout", o->write.layout, "Where the output's cube faces lie (default: column)");
        add_forward(app, "--forward", o->forward,
                    "World axis at the centre of latlong and angular images (default: +z)");
        add_choice(app, "--method", o->map.method, joined(method_names), one_of<Method>(method_names),
                   "How it is worked out (default: auto)");
        app.add_option("--max-error", o->max_error,
                       "Largest error of a texel of the file, relative to it or to 0.001 x the mean (default: 1e-3, and what "
                       "the file's depth rounds by)")
            ->type_name("E")
            ->check(number_in({1e-7, 10.0}));
        app.add_option("--brdf-table", o->table, "Write the split sum's table of scale and bias, too; with --lobe charlie the albedo of sheen")
            ->type_name("FILE");
        app.add_option("--table-size", o->table_size, "Texels a side of that table (default: 128)")
            ->type_name("N")
            ->check(CLI::Range(1, 1024));
        add_border(app, o->write, "--size counts them, in each level");
        add_depth(app, o->write.depth);
        add_format(app, o->write);
        add_clamp(app, o->write);
        add_shard(app, o->shard);
        add_file_options(app, o->write);
        add_costs(app, o->costs);
        add_read_options(app, o->read);
        add_output_space(app, o->write);
        add_repair(app, o->read);
        return [o, &common] { return run(*o, common); };
      }};
}

}  // namespace tools

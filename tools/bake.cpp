#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "command.h"
#include "costs_file.h"
#include "depfile.h"
#include "engine_maps.h"
#include "engine_options.h"
#include "engines.h"
#include "envmap/base/error.h"
#include "envmap/io/rounding.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/grade.h"
#include "output_folder.h"

namespace tools {
namespace {

using namespace envmap;

constexpr std::string_view readme = "README.txt";

struct Options {
  std::string input, folder, costs;
  bool list = false;
  const Engine* engine = nullptr;
  ReadOptions read;
  double exposure = 0;
  MapOptions maps;
  WriteOptions write;
};

std::vector<std::string_view> map_names(const Engine& e) {
  std::vector<std::string_view> names;
  for (const EngineMap& map : e.maps) names.push_back(map.file);
  return names;
}

int list(const Common& common) {
  if (common.json) {
    nlohmann::ordered_json report;
    for (const Engine& e : engines())
      report["engines"].push_back({{"name", e.name},
                                   {"title", e.title},
                                   {"version", e.version},
                                   {"maps", map_names(e)},
                                   {"frame", frame_words(e.maps.front().frame)},
                                   {"turns", e.turns},
                                   {"light", e.light}});
    print_report(report);
    return 0;
  }
  list_engines();
  return 0;
}

std::vector<std::string_view> files_of(const Engine& e) {
  std::vector<std::string_view> files = map_names(e);
  files.push_back(readme);
  if (!e.text.name.empty()) files.push_back(e.text.name);
  return files;
}

// A map of the folder, as the README tells of it.
struct Baked {
  const EngineMap& map;
  std::string size, depth, accuracy;
};

std::string readme_text(const Engine& e, const std::vector<Baked>& maps, double exposure) {
  std::string text = fmt::format("Light for {} ({}): linear RGB radiance{}.\n\n", e.title, e.version,
                                 exposure == 0 ? "" : fmt::format(", multiplied by 2^{:g}", exposure));
  for (const Baked& b : maps)
    text += fmt::format("{}: {}, {}, {}; {}.\n", b.map.file, frame_words(b.map.frame), b.size, b.depth, b.accuracy);
  return text + fmt::format("Frame: {}.\nRough and diffuse light: {}.\n\n{}\n", e.turns, e.light, e.steps);
}

std::string size_of(const std::vector<Rows>& levels) {
  const Rows& base = levels.front();
  return fmt::format("{}x{}{}", base.width(), base.size, levels.size() > 1 ? fmt::format(" in {} levels", levels.size()) : "");
}

// The probe in the light that was asked for.
Source read_probe(const Options& o, const Common& common) {
  Source source = read_map(o.input, o.read, common);
  const double gain = portable::exp2(o.exposure);
  if (gain != 1) apply(Grade{.gain = Flux(gain)}, source.map.base());
  if (auto& luminance = source.provenance.white_luminance) luminance = static_cast<float>(*luminance / gain);
  return source;
}

// Makes and writes one map. @param shown the file as it will be called.
Baked bake_map(const Options& o, const EngineMap& map, MapMaker& maker, const OutputFolder& folder, nlohmann::ordered_json& report,
               const Common& common) {
  const std::string file = folder.file(map.file), shown = o.folder + "/" + std::string(map.file);
  WriteOptions how = o.write;
  how.commit = common.commit;
  if (!how.depth) how.depth = map.depth;
  check_output(file, how, map.frame.projection, map.chain.has_value());
  try {
    const MadeMap made = maker.make(map, rounding_of(file, how));
    how.pairs = made.pairs;
    how.facts = made.facts;
    const Written written = write(file, made.rows, how, progress_line(common, "bake"));
    if (written.clamped > 0)
      warn(fmt::format("{}: clamped {} texels, {:.3g}% of the flux lost", shown, written.clamped, 100 * written.flux_lost));
    nlohmann::ordered_json one{{"size", made.rows.front().size}, {"levels", made.rows.size()}, {"accuracy", made.accuracy}};
    add_written(one, shown, written);
    report["maps"].push_back(one);
    return {map, size_of(made.rows), std::string(name(written.depth)), made.accuracy};
  } catch (const OutputError& e) {
    throw folder.as_it_will_be(e, map.file);
  } catch (const NotReached& e) {
    const std::string depth = depth_that_holds(file, how, *o.maps.max_error);
    throw NotReached(fmt::format("{}: --max-error {:g} is not held by {}: allow more{}", shown, *o.maps.max_error, e.what(),
                                 depth.empty() ? "" : ", or say " + depth));
  }
}

int run(Options& o, const Common& common) {
  if (o.list) return list(common);
  if (o.input.empty() || o.folder.empty()) throw UsageError("name a PROBE and a FOLDER, or say --list");
  if (o.folder == "-") throw UsageError("FOLDER: '-' is standard output, which holds no folder: name one");
  if (!o.engine) throw UsageError("--for: which engine? " + engine_names());
  const Stopwatch watch;
  const Engine& e = *o.engine;
  check_report(o.folder, common);
  std::vector<std::string> outputs;
  for (const std::string_view file : files_of(e)) outputs.push_back(o.folder + "/" + std::string(file));
  check_files(outputs, {o.input}, common);
  o.maps.costs = read_costs(o.costs, common);
  const Source source = read_probe(o, common);
  o.write.source_depth = is_integer(source.depth) ? Depth::half : source.depth;
  o.write.provenance = source.provenance;
  tell_what_is_cut(e, source.map.base(), "bake");

  OutputFolder folder(o.folder, files_of(e), common.commit);
  const auto depfile = open_depfile(outputs, {o.input}, common);
  nlohmann::ordered_json report{{"input", o.input}, {"quality", o.maps.quality.name}};
  add_frame(report, e, e.maps.front());
  MapMaker maker(source.map, o.maps, common);
  std::vector<Baked> baked;
  for (const EngineMap& map : e.maps) baked.push_back(bake_map(o, map, maker, folder, report, common));
  if (!e.text.name.empty()) folder.write(e.text.name, e.text.text);
  folder.write(readme, readme_text(e, baked, o.exposure));
  folder.commit();
  if (depfile) depfile->commit();
  tell_frame(o.folder, e, e.maps.front(), common);
  for (const std::string& file : outputs) report["files"].push_back(file);
  report["seconds"] = watch.seconds();
  if (common.json) print_report(report);
  return 0;
}

}  // namespace

Command bake_command() {
  return {
      .name = "bake",
      .summary = "Write a folder with what an engine needs to be lit by a probe",
      .description =
          "Writes the environment in the projection, frame and format that the engine's own loader takes, a text that loads it "
          "where the engine has such, and README.txt, which says how the folder is used and how its directions stand in the "
          "engine's world. How directions stand there is printed; only a left-handed world gets a mirrored map, and that is said. "
          "The environment is resampled as 'envmap convert' does by itself.\n\n"
          "Some engines make rough and diffuse light of the environment themselves. Others get a chain of levels, each as 'envmap "
          "prefilter --lobe ggx' makes it, of the roughness that the engine's shader looks for in it; the first shows the environment "
          "itself. --list prints them, with what was read or run to know what they load. 'convert', 'mipmap' and 'prefilter' take --for, "
          "too: 'convert --for' makes the same file as the environment here, 'prefilter --for' the same as the chain or, with --lobe "
          "diffuse, the diffuse map.\n\n"
          "--quality draft halves the sizes of all maps and makes each texel of rough and diffuse light within 1e-2; normal makes it "
          "within 1e-3, high within 1e-4 and doubles the sizes of chains. What the depth of the file rounds by comes on top. --max-error E "
          "holds for all that is read back from the files, rounding included: in every texel of rough and diffuse light as 'prefilter' "
          "does, in the texels where it was measured of environments as 'convert' does. Where a depth rounds by more than E (half by "
          "5e-4, rgb9e5 and Radiance by 2e-3 and 4e-3 of the largest channel, rgbd by 6e-3 and more), nothing is written, the exit status is 1, and "
          "the message says what does hold it.\n\n"
          "Suns beyond 65504 do not fit half: choose --depth float where the engine's loader takes it, lower --exposure and raise the "
          "light's intensity in the engine, or say --clamp.\n\n"
          "The folder appears whole, or not at all. One of that name is replaced if it holds nothing but files of the same names.",
      .examples = {{"envmap bake probe.exr lights --for blender", "lights/background.exr and lights/world.py"},
                   {"envmap bake probe.hdr public/probe --for three --size 1024", "a panorama of 2048x1024 for EXRLoader"},
                   {"envmap bake probe.hdr lights --for filament --max-error 1e-2", "files whose every texel is right to 1%"},
                   {"envmap bake --list", "the engines"}},
      .keys = {{"input", "text?", "PROBE; absent with --list, as all but 'engines'"},
               {"engine", "text?", "as --for says"},
               {"frame", "text?", "projection, and the axis at the centre"},
               {"turns", "text?", "how directions stand in the engine's world"},
               {"quality", "text?", "as --quality says"},
               {"maps[]", "object?", "what was written for the engine to load"},
               {"maps[].size", "count", "height of a face"},
               {"maps[].levels", "count", "how many"},
               {"maps[].accuracy", "text", "of its texels, in words"},
               {"maps[].output", "text", "the file"},
               {"maps[].depth", "text", "what it holds: uint8, uint16, bc6h, rgb9e5, half or float"},
               {"maps[].clamped", "count", "texels that --clamp changed"},
               {"maps[].flux_lost", "number", "part of the flux that this took"},
               {"files", "texts?", "what the folder holds"},
               {"engines[]", "object?", "with --list, alone"},
               {"engines[].name", "text", "as --for takes it"},
               {"engines[].title", "text", "its own name"},
               {"engines[].version", "text", "of which what is said here was read or run"},
               {"engines[].maps", "texts", "the files that it loads"},
               {"engines[].frame", "text", "of the first of them"},
               {"engines[].turns", "text", "how directions stand in its world"},
               {"engines[].light", "text", "how it makes rough and diffuse light"},
               {"seconds", "number?", "from start to end"}},
      .reports = true,
      .writes = true,
      .define = [](CLI::App& app, const Common& common) -> std::function<int()> {
        auto o = std::make_shared<Options>();
        app.add_option("PROBE", o->input, "File to read, '-' for standard input; {face} in the name reads six files");
        app.add_option("FOLDER", o->folder, "Folder to write");
        add_engine(app, o->engine, "The engine; 'list' prints them", &o->list);
        app.add_flag("--list", o->list, "Print the engines and what they load");
        const auto quality = [](std::string_view word) -> std::optional<Quality> {
          const auto found = std::ranges::find(qualities, word, &Quality::name);
          return found == qualities.end() ? std::nullopt : std::optional(*found);
        };
        add_choice(app, "--quality", o->maps.quality, "draft|normal|high", quality, "Sizes, and errors of rough and diffuse light (default: normal)");
        app.add_option("--max-error", o->maps.max_error,
                       "Largest error of a texel of any of the files, relative to it or to 0.001 x the mean (default: by the quality, and "
                       "what the depth rounds by)")
            ->type_name("E")
            ->check(number_in({1e-6, 10.0}));
        add_size(app, o->maps.size, "Height of the environment's map (default: the input's degrees per texel); chains have a size of their own");
        app.add_option("--chain-size", o->maps.chain_size, "Height of a chain's first level (default: what the engine's shader was made for)")
            ->type_name("N")
            ->check(CLI::Range(1, 4096));
        app.add_option("--exposure", o->exposure, "Multiply radiance by 2^STOPS")->type_name("STOPS")->check(number_in({-100.0, 100.0}));
        add_depth(app, o->write.depth)->description("What the files store for each value (default: what the engine wants, else as the input)");
        add_clamp(app, o->write);
        add_costs(app, o->costs);
        add_read_options(app, o->read);
        add_repair(app, o->read);
        return [o, &common] { return run(*o, common); };
      }};
}

}  // namespace tools

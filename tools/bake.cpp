#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "command.h"
#include "depfile.h"
#include "engine_maps.h"
#include "engines.h"
#include "envmap/base/error.h"
#include "envmap/operate/measure.h"
#include "output_folder.h"

namespace tools {
namespace {

using namespace envmap;

constexpr std::string_view readme = "README.txt";

struct Options {
  std::string input, folder;
  bool list = false;
  const Engine* engine = nullptr;
  ReadOptions read;
  std::optional<int> size, chain_size;
  WriteOptions write;
};

const Engine* engine_named(std::string_view word) {
  const auto found = std::ranges::find(engines(), word, &Engine::name);
  return found == engines().end() ? nullptr : &*found;
}

std::string engine_names() {
  std::vector<std::string_view> names;
  for (const Engine& e : engines()) names.push_back(e.name);
  return joined(names);
}

std::string words(const Frame& frame) {
  const std::string projection = name(frame.projection);
  return has_forward(frame.projection)
             ? fmt::format("{}, {} at the centre", projection, forward_names[static_cast<std::size_t>(frame.forward)])
             : projection;
}

std::vector<std::string_view> map_names(const Engine& e) {
  std::vector<std::string_view> names;
  for (const EngineMap& map : e.maps) names.push_back(map.file);
  return names;
}

int list_engines(const Common& common) {
  if (common.json) {
    nlohmann::ordered_json report;
    for (const Engine& e : engines())
      report["engines"].push_back({{"name", e.name},
                                   {"title", e.title},
                                   {"version", e.version},
                                   {"maps", map_names(e)},
                                   {"frame", words(e.maps.front().frame)},
                                   {"turns", e.turns},
                                   {"light", e.light}});
    print_report(report);
    return 0;
  }
  for (const Engine& e : engines())
    print(fmt::format("{:10}{} ({})\n{:10}{}: {}; {}\n{:10}rough and diffuse light: {}\n", e.name, e.title, e.version, "",
                      fmt::join(map_names(e), ", "), words(e.maps.front().frame), e.turns, "", e.light));
  return 0;
}

std::vector<std::string_view> files_of(const Engine& e) {
  std::vector<std::string_view> files = map_names(e);
  files.push_back(readme);
  if (!e.text.name.empty()) files.push_back(e.text.name);
  return files;
}

std::string readme_text(const Engine& e) {
  return fmt::format("Light for {} ({}).\n\n{}: the environment, {}, linear RGB radiance.\nFrame: {}.\nRough and diffuse light: {}.\n\n{}\n",
                     e.title, e.version, e.maps.front().file, words(e.maps.front().frame), e.turns, e.light, e.steps);
}

// What the engine's loader would cut off without a word.
void tell_what_is_cut(const Engine& e, const Level& level) {
  if (e.largest == 0) return;
  std::int64_t texels = 0;
  float most = 0;
  for (int face = 0; face < level.faces(); ++face)
    for (int j = 0; j < level.height(); ++j)
      for (const Colour& c : level.row(face, j)) {
        const float value = std::max({c.x, c.y, c.z});
        texels += value > e.largest;
        most = std::max(most, value);
      }
  if (texels > 0)
    warn(fmt::format("envmap bake: {} keeps values up to {:g}: {} texels up to {:.3g} are cut off by its loader", e.title, e.largest,
                     texels, most));
}

int run(Options& o, const Common& common) {
  if (o.list) return list_engines(common);
  if (o.input.empty() || o.folder.empty()) throw UsageError("name a PROBE and a FOLDER, or say --list");
  if (o.folder == "-") throw UsageError("FOLDER: '-' is standard output, which holds no folder: name one");
  if (!o.engine) throw UsageError("--for: which engine? " + engine_names());
  const Stopwatch watch;
  const Engine& e = *o.engine;
  check_report(o.folder, common);
  std::vector<std::string> outputs;
  for (const std::string_view file : files_of(e)) outputs.push_back(o.folder + "/" + std::string(file));
  check_files(outputs, {o.input}, common);
  Source source = read_map(o.input, o.read, common);
  o.write.source_depth = is_integer(source.depth) ? Depth::half : source.depth;
  o.write.provenance = source.provenance;
  tell_what_is_cut(e, source.map.base());

  OutputFolder folder(o.folder, files_of(e), common.commit);
  const auto depfile = open_depfile(outputs, {o.input}, common);
  nlohmann::ordered_json report{{"input", o.input}, {"engine", e.name}, {"frame", words(e.maps.front().frame)}, {"turns", e.turns}};
  MapMaker maker(source.map, o.size, o.chain_size, common);
  for (const EngineMap& map : e.maps) {
    const MadeMap made = maker.make(map);
    WriteOptions write = o.write;
    if (map.depth) write.depth = map.depth;
    write.pairs = made.pairs;
    write.facts = made.facts;
    const Written written = write_one_map(folder.file(map.file), made.rows, write, "bake", common);
    nlohmann::ordered_json one{{"size", made.rows.front().size}, {"levels", made.rows.size()}};
    add_written(one, o.folder + "/" + std::string(map.file), written);
    report["maps"].push_back(one);
  }
  if (!e.text.name.empty()) folder.write(e.text.name, e.text.text);
  folder.write(readme, readme_text(e));
  folder.commit();
  if (depfile) depfile->commit();
  note(common, fmt::format("{}: {}: {}", o.folder, words(e.maps.front().frame), e.turns));
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
          "prefilter --lobe ggx' makes it, of the roughness that the engine's shader looks for in it. --list prints them, with "
          "what was read or run to know what they load.\n\n"
          "The folder appears whole, or not at all. One of that name is replaced if it holds nothing but files of the same names.",
      .examples = {{"envmap bake probe.exr lights --for blender", "lights/background.exr and lights/world.py"},
                   {"envmap bake probe.hdr public/probe --for three --size 1024", "a panorama of 2048x1024 for EXRLoader"},
                   {"envmap bake --list", "the engines"}},
      .keys = {{"input", "PROBE"},
                            {"engine", "as --for says"},
                            {"frame", "projection, and the axis at the centre"},
                            {"turns", "how directions stand in the engine's world"},
                            {"maps[]", "size and levels of each map, and its output, depth, clamped and flux_lost as of 'convert'"},
                            {"files[]", "what the folder holds"},
                            {"engines[]", "with --list, alone: name, title, version, maps, frame, turns and light of each"},
                            {"seconds", "from start to end"}},
      .reports = true,
      .writes = true,
      .define = [](CLI::App& app, const Common& common) -> std::function<int()> {
        auto o = std::make_shared<Options>();
        app.add_option("PROBE", o->input, "File to read, '-' for standard input; {face} in the name reads six files");
        app.add_option("FOLDER", o->folder, "Folder to write");
        app.add_option_function<std::string>(
               "--for",
               [o](const std::string& word) {
                 o->engine = engine_named(word);
                 if (!o->engine) throw CLI::ValidationError("--for", "'" + word + "' is none of " + engine_names());
               },
               "The engine")
            ->type_name(engine_names());
        app.add_flag("--list", o->list, "Print the engines and what they load");
        add_size(app, o->size, "Height of the environment's map (default: the input's degrees per texel); chains have a size of their own");
        app.add_option("--chain-size", o->chain_size, "Height of a chain's first level (default: what the engine's shader was made for)")
            ->type_name("N")
            ->check(CLI::Range(1, 4096));
        add_clamp(app, o->write);
        add_read_options(app, o->read);
        add_repair(app, o->read);
        return [o, &common] { return run(*o, common); };
      }};
}

}  // namespace tools

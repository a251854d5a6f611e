#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "command.h"
#include "envmap/base/error.h"
#include "envmap/engine/bake.h"
#include "envmap/engine/engines.h"
#include "envmap/io/output_folder.h"
#include "envmap/io/rounding.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/grade.h"
#include "shared/engine_options.h"
#include "shared/map_options.h"
#include "shared/maps.h"

namespace tools {
namespace {

using namespace envmap;

constexpr std::string_view readme = "README.txt";

struct Request {
  std::string input, folder, costs;
  std::string list;  // An engine or "all".
  const Engine* engine = nullptr;
  ReadOptions read;
  double exposure = 0;
  BakeOptions maps;
  WriteOptions write;
};

std::vector<std::string> map_names(const Engine& e) {
  std::vector<std::string> names;
  for (const EngineMap& map : e.maps) names.emplace_back(map.file);
  return names;
}

int list(const std::string& which, Report& report) {
  if (!settings().json && which == "all") print(engine_list());
  for (const Engine& e : engines()) {
    if (which != "all" && which != e.name) continue;
    if (!settings().json && which != "all") print(engine_text(e));
    report.append("engines[]");
    report.put("engines[].name", e.name);
    report.put("engines[].title", e.title);
    report.put("engines[].version", e.version);
    report.put("engines[].maps", map_names(e));
    report.put("engines[].frame", frame_words(e.maps.front().frame));
    report.put("engines[].turns", turns_of(e));
    report.put("engines[].light", e.light);
  }
  return 0;
}

std::vector<std::string_view> files_of(const Engine& e) {
  std::vector<std::string_view> files;
  for (const EngineMap& map : e.maps) files.push_back(map.file);
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
  return text + fmt::format("Orientation: {}\nRough and diffuse light: {}.\n\n{}\n", turns_of(e), e.light, e.steps);
}

std::string size_of(const std::vector<Rows>& levels) {
  const Rows& base = levels.front();
  return fmt::format("{}x{}{}", base.width(), base.size,
                     levels.size() > 1 ? fmt::format(" in {} levels", levels.size()) : "");
}

// The probe in the light that was asked for.
Source read_probe(const Request& o) {
  Source source = read_map(o.input, o.read);
  const double gain = portable::exp2(o.exposure);
  if (gain != 1) apply(Grade{.gain = Flux(gain)}, source.map.base());
  if (auto& luminance = source.provenance.white_luminance) luminance = float(*luminance / gain);
  return source;
}

// Makes and writes one map. @param shown the file as it will be called.
Baked bake_map(const Request& o, const EngineMap& map, Baker& maker, const OutputFolder& folder, Report& report) {
  const std::string file = folder.file(map.file), shown = o.folder + "/" + std::string(map.file);
  WriteOptions how = o.write;
  how.commit = settings().commit;
  if (!how.depth) how.depth = map.depth;
  check_output(file, how, map.frame.projection, map.chain.has_value());
  try {
    const BakedMap made = maker.make(map, rounding_of(file, how));
    how.pairs = made.pairs;
    how.facts = made.facts;
    const Written written = write(file, made.rows, how, progress_line("bake"));
    if (written.clamped > 0)
      warn(fmt::format("{}: clamped {} texels, {:.3g}% of the flux lost", shown, written.clamped,
                       100 * written.flux_lost));
    report.append("maps[]");
    report.put("maps[].size", made.rows.front().size);
    report.put("maps[].levels", made.rows.size());
    report.put("maps[].accuracy", made.accuracy);
    report.put_written("maps[]", shown, written);
    return {map, size_of(made.rows), std::string(name(written.depth)), made.accuracy};
  } catch (const OutputError& e) {
    throw folder.with_final_path(e, map.file);
  } catch (const NotReached& e) {
    const std::string depth = depth_for_error(file, how, *o.maps.max_error);
    throw NotReached(fmt::format("{}: cannot meet --max-error {:g}: {}: raise --max-error{}", shown, *o.maps.max_error,
                                 e.what(), depth.empty() ? "" : " or use " + depth));
  }
}

int run(Request& o, Report& report) {
  if (!o.list.empty()) return list(o.list, report);
  if (o.input.empty() || o.folder.empty()) throw UsageError("needs PROBE and FOLDER, or --list");
  if (o.folder == "-") throw UsageError("FOLDER: '-' is standard output: give the name of a folder");
  if (!o.engine) throw UsageError("needs --for ENGINE: 'envmap bake --list' lists engines");
  const Engine& e = *o.engine;
  std::vector<std::string> outputs;
  for (const std::string_view file : files_of(e)) outputs.push_back(o.folder + "/" + std::string(file));
  check_files(outputs, {o.input});
  o.maps.costs = read_costs(o.costs);
  o.maps.chain_size_name = "--chain-size";
  o.maps.progress = [](const std::string& map) { return progress_line("bake " + map); };
  const Source source = read_probe(o);
  o.write.source_depth = is_integer(source.depth) ? Depth::half : source.depth;
  o.write.provenance = source.provenance;
  warn_about_clamping(e, source.map.base(), "bake");

  OutputFolder folder(o.folder, files_of(e), settings().commit);
  open_depfile();
  report.put("input", o.input);
  report.put("quality", o.maps.quality.name);
  add_frame(report, e, e.maps.front());
  Baker maker(source.map, o.maps);
  std::vector<Baked> baked;
  for (const EngineMap& map : e.maps) baked.push_back(bake_map(o, map, maker, folder, report));
  if (!e.text.name.empty()) folder.write(e.text.name, e.text.text);
  folder.write(readme, readme_text(e, baked, o.exposure));
  folder.commit();
  tell_frame(o.folder, e, e.maps.front());
  report.put("files", outputs);
  report.put_seconds();
  return 0;
}

}  // namespace

Action define_bake(Options& o) {
  const auto r = std::make_shared<Request>();
  o.reads("PROBE", r->input, "File to read, or '-' for stdin ({face} in the name reads six files)");
  o.writes("FOLDER", r->folder, "Folder to write").file = File::folder;
  o.group = "Engine";
  add_engine(o, r->engine, "{}");
  o.add("--list [ENGINE]", engine_names() + "|all",
        [&list = r->list](const std::string& word) {
          list = word;
          return word == "all" || std::ranges::find(engines(), word, &Engine::name) != engines().end();
        },
        "List the engines, or show what one engine loads")
      .alone = "all";
  o.group = groups::quality;
  o.add(
      "--quality", "draft|normal|high",
      [&quality = r->maps.quality](const std::string& word) {
        const auto found = std::ranges::find(qualities, word, &Quality::name);
        if (found != qualities.end()) quality = *found;
        return found != qualities.end();
      },
      "Size and error of rough and diffuse light: {} (normal)");
  o.add("--max-error", "E", &r->maps.max_error, {1e-6, 10},
        "Largest error of a texel, rounding included (default: by --quality)");
  add_size(o, &r->maps.size, "Height of the environment map or face (default: same texels per degree)");
  o.add("--chain-size", "N", &r->maps.chain_size, {1, 4096},
        "Height of the first level of rough light (default: the engine's)");
  add_costs(o, r->costs);
  o.group = groups::output_file;
  add_depth(o, r->write, "engine's, or input's");
  add_clamp(o, r->write);
  add_read_options(o, r->read);
  add_repair(o, r->read);
  o.group = groups::colour;
  add_exposure(o, r->exposure);
  return [r](Report& report) { return run(*r, report); };
}

}  // namespace tools

#include "envmap/engine/bake.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "command.h"
#include "engines/engine_options.h"
#include "envmap/base/error.h"
#include "envmap/engine/engines.h"
#include "envmap/engine/jpeg_background.h"
#include "envmap/engine/level_roughness.h"
#include "envmap/io/texels/rounding.h"
#include "envmap/light/lights.h"
#include "envmap/maths/portable.h"
#include "maps/depfile.h"
#include "maps/map_options.h"
#include "maps/read_and_write_maps.h"

namespace tools {
namespace {

using namespace envmap;

struct BakeRequest {
  std::string input, folder;
  std::string list;  // An engine or "all".
  const Engine* engine = nullptr;
  std::optional<Engine> with_jpeg;  // What `engine` then is.
  bool latlong = false, gain_map = false;
  ReadOptions read;
  BakeOptions maps;
  bool suns = false;
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

// A depth that holds the error in the file at fault, if its engine takes one. @param error that it may have.
std::string depth_that_helps(const AccuracyError& e, const BakeRequest& o, double error) {
  for (const EngineMap& map : o.engine->maps) {
    if (e.file() != o.folder + "/" + std::string(map.file) || map.only_depth) continue;
    WriteOptions how = o.maps.write;
    if (!how.depth) how.depth = map.depth;
    return depth_for_error(e.file(), how, error);
  }
  return "";
}

// What the file of an engine needs to hold an error.
AccuracyError with_remedy(const AccuracyError& e, const BakeRequest& o) {
  const bool too_bright = e.remedy() == Remedy::clamp_or_dim;
  std::vector<std::string> ways{too_bright ? "lower --exposure" : "raise --max-error"};
  if (too_bright && !o.suns) ways.emplace_back("use --suns");
  const double error = too_bright ? below_half : *o.maps.max_error;
  if (const std::string depth = depth_that_helps(e, o, error); !depth.empty()) ways.push_back("use " + depth);
  const std::string last = ways.back();
  ways.pop_back();
  return AccuracyError(fmt::format("{}: {}{}{}", e.what(), fmt::join(ways, ", "), ways.empty() ? "" : " or ", last));
}

std::vector<BakedFile> bake_folder(const BakeRequest& o, EnvironmentMap probe) {
  try {
    return bake(std::move(probe), *o.engine, o.folder, o.maps, {.progress = progress_line("bake")});
  } catch (const AccuracyError& e) {
    throw with_remedy(e, o);
  }
}

void tell(const BakeRequest& o, const std::vector<BakedFile>& baked, Report& report) {
  for (const BakedFile& map : baked) {
    const std::string path = o.folder + "/" + map.name;
    tell_clamping(path, map.written);
    report.append("maps[]");
    report.put("maps[].size", map.size);
    report.put("maps[].levels", map.levels);
    report.put("maps[].accuracy", map.accuracy);
    report.put_written("maps[]", path, map.written);
  }
}

// Takes the suns of the probe out of the maps, where there are some.
void find_suns(BakeRequest& o, const EnvironmentMap& probe, Report& report) {
  FoundLights found = find_lights(probe, {}, {.progress = progress_line("suns")});
  report.put_array("suns");
  for (const DiscLight& light : found.lights) {
    report.append("suns[]");
    report.put("suns[].towards", light.towards);
    report.put("suns[].irradiance", Direction(light.irradiance));
    report.put("suns[].radius", light.radius_degrees);
    report.put("suns[].share", light.share);
  }
  if (found.lights.empty())
    warn(fmt::format("envmap bake: {}: no light for --suns: the maps hold everything ('envmap lights' tells more)",
                     o.input));
  else
    o.maps.suns = std::move(found);
}

std::vector<std::string> outputs_of(const BakeRequest& o) {
  std::vector<std::string> outputs;
  for (const std::string& file : files_of(*o.engine, o.maps)) outputs.push_back(o.folder + "/" + file);
  return outputs;
}

int run(BakeRequest& o, Report& report) {
  if (!o.list.empty()) return list(o.list, report);
  if (o.input.empty() || o.folder.empty()) throw UsageError("needs PROBE and FOLDER, or --list");
  if (o.folder == "-") throw UsageError("FOLDER: '-' is standard output: give the name of a folder");
  if (!o.engine) throw UsageError("needs --for ENGINE: 'envmap bake --list' lists engines");
  if (o.latlong) {
    const Engine* const panorama = find_latlong(*o.engine);
    if (!panorama) throw UsageError(fmt::format("--latlong: {} has one way to load a map", o.engine->title));
    o.engine = panorama;
  }
  if (o.gain_map) {
    o.with_jpeg = with_jpeg_background(*o.engine);
    if (!o.with_jpeg) throw UsageError(fmt::format("--gain-map: {} loads no JPEG with a gain map", o.engine->title));
    o.engine = &*o.with_jpeg;
  }
  const Engine& e = *o.engine;
  if (o.suns) o.maps.suns.emplace();  // So that the file of the suns is checked, too.
  check_files(outputs_of(o), {o.input}, {{}, o.read.faces});
  o.maps.suns.reset();
  if (o.maps.chain_size)
    for (const EngineMap& map : e.maps)
      if (map.chain) level_roughnesses(map, *o.maps.chain_size, {}, "--chain-size");
  Source source = read_map(o.input, o.read);
  const std::string brightest = equal_brightest("bake", o.input, source.map);
  o.maps.write.source_depth = is_integer(source.depth) ? Depth::half : source.depth;
  o.maps.write.provenance = source.provenance;
  o.maps.write.commit = settings().commit;
  if (o.suns) find_suns(o, source.map, report);
  if (!o.maps.suns) warn_about_clamping(e, source.map.base(), portable::exp2(o.maps.exposure), "bake");
  open_depfile();
  report.put("input", o.input);
  report.put("quality", o.maps.quality.name);
  add_frame(report, e, e.maps.front());
  tell(o, bake_folder(o, std::move(source.map)), report);
  tell_frame(o.folder, e, e.maps.front());
  if (!brightest.empty()) note(brightest);
  report.put("files", outputs_of(o));
  report.put_seconds();
  return 0;
}

}  // namespace

Action define_bake(Options& o) {
  const auto r = std::make_shared<BakeRequest>();
  o.reads("PROBE", r->input, "File to read, or '-' for stdin ({face} in the name reads six files)");
  o.writes("FOLDER", r->folder, "Folder to write").file = File::folder;
  o.group = "Engine";
  add_engine(o, r->engine, "{}");
  o.flag("--latlong", r->latlong, "Write a panorama instead of prefiltered cubes, with --for three");
  o.flag("--gain-map", r->gain_map, "Write the background as JPEG with a gain map, with --for three").excludes =
      "--latlong";
  o.add(
       "--list [ENGINE]", engine_names() + "|all",
       [&list = r->list](const std::string& word) {
         list = word;
         return word == "all" || find_engine(word) != nullptr;
       },
       "List the engines, or show what one engine loads")
      .alone = "all";
  o.flag("--suns", r->suns, "Take suns and lamps out of the maps, and write them as lights of the engine");
  o.group = groups::quality;
  o.add(
      "--quality", "draft|normal|high",
      [&quality = r->maps.quality](const std::string& word) {
        const auto found = std::ranges::find(qualities, word, &Quality::name);
        if (found != qualities.end()) quality = *found;
        return found != qualities.end();
      },
      "Accuracy of rough and diffuse light: {} (default: normal)");
  o.add("--max-error", "E", &r->maps.max_error, {1e-6, 10},
        "Limit of errors, file rounding included (default: by --quality, without rounding)");
  add_size(o, &r->maps.size, "Height of the environment map or face (default: same texels per degree)");
  o.add("--chain-size", "N", &r->maps.chain_size, range_of(limits::chain_size),
        "Height of the first level of rough light (default: the engine's)");
  o.group = groups::output_file;
  add_depth(o, r->maps.write, "engine's, or input's");
  add_clamp(o, r->maps.write);
  add_read_options(o, r->read);
  add_repair(o, r->read);
  o.group = groups::colour;
  add_exposure(o, r->maps.exposure);
  return [r](Report& report) { return run(*r, report); };
}

}  // namespace tools

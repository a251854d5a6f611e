#include "engines/engine_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "cli/command_line.h"
#include "cli/console.h"
#include "envmap/base/error.h"
#include "envmap/base/words.h"
#include "envmap/io/formats/file_format.h"

namespace tools {

using namespace envmap;

namespace {

[[noreturn]] void contradict(const Engine& e, const EngineMap& map, const std::string& what) {
  throw UsageError(fmt::format("--for {}: {} loads {} from .{} files: remove {}", e.name, e.title,
                               frame_words(map.frame), extension_of(map.file), what));
}

}  // namespace

std::string engine_names() { return joined(engines(), "|", &Engine::name); }

Option& add_engine(Options& o, const Engine*& engine, std::string_view help) {
  return o.add(
      "--for ENGINE", engine_names(),
      [&engine](const std::string& word) {
        if (word == "list") throw HelpRequested{engine_list()};
        engine = find_engine(word);
        return engine != nullptr;
      },
      help);
}

namespace {

std::string files_of(const Engine& e, std::string_view between) { return joined(e.maps, between, &EngineMap::file); }

}  // namespace

std::string image_of(const Engine& e) {
  const Frame& frame = e.maps.front().frame;
  const std::string axis =
      has_forward(frame.projection) ? fmt::format(" {}", forward_names[std::size_t(frame.forward)]) : "";
  return name(frame.projection) + axis;
}

bool was_run(const Engine& e) { return e.version.find("not run") == e.version.npos; }

std::string engine_list() {
  std::string list =
      fmt::format("{:13} {:40} {:11} {:10} {:8} {}\n", "engine", "files", "image", "axes", "mirrored", "tested");
  for (const Engine& e : engines()) {
    list += fmt::format("{:13} {:40} {:11} {:10} {:8} {}\n", e.name, files_of(e, " "), image_of(e), e.axes, e.mirrored,
                        was_run(e) ? "yes" : "no");
  }
  return list +
         "image: projection, and the world axis at its centre. axes: directions in the engine of +X +Y +Z of the "
         "probe.\n"
         "mirrored: by what, for a left-handed world or lookup. tested: the engine itself loaded the files.\n"
         "Details: envmap bake --list ENGINE\n";
}

std::string engine_text(const Engine& e) {
  return fmt::format("{} ({})\nFiles: {} ({})\nOrientation: {}\nRough and diffuse light: {}.\nUse:\n{}\n", e.title,
                     e.version, files_of(e, ", "), frame_words(e.maps.front().frame), turns_of(e), e.light, e.steps);
}

const Engine& row_for(const Engine& engine, const std::string& output, const WriteOptions& write) {
  const std::string type = write.format.empty() ? extension_of(output) : write.format;
  const Engine* const latlong = find_latlong(engine);
  return latlong && type != extension_of(engine.maps.front().file) ? *latlong : engine;
}

const EngineMap& environment_of(const Engine& engine) {
  const EngineMap& map = engine.maps.front();
  if (map.chain)
    throw UsageError(fmt::format("--for {0}: {1} loads prefiltered levels only: use 'envmap prefilter --for {0}'",
                                 engine.name, engine.title));
  return map;
}

const EngineMap& prefiltered_of(const Engine& engine, bool diffuse) {
  const auto found = std::ranges::find_if(engine.maps, [&](const EngineMap& m) {
    return diffuse ? m.diffuse > 0 : m.chain.has_value();
  });
  return found == engine.maps.end() ? engine.maps.front() : *found;
}

void resolve_for_engine(const Engine& engine, const EngineMap& map, const std::string& output,
                        std::optional<Projection>& to, std::optional<Forward>& forward, WriteOptions& write) {
  if (to && *to != map.frame.projection) contradict(engine, map, fmt::format("--to {}", name(*to)));
  if (forward && has_forward(map.frame.projection) && *forward != map.frame.forward)
    contradict(engine, map,
               fmt::format("--forward {} (the input's is --from-forward)", forward_names[std::size_t(*forward)]));
  if (write.openexr_envmap) contradict(engine, map, "--openexr-envmap");
  if (write.border > 0) contradict(engine, map, "--border");
  const std::string type = extension_of(map.file), asked = write.format.empty() ? extension_of(output) : write.format;
  if (!asked.empty() && asked != type)
    throw UsageError(output,
                     fmt::format("--for {}: {} loads this map from .{} files", engine.name, engine.title, type));
  write.format = type;
  if (!write.depth) write.depth = map.depth;
  if (map.only_depth && write.depth != map.depth)
    throw UsageError(output, fmt::format("--for {}: {} loads this map in {} alone: remove --depth", engine.name,
                                         engine.title, name(*map.depth)));
  to = map.frame.projection;
  if (has_forward(map.frame.projection)) forward = map.frame.forward;
}

void resolve_for_engine(const Engine& engine, const EngineMap& map, const std::string& output, WriteOptions& write) {
  std::optional<Projection> to;
  std::optional<Forward> forward;
  resolve_for_engine(engine, map, output, to, forward, write);
}

void tell_frame(const std::string& path, const Engine& engine, const EngineMap& map) {
  note(fmt::format("{}: {}. {}", path, frame_words(map.frame), turns_of(engine)));
}

void add_frame(Report& report, const Engine& engine, const EngineMap& map) {
  report.put("engine", engine.name);
  report.put("frame", frame_words(map.frame));
  report.put("turns", turns_of(engine));
}

void warn_about_clamping(const Engine& engine, const Level& level, double gain, const std::string& command) {
  if (engine.largest == 0) return;
  std::int64_t texels = 0;
  float most = 0;
  for (int face = 0; face < level.faces(); ++face)
    for (int j = 0; j < level.height(); ++j)
      for (const Colour& c : level.row(face, j)) {
        const float value = float(std::max({c.x, c.y, c.z}) * gain);
        texels += value > engine.largest;
        most = std::max(most, value);
      }
  if (texels > 0 && std::isfinite(most))  // Beyond floats, the command fails.
    warn(
        fmt::format("envmap {}: {} texels exceed {:g}, up to {:.3g}, and the loader of {} clamps them: dim the map "
                    "with --exposure, and make it brighter there",
                    command, texels, engine.largest, most, engine.title));
}

}  // namespace tools

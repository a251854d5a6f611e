#include "shared/engine_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "cli/command_line.h"
#include "cli/console.h"
#include "envmap/base/error.h"
#include "envmap/io/file_format.h"

namespace tools {

using namespace envmap;

namespace {

[[noreturn]] void contradict(const Engine& e, const EngineMap& map, const std::string& what) {
  throw UsageError(fmt::format("--for {}: {} takes {} in .{} files: leave out {}", e.name, e.title, frame_words(map.frame),
                               extension_of(map.file), what));
}

}  // namespace

std::string engine_names() {
  std::vector<std::string_view> names;
  for (const Engine& e : engines()) names.push_back(e.name);
  return joined(names);
}

Option& add_engine(Options& o, const Engine*& engine, std::string_view help, bool* list) {
  return o.add(
      "--for", engine_names(),
      [&engine, list](const std::string& word) {
        const auto found = std::ranges::find(engines(), word, &Engine::name);
        if (word == "list" && list == nullptr) throw Asked{engine_list()};
        if (word == "list") return *list = true;
        if (found == engines().end()) return false;
        engine = &*found;
        return true;
      },
      help);
}

std::string engine_list() {
  std::string list;
  for (const Engine& e : engines()) {
    std::vector<std::string_view> files;
    for (const EngineMap& map : e.maps) files.push_back(map.file);
    list += fmt::format("{:12}{} ({})\n{:12}{}: {}; {}\n{:12}rough and diffuse light: {}\n", e.name, e.title, e.version,
                        "", fmt::join(files, ", "), frame_words(e.maps.front().frame), e.turns, "", e.light);
  }
  return list;
}

std::string frame_words(const Frame& frame) {
  const std::string projection = name(frame.projection);
  return has_forward(frame.projection)
             ? fmt::format("{}, {} at the centre", projection, forward_names[static_cast<std::size_t>(frame.forward)])
             : projection;
}

const EngineMap& environment_of(const Engine& engine) {
  const EngineMap& map = engine.maps.front();
  if (map.chain)
    throw UsageError(fmt::format("--for {0}: {1} takes levels of rising roughness alone: 'envmap prefilter --for {0}' makes them",
                                 engine.name, engine.title));
  return map;
}

const EngineMap& prefiltered_of(const Engine& engine, bool diffuse) {
  const auto found = std::ranges::find_if(engine.maps, [&](const EngineMap& m) { return diffuse ? m.diffuse > 0 : m.chain.has_value(); });
  return found == engine.maps.end() ? engine.maps.front() : *found;
}

void settle(const Engine& engine, const EngineMap& map, const std::string& output, std::optional<Projection>& to,
            std::optional<Forward>& forward, WriteOptions& write) {
  if (to && *to != map.frame.projection) contradict(engine, map, fmt::format("--to {}", name(*to)));
  if (forward && has_forward(map.frame.projection) && *forward != map.frame.forward)
    contradict(engine, map, fmt::format("--forward {} (the input's is --from-forward)", forward_names[static_cast<std::size_t>(*forward)]));
  if (write.openexr_envmap) contradict(engine, map, "--openexr-envmap");
  if (write.border > 0) contradict(engine, map, "--border");
  const std::string type = extension_of(map.file), asked = write.format.empty() ? extension_of(output) : write.format;
  if (!asked.empty() && asked != type)
    throw UsageError(output, fmt::format("--for {}: {} takes this map in .{} files", engine.name, engine.title, type));
  write.format = type;
  if (!write.depth) write.depth = map.depth;
  to = map.frame.projection;
  if (has_forward(map.frame.projection)) forward = map.frame.forward;
}

void settle(const Engine& engine, const EngineMap& map, const std::string& output, WriteOptions& write) {
  std::optional<Projection> to;
  std::optional<Forward> forward;
  settle(engine, map, output, to, forward, write);
}

void tell_frame(const std::string& path, const Engine& engine, const EngineMap& map) {
  note(fmt::format("{}: {}: {}", path, frame_words(map.frame), engine.turns));
}

void add_frame(Report& report, const Engine& engine, const EngineMap& map) {
  report.put("engine", engine.name);
  report.put("frame", frame_words(map.frame));
  report.put("turns", engine.turns);
}

void tell_what_is_cut(const Engine& engine, const Level& level, const std::string& command) {
  if (engine.largest == 0) return;
  std::int64_t texels = 0;
  float most = 0;
  for (int face = 0; face < level.faces(); ++face)
    for (int j = 0; j < level.height(); ++j)
      for (const Colour& c : level.row(face, j)) {
        const float value = std::max({c.x, c.y, c.z});
        texels += value > engine.largest;
        most = std::max(most, value);
      }
  if (texels > 0)
    warn(fmt::format("envmap {}: {} keeps values up to {:g}: {} texels up to {:.3g} are cut off by its loader", command, engine.title,
                     engine.largest, texels, most));
}

}  // namespace tools

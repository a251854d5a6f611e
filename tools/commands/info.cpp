#include <fmt/format.h>

#include <string>
#include <variant>
#include <vector>

#include "cli/failure.h"
#include "command.h"
#include "envmap/base/error.h"
#include "envmap/io/formats/file_format.h"
#include "envmap/operate/measure.h"
#include "envmap/operate/sampling.h"
#include "envmap/scenes/lit_scene.h"
#include "envmap/scenes/read/read_scene.h"
#include "maps/map_facts.h"
#include "maps/map_options.h"
#include "maps/read_and_write_maps.h"
#include "scenes/scene_facts.h"
#include "scenes/scene_options.h"

namespace tools {
namespace {

using namespace envmap;

constexpr std::string_view facts_group = "Facts";

struct InfoRequest {
  const Options* options = nullptr;
  std::vector<std::string> inputs;
  ReadOptions read;
  bool sampling = false, levels = false;
  std::optional<Direction> towards;
  std::optional<bool> allow_missing;
};

// Size and flux of each level, and how far the flux is off that of the first.
void add_levels(Report& report, const EnvironmentMap& map) {
  for (const Level& level : map.levels) {
    report.append("level_table[]");
    report.put("level_table[].face_width", level.width());
    report.put("level_table[].face_height", level.height());
    report.put("level_table[].flux", Direction(flux(level)));
    report.put("level_table[].flux_difference", Direction(flux_difference(level, map.base())));
  }
}

void add_sampling(Report& report, const std::vector<SamplingRow>& table) {
  for (const SamplingRow& r : table) {
    report.append("sampling[]");
    report.put("sampling[].texel", ReportValue::Texel{r.i, r.j});
    report.put("sampling[].degrees", r.angle);
    report.put("sampling[].solid_angle", r.solid_angle);
    report.put("sampling[].relative", r.relative);
    report.put("sampling[].anisotropy", r.anisotropy);
  }
}

void print_levels(const EnvironmentMap& map) {
  print(fmt::format("\n{:>5} {:>11}  {:>12} {:>12} {:>12}  {:^32}\n", "level", "faces", "flux R", "G", "B",
                    "difference from level 0"));
  for (std::size_t k = 0; k < map.levels.size(); ++k) {
    const Level& level = map.levels[k];
    const Flux f = flux(level), off = flux_difference(level, map.base());
    print(fmt::format("{:5} {:>11}  {:12.6g} {:12.6g} {:12.6g}  {:+.2e}  {:+.2e}  {:+.2e}\n", k,
                      fmt::format("{}x{}", level.width(), level.height()), f.x, f.y, f.z, off.x, off.y, off.z));
  }
}

bool may_be_scene(const std::string& path) {
  const std::string type = extension_of(path);
  return type == "obj" || type == "gltf" || type == "glb";
}

// A glTF file without the light of a map is a scene. What is neither has the message of that type of file.
std::variant<Source, SceneGraph> read_map_or_scene(const InfoRequest& o, const std::string& input) {
  if (!may_be_scene(input)) return read_map(input, o.read);
  if (extension_of(input) == "obj") return read_scene(input, o.read, o.allow_missing);
  try {
    return read_map(input, o.read);
  } catch (const InputError& no_map) {
    try {
      return read_scene(input, o.read, o.allow_missing);
    } catch (const InputError&) {
      throw no_map;
    }
  }
}

void print_lines(const FactLines& lines) {
  for (const auto& [what, value] : lines) print(fmt::format("{:14} {}\n", what, value));
}

void tell(const InfoRequest& o, const SceneGraph& scene, const std::string& input, Report& report) {
  for (const Option& option : o.options->rows) {
    const bool is_of_maps = option.group == facts_group || option.group == groups::input_map ||
                            option.name == "--input-space" || option.name == "--ocio";
    if (is_of_maps && option.name != "--max-pixels" && option.name != "--allow-missing" &&
        o.options->on_command_line(option.name))
      throw UsageError(input, fmt::format("is a scene: remove {}", option.name));
  }
  for (const std::string& remark : remarks_on(scene)) warn(fmt::format("{}: {}", input, remark));
  if (!settings().json) return print_lines(lines_of(scene, input));
  report.put("file", input);
  add(report, scene);
}

void tell(const InfoRequest& o, const std::string& input, const std::variant<Source, SceneGraph>& found,
          Report& report) {
  if (const SceneGraph* const scene = std::get_if<SceneGraph>(&found)) return tell(o, *scene, input, report);
  if (*o.allow_missing) throw UsageError(input, "is a map: remove --allow-missing");
  const Source& source = std::get<Source>(found);
  const MapFacts facts = facts_of(source, input, o.read.colour.space, o.towards);
  std::vector<SamplingRow> table;
  if (o.sampling) table = sampling_table(source.map.projection(), source.map.base().height());
  if (settings().json) {
    add(report, facts);
    if (o.levels) add_levels(report, source.map);
    add_sampling(report, table);
    return;
  }
  print_lines(lines_of(facts));
  if (o.levels) print_levels(source.map);
  if (o.sampling)
    print(fmt::format("\n{:>14} {:>10} {:>14} {:>10} {:>11}\n", "texel", "degrees", "solid angle/sr", "/ mean",
                      "anisotropy"));
  for (const SamplingRow& r : table)
    print(fmt::format("{:>14} {:10.3f} {:14.5e} {:10.4f} {:11.4g}\n", fmt::format("({},{})", r.i, r.j), r.angle,
                      r.solid_angle, r.relative, r.anisotropy));
}

// JSON of several files: of all of them, or none.
int tell_array(const InfoRequest& o) {
  std::string array;
  for (const std::string& input : o.inputs) {
    Report report;
    tell(o, input, read_map_or_scene(o, input), report);
    array += (array.empty() ? "[\n" : ",\n") + report.text();
  }
  print(array + "]\n");
  return done;
}

// A file that cannot be read has a line, and the others follow. @return the status of the first such file, or 0.
int tell_each(const InfoRequest& o, Report& report) {
  int status = done;
  bool first = true;
  for (const std::string& input : o.inputs) {
    try {
      const auto found = read_map_or_scene(o, input);
      if (!first) print("\n");
      first = false;
      tell(o, input, found, report);
    } catch (const Error& e) {
      const int failed = report_error("envmap info", words_of(e, *o.options), status_of(e.code()));
      if (status == done) status = failed;
    }
  }
  return status;
}

int run(InfoRequest& o, Report& report) {
  if (o.levels && o.read.level > 0) throw UsageError("--levels shows all of them: remove --level");
  o.read.all_levels = o.levels;
  if (settings().json && o.inputs.size() > 1) return tell_array(o);
  if (o.inputs.size() > 1) return tell_each(o, report);
  const std::string& input = o.inputs.front();
  tell(o, input, read_map_or_scene(o, input), report);
  return done;
}

}  // namespace

Action define_info(Options& o) {
  const auto r = std::make_shared<InfoRequest>();
  o.files(r->inputs, File::input, "Maps or scenes to read, or '-' for stdin ({face} in the name: six files)");
  r->options = &o;
  o.group = facts_group;
  o.flag("--levels", r->levels, "Print the size and the flux of every mip level");
  o.flag("--sampling", r->sampling, "Print solid angle and anisotropy of texels, from the centre to the rim");
  o.add("--towards", "X,Y,Z", Triple{&r->towards}, "Normal of the plane of the illuminance (default: 0,1,0, up)");
  add_read_options(o, r->read);
  o.group = groups::input_map;
  add_allow_missing(o, r->allow_missing);
  add_max_memory(o, r->read);
  r->read.flaws = FlawPolicy::keep;
  return [r](Report& report) { return run(*r, report); };
}

}  // namespace tools

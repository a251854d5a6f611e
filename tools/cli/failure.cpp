#include "cli/failure.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "cli/console.h"

namespace tools {
namespace {

// A change that helps, in the words of the program. Empty option: any command can make it.
struct Step {
  const char *option, *words;
};

std::vector<Step> steps(envmap::Remedy remedy, const Options& options) {
  using envmap::Remedy;
  constexpr Step deepen{"--depth", "choose --depth float"}, dim{"--exposure", "lower --exposure"},
      brighten{"--exposure", "raise --exposure"}, clamp{"--clamp", "use --clamp"};
  switch (remedy) {
    case Remedy::choose_projection: return {{"--from", "give its projection with --from"}};
    case Remedy::leave_out_layout: return {{"--layout", "remove --layout"}};
    case Remedy::leave_out_from_layout: return {{"--from-layout", "remove --from-layout"}};
    case Remedy::leave_out_face: return {{"", "remove {face}"}};
    case Remedy::drop_channels: return {{"--drop-channels", "use --drop-channels to ignore them"}};
    case Remedy::repair: return {{"--repair", "use --repair to replace them"}};
    case Remedy::limit_memory: return {{"--max-memory", "use --max-memory"}};
    case Remedy::allow_pixels: return {{"--max-pixels", "raise --max-pixels"}};
    case Remedy::choose_format: return {{"--format", "or use --format"}};
    case Remedy::choose_plus_z: return {{"--forward", "use --forward +z"}};
    case Remedy::clamp_or_deepen: return {deepen, dim, clamp};
    case Remedy::clamp_or_darken:
      return {{"", "write .exr or .hdr"}, dim, {"--display", "use --display neutral for a picture"}, clamp};
    case Remedy::clamp_or_dim: return {dim, clamp};
    case Remedy::clamp_or_brighten: return {deepen, brighten, clamp};
    case Remedy::clamp_or_light_up: return {brighten, clamp};
    case Remedy::choose_space: return {{"--input-space", "give its space with --input-space"}};
    case Remedy::choose_linear:
      return {{"--output-space", "choose a linear --output-space"}, {"--encoded", "use --encoded"}};
    case Remedy::choose_layer: return {{"--layer", "choose one with --layer"}};
    case Remedy::leave_out_shadows: return {{"--no-shadows", "use --no-shadows"}};
    case Remedy::find_circle: return {{"--circle", "use --circle find if it is a photo of a ball"}};
    case Remedy::choose_faces: return {{"--from-faces", "name their convention with --from-faces"}};
    case Remedy::make_levels: return {{"--keep", "remove --keep"}};
    case Remedy::make_cube:
      return {{"", options.has("--to") ? "use --to cube" : "use 'envmap convert --to cube' first"}};
    case Remedy::make_all_levels: return {{"", options.has("--levels") ? "raise --levels" : "use 'envmap mipmap'"}};
    case Remedy::take_base: return {{"--headroom", "use --headroom 0 for the picture without its gain map"}};
    case Remedy::force: return {{"", "make it writable"}, {"--force", "use --force to replace it"}};
    case Remedy::none: break;
  }
  return {};
}

// Names only options that the command has.
std::string advice(envmap::Remedy remedy, const Options& options) {
  std::vector<std::string> words;
  for (const Step& step : steps(remedy, options))
    if (*step.option == 0 || options.has(step.option)) words.emplace_back(step.words);
  if (words.empty()) return "";
  const std::string last = words.back();
  words.pop_back();
  return fmt::format("{}{}{}{}", remedy == envmap::Remedy::choose_format ? ", " : ": ", fmt::join(words, ", "),
                     words.empty() ? "" : " or ", last);
}

}  // namespace

std::string words_of(const envmap::Error& error, const Options& options) {
  return error.what() + advice(error.remedy(), options);
}

Status status_of(envmap::ErrorCode code) {
  switch (code) {
    case envmap::ErrorCode::usage: return usage;
    case envmap::ErrorCode::input: return bad_input;
    case envmap::ErrorCode::output: return not_written;
    case envmap::ErrorCode::renderer: break;
    case envmap::ErrorCode::accuracy: return not_reached;
  }
  return no_renderer;
}

int report_error(const std::string& who, std::string what, int status) {
  std::replace(what.begin(), what.end(), '\n', ' ');
  warn(who + ": " + what);
  return status;
}

}  // namespace tools

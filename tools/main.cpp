// The program: parses, runs one command, turns what goes wrong into one line and an exit status.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "cli/command_line.h"
#include "cli/console.h"
#include "envmap/base/error.h"

using namespace tools;

namespace {

enum Status { done = 0, not_reached = 1, usage = 2, bad_input = 3, not_written = 4, no_renderer = 5 };

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

// A change that helps, in the words of the program. Empty option: any command can make it.
struct Step {
  const char *option, *words;
};

bool has(const Options& options, std::string_view name) {
  return std::ranges::find(options.rows, name, &Option::name) != options.rows.end();
}

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
      return {{"", "choose a floating-point format"}, dim, {"--display", "use --display neutral"}, clamp};
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
      return {{"", has(options, "--to") ? "use --to cube" : "use 'envmap convert --to cube' first"}};
    case Remedy::make_all_levels: return {{"", has(options, "--levels") ? "raise --levels" : "use 'envmap mipmap'"}};
    case Remedy::force: return {{"", "make it writable"}, {"--force", "use --force to replace it"}};
    case Remedy::none: break;
  }
  return {};
}

// Names only options that the command has.
std::string advice(envmap::Remedy remedy, const Options& options) {
  std::vector<std::string> words;
  for (const Step& step : steps(remedy, options))
    if (*step.option == 0 || has(options, step.option)) words.emplace_back(step.words);
  if (words.empty()) return "";
  const std::string last = words.back();
  words.pop_back();
  return fmt::format("{}{}{}{}", remedy == envmap::Remedy::choose_format ? ", " : ": ", fmt::join(words, ", "),
                     words.empty() ? "" : " or ", last);
}

int complain(const std::string& who, std::string what, int status) {
  std::replace(what.begin(), what.end(), '\n', ' ');
  warn(who + ": " + what);
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  // For tests that the bytes do not depend on the processor: the vector code that every x86-64 can run.
  if (std::getenv("ENVMAP_BASELINE") != nullptr) hwy::DisableTargets(~std::int64_t{HWY_STATIC_TARGET});
  Parsed parsed;
  std::string who = "envmap";
  int status = done;
  try {
    if (argc > 1 && std::ranges::find(commands(), argv[1], &Command::name) != commands().end())
      who += " " + std::string(argv[1]);
    parse({argv + 1, argv + argc}, parsed);
    status = run(parsed);
  } catch (const Asked& asked) {
    std::fputs(asked.text.c_str(), stdout);
  } catch (const envmap::Error& e) {
    return complain(who, e.what() + advice(e.remedy(), parsed.options), status_of(e.code()));
  } catch (const std::bad_alloc&) {
    const bool sized = has(parsed.options, "--size");
    return complain(who, sized ? "not enough memory: choose a smaller --size" : "not enough memory", not_written);
  } catch (const std::exception& e) {
    return complain(who, fmt::format("{} (this is a fault of envmap: please report it)", e.what()), bad_input);
  }
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
    return complain(who, "standard output: not written", not_written);
  return status;
}

#include "envmap/io/claims/colour.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "envmap/base/error.h"
#include "envmap/base/suggestions.h"
#include "envmap/io/claims/colour_config.h"

namespace envmap {
namespace {

// A config, and the space in it that is a space of the built-in one: the bridge between the two.
struct Config {
  std::string file;  // Empty: built-in.
  ocio::ConstConfigRcPtr spaces;
  std::string theirs = linear_rec709, ours = linear_rec709;
  std::string note = {};
};

// Exceptions of the library are of several lines.
[[noreturn]] void fail(const std::string& file, const std::string& what) {
  throw InputError(file, "OpenColorIO: " + what.substr(0, what.find_first_of("\r\n")));
}

// As the OpenColorIO configs of ACES, of Blender and of the film industry call linear Rec.709.
constexpr const char* names_of_rec709[] = {"lin_rec709",
                                           "lin_srgb",
                                           "Linear Rec.709 (sRGB)",
                                           "Linear Rec.709",
                                           "Utility - Linear - sRGB",
                                           "Utility - Linear - Rec.709",
                                           "Linear sRGB"};

void find_bridge(Config& config) {
  const auto has = [&](const char* name) { return config.spaces->getColorSpace(name) != nullptr; };
  if (has("aces_interchange")) {
    config.theirs = "aces_interchange", config.ours = aces2065_1;
    return;
  }
  for (const char* name : names_of_rec709)
    if (has(name)) {
      config.theirs = name;
      return;
    }
  if (!has("scene_linear"))
    throw InputError(config.file,
                     "has no role aces_interchange and no space of linear Rec.709: what its spaces are is not known");
  config.theirs = "scene_linear";
  config.note = fmt::format("{} has no role aces_interchange: its scene_linear ({}) is taken for linear Rec.709",
                            config.file, config.spaces->getColorSpace("scene_linear")->getName());
}

Config open(const std::string& file) {
  if (file.empty()) return {file, built_in_config()};
  ocio::SetLoggingLevel(ocio::LOGGING_LEVEL_NONE);
  Config config{file, nullptr};
  try {
    config.spaces = ocio::Config::CreateFromFile(file.c_str());
  } catch (const ocio::Exception& e) {
    fail(file, e.what());
  }
  find_bridge(config);
  return config;
}

std::vector<std::string> all_names(const ocio::Config& config) {
  std::vector<std::string> names;
  for (int k = 0; k < config.getNumColorSpaces(); ++k) {
    names.emplace_back(config.getColorSpaceNameByIndex(k));
    const ocio::ConstColorSpaceRcPtr space = config.getColorSpace(names.back().c_str());
    for (std::size_t a = 0; a < space->getNumAliases(); ++a) names.emplace_back(space->getAlias(a));
  }
  for (int k = 0; k < config.getNumRoles(); ++k) names.emplace_back(config.getRoleName(k));
  return names;
}

void check_space(const Config& config, const std::string& name) {
  if (config.spaces->getColorSpace(name.c_str())) return;
  const std::vector<std::string> known = all_names(*config.spaces), near = near_words(name, known, 3);
  const std::string where = config.file.empty() ? "the built-in config" : config.file;
  if (!near.empty())
    throw UsageError(
        fmt::format("no colour space '{}' in {}; did you mean '{}'?", name, where, fmt::join(near, "' or '")));
  const std::vector<std::string> spaces = colour_spaces(config.file);
  const std::size_t shown = std::min<std::size_t>(spaces.size(), 12);
  throw UsageError(fmt::format("no colour space '{}' in {}: there are {}{}", name, where,
                               fmt::join(spaces.begin(), spaces.begin() + std::ptrdiff_t(shown), ", "),
                               shown < spaces.size() ? ", ..." : ""));
}

void check_view(const Config& config, const std::string& display, const std::string& view) {
  std::vector<std::string> known;
  for (int k = 0; k < config.spaces->getNumViews(display.c_str()); ++k)
    known.emplace_back(config.spaces->getView(display.c_str(), k));
  if (std::ranges::find(known, view) != known.end()) return;
  if (!known.empty())
    throw UsageError(fmt::format("no view '{}' of display '{}' in {}: there are {}", view, display, config.file,
                                 fmt::join(known, ", ")));
  for (int k = 0; k < config.spaces->getNumDisplays(); ++k) known.emplace_back(config.spaces->getDisplay(k));
  throw UsageError(fmt::format("no display '{}' in {}: there are {}", display, config.file, fmt::join(known, ", ")));
}

// A space of one of two configs.
struct Place {
  const Config* config;
  std::string name;
};

ocio::ConstProcessorRcPtr between(const Place& from, const Place& to) {
  if (from.config->spaces == to.config->spaces)
    return from.config->spaces->getProcessor(from.name.c_str(), to.name.c_str());
  // The bridge in the terms of each: one of the two configs is ours.
  const Config& other = from.config->file.empty() ? *to.config : *from.config;
  const auto bridge = [&](const Place& p) { return (p.config == &other ? other.theirs : other.ours).c_str(); };
  return ocio::Config::GetProcessorFromConfigs(from.config->spaces, from.name.c_str(), bridge(from), to.config->spaces,
                                               to.name.c_str(), bridge(to));
}

// @param file of errors.
ColourTransform transform(const Place& from, const Place& to, const Config& config) {
  try {
    const ocio::ConstProcessorRcPtr processor = between(from, to);
    ColourTransform made{.note = config.note};
    if (!config.file.empty()) made.files.push_back(config.file);
    const ocio::ConstProcessorMetadataRcPtr about = processor->getProcessorMetadata();
    for (int k = 0; k < about->getNumFiles(); ++k) made.files.emplace_back(about->getFile(k));
    if (!processor->isNoOp())
      made.apply = [cpu = on_cpu(processor)](std::span<Colour> colours) { apply(cpu, colours); };
    return made;
  } catch (const ocio::Exception& e) {
    fail(config.file.empty() ? "the built-in config" : config.file, e.what());
  }
}

Place place_of(const Config& config, const Config& built_in, const std::string& name) {
  if (name.empty()) return {&built_in, linear_rec709};
  check_space(config, name);
  return {config.file.empty() ? &built_in : &config, name};
}

// What a space makes of red, green and blue, of twice as much and of black, as CIE XYZ under D65.
struct Response {
  ColourMatrix once, twice;
  Colour black;
  [[nodiscard]] bool is_linear() const {
    double off = std::max({std::abs(black.x), std::abs(black.y), std::abs(black.z)});
    for (int k = 0; k < 3; ++k)
      for (int c = 0; c < 3; ++c) off = std::max(off, std::abs(twice[k][c] - 2 * once[k][c]));
    return off < 1e-4;
  }
};

Response response(const Config& config, const std::string& space) {
  const Config built_in = open("");
  const ColourTransform to_xyz = transform(place_of(config, built_in, space), {&built_in, "XYZ"}, config);
  Colour c[7] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}, Colour(0)};
  if (to_xyz.apply) to_xyz.apply(c);
  return {ColourMatrix(c[0], c[1], c[2]), ColourMatrix(c[3], c[4], c[5]), c[6]};
}

Point2 xy_of(const Flux& xyz) {
  const double sum = xyz.x + xyz.y + xyz.z;
  return {xyz.x / sum, xyz.y / sum};
}

}  // namespace

std::vector<std::string> colour_spaces(const std::string& config) {
  const Config opened = open(config);
  std::vector<std::string> names;
  for (int k = 0; k < opened.spaces->getNumColorSpaces(); ++k)
    names.emplace_back(opened.spaces->getColorSpaceNameByIndex(k));
  return names;
}

ColourTransform into_working(const ColourOptions& options, const ClaimedSpace& claimed) {
  // What files say needs no config, nor what it lacks.
  const bool from_file = options.space.empty();
  const Config config = open(from_file && options.working.empty() ? "" : options.config);
  Config built_in = open("");
  const Place to = place_of(config, built_in, options.working);
  if (!from_file) return transform(place_of(config, built_in, options.space), to, config);
  if (!claimed.name.empty()) return transform({&built_in, claimed.name}, to, config);
  if (!claimed.primaries) return transform({&built_in, linear_rec709}, to, config);
  constexpr const char* unnamed = "primaries of the file";
  built_in.spaces = config_with(*claimed.primaries, unnamed);
  return transform({&built_in, unnamed}, to, config);
}

ColourTransform out_of_working(const ColourOptions& options) {
  const Config config = open(options.space.empty() && options.working.empty() ? "" : options.config),
               built_in = open("");
  return transform(place_of(config, built_in, options.working), place_of(config, built_in, options.space), config);
}

ColourTransform into_view(const ColourOptions& options, const std::string& wanted) {
  const Config config = open(options.config), built_in = open("");
  if (config.file.empty())
    throw UsageError("the built-in config has no views: name an OpenColorIO config that has some");
  const auto colon = wanted.find(':');
  const std::string display = colon == wanted.npos ? config.spaces->getDefaultDisplay() : wanted.substr(0, colon);
  std::string view = wanted.substr(colon == wanted.npos ? 0 : colon + 1);
  if (view.empty()) view = config.spaces->getDefaultView(display.c_str());
  check_view(config, display, view);
  ColourTransform made = transform(place_of(config, built_in, options.working), {&config, config.theirs}, config);
  try {
    const auto seen = on_cpu(
        config.spaces->getProcessor(config.theirs.c_str(), display.c_str(), view.c_str(), ocio::TRANSFORM_DIR_FORWARD));
    made.apply = [first = made.apply, seen](std::span<Colour> colours) {
      if (first) first(colours);
      apply(seen, colours);
    };
  } catch (const ocio::Exception& e) {
    fail(config.file, e.what());
  }
  return made;
}

std::string working_space_for(const std::string& file, const std::string& space) {
  if (space.empty()) return "";
  const Config config = open(file);
  check_space(config, space);
  if (config.file.empty()) return std::string(built_in_space(space)->linear);
  return response(config, space).is_linear() ? space : "";
}

std::optional<Primaries> primaries_of(const std::string& file, const std::string& space) {
  if (space.empty()) return rec709;
  const Config config = open(file);
  check_space(config, space);
  if (config.file.empty()) return built_in_space(space)->primaries;
  const Response r = response(config, space);
  if (!r.is_linear()) return std::nullopt;
  for (const BuiltInSpace& known : built_in_spaces())  // Under their own white.
    if (known.is_linear()) {
      const ColourMatrix m = to_xyz(rec709) * conversion(known.primaries, rec709);
      double off = 0;
      for (int k = 0; k < 3; ++k)
        for (int c = 0; c < 3; ++c) off = std::max(off, std::abs(m[k][c] - r.once[k][c]));
      if (off < 1e-3) return known.primaries;
    }
  return Primaries{xy_of(r.once[0]), xy_of(r.once[1]), xy_of(r.once[2]), rec709.white};
}

std::string space_with(const Primaries& primaries) {
  for (const BuiltInSpace& space : built_in_spaces())
    if (space.is_linear() && same(space.primaries, primaries)) return std::string(space.name);
  return "";
}

std::string encoded_space_with(const Primaries& primaries) {
  for (const BuiltInSpace& space : built_in_spaces())
    if (!space.is_linear() && same(space.primaries, primaries)) return std::string(space.name);
  return "";
}

Curve curve_of(const std::string& file, const std::string& space) {
  if (space.empty()) return Curve::linear;
  const Config config = open(file);
  check_space(config, space);
  if (config.file.empty()) return built_in_space(space)->is_linear() ? Curve::linear : Curve::srgb;
  return response(config, space).is_linear() ? Curve::linear : Curve::other;
}

std::string space_word(const std::string& config, const std::string& space) {
  const BuiltInSpace* found = built_in_space(space);
  if (!config.empty()) {
    const std::optional<Primaries> p = primaries_of(config, space);
    found = p ? built_in_space(space_with(*p)) : nullptr;
  }
  if (found == nullptr) return "";
  if (found->name.find(' ') == std::string_view::npos) return std::string(found->name);
  const auto one_word = [](std::string_view alias) { return alias.find(' ') == std::string_view::npos; };
  return std::string(*std::ranges::find_if(found->aliases, one_word));
}

std::string words(const ClaimedSpace& claimed) {
  if (claimed.by.empty()) return fmt::format("{} (assumed, not specified in the file)", linear_rec709);
  const std::string name = !claimed.name.empty()
                               ? claimed.name
                               : fmt::format("primaries {:.4g}", fmt::join(chromaticities(*claimed.primaries), " "));
  return fmt::format("{} ({})", name, claimed.by);
}

std::array<float, 8> chromaticities(const Primaries& p) {
  const auto f = [](double x) { return float(x); };
  return {f(p.red.x), f(p.red.y), f(p.green.x), f(p.green.y), f(p.blue.x), f(p.blue.y), f(p.white.x), f(p.white.y)};
}

Primaries primaries(const std::array<float, 8>& c) { return {{c[0], c[1]}, {c[2], c[3]}, {c[4], c[5]}, {c[6], c[7]}}; }

}  // namespace envmap

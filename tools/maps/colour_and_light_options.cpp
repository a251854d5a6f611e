#include "maps/colour_and_light_options.h"

#include <fmt/format.h>

#include <cmath>

#include "cli/console.h"
#include "envmap/base/error.h"
#include "envmap/operate/grade.h"
#include "envmap/operate/refuse_flaws.h"

namespace tools {

using namespace envmap;

void choose_working_space(ReadOptions& read, WriteOptions& write) {
  read.colour.working = working_space_for(read.colour.config, write.colour.space);
  write.colour.config = read.colour.config;
  write.colour.working = read.colour.working;
}

void add_grade(Options& o, GradeOptions& g) {
  o.group = groups::colour;
  o.add("--scale-to", "lux=E|nits=L", &g.scale_to, "Scale to illuminance E, or to luminance L, in direction --towards");
  o.add("--towards", "X,Y,Z", Triple{&g.towards}, "Direction for --scale-to (default: 0,1,0, up)").folded = true;
  o.need("--scale-to", {"--towards"});
  o.add("--white", "X,Y,Z|KELVIN", &g.white, "White balance on direction X,Y,Z, or on a colour temperature");
  o.add("--gain", "R,G,B", Triple{&g.gain, true}, "Multiply the channels");
  o.add("--saturation", "S", &g.saturation, range_of(limits::saturation),
        "0 is grey, 1 is unchanged, luminance is preserved (default: 1)");
}

Direction unit_or_up(const std::optional<Direction>& direction, const char* option) {
  const Direction d = direction.value_or(Direction(0, 1, 0));
  if (glm::dot(d, d) == 0) throw UsageError(fmt::format("{}: 0,0,0 is not a direction", option));
  return glm::normalize(d);
}

namespace {

constexpr double seen_within = 1;  // Degrees.

std::optional<double> number_of(const std::string& text) {
  double number = 0;
  return parse_number(text, number) && std::isfinite(number) ? std::optional(number) : std::nullopt;
}

Flux white_gain(const EnvironmentMap& map, const std::string& white, const Primaries& primaries) {
  const bool unit = white.size() > 1 && white.ends_with('K');
  if (const auto kelvin = number_of(unit ? white.substr(0, white.size() - 1) : white)) {
    if (*kelvin < 1000 || *kelvin > 25000)
      throw UsageError(fmt::format("--white {}: a temperature is 1000 to 25000 kelvins", white));
    return white_balance(*kelvin, primaries);
  }
  const auto direction = triple_of(white);
  if (!direction)
    throw UsageError(fmt::format("--white: '{}' is neither a direction X,Y,Z nor a temperature in kelvins", white));
  try {
    const Flux grey = radiance_within(map, unit_or_up(direction, "--white"), seen_within);
    return white_balance(grey, luminance_weights(primaries));
  } catch (const UsageError& e) {
    throw UsageError(fmt::format("--white {}: {}", white, e.what()));
  }
}

// The factor that makes the light what --scale-to says.
double scale_of(const EnvironmentMap& map, const GradeOptions& o, const Flux& luminance) {
  const auto equals = o.scale_to.find('=');
  const std::string unit = o.scale_to.substr(0, equals);
  double wanted = 0;
  const bool is_number = equals != std::string::npos && parse_number(o.scale_to.substr(equals + 1), wanted);
  if ((unit != "lux" && unit != "nits") || !is_number || !(wanted > 0) || !std::isfinite(wanted))
    throw UsageError(fmt::format("--scale-to: '{}' is neither lux=E nor nits=L with a number above 0", o.scale_to));
  const Direction towards = unit_or_up(o.towards, "--towards");
  const Flux light = unit == "lux" ? irradiance(map, towards) : radiance_within(map, towards, seen_within);
  const double is = glm::dot(light, luminance);
  if (!(is > 0)) throw UsageError(fmt::format("--scale-to {}: no light arrives from that direction", o.scale_to));
  return wanted / is;
}

}  // namespace

void check_finite(const Level& level, const std::string& option, const std::string& remedy) {
  if (!all_finite(level))
    throw UsageError(fmt::format("{}: radiance exceeds 3.4e38, the largest float: {}", option, remedy));
}

void grade(Source& source, const GradeOptions& o, const ColourOptions& working) {
  if (o.gain && !(o.gain->x >= 0 && o.gain->y >= 0 && o.gain->z >= 0))
    throw UsageError("--gain: factors must not be negative");
  const Primaries primaries = primaries_of(working.config, working.working).value_or(rec709);
  Grade grade{.saturation = o.saturation, .luminance = luminance_weights(primaries)};
  if (!o.white.empty()) grade.gain = white_gain(source.map, o.white, primaries);
  if (!o.white.empty())
    detail(fmt::format("--white: gains {:.6g} {:.6g} {:.6g}", grade.gain.x, grade.gain.y, grade.gain.z));
  if (o.gain) grade.gain *= Flux(*o.gain);
  if (grade.changes())
    for (Level& level : source.map.levels) {
      apply(grade, level);
      const std::string option = o.gain ? "--gain" : o.white.empty() ? "--saturation" : "--white";
      check_finite(level, option, "lower " + option);
    }
  if (o.scale_to.empty()) return;
  const double scale = scale_of(source.map, o, grade.luminance);
  for (Level& level : source.map.levels) {
    apply({.gain = Flux(scale)}, level);
    check_finite(level, "--scale-to", "lower --scale-to");
  }
  note(fmt::format("envmap convert: --scale-to {}: times {:.6g}", o.scale_to, scale));
  source.provenance.white_luminance = 1.0F;
}

}  // namespace tools

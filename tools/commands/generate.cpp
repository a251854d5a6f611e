#include "envmap/operate/generate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "command.h"
#include "envmap/base/error.h"
#include "envmap/base/words.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/atmosphere.h"
#include "maps/map_options.h"
#include "maps/read_and_write_maps.h"

namespace tools {
namespace {

using namespace envmap;

constexpr std::string_view kinds[] = {"constant", "gradient", "checker", "directions", "faces",
                                      "sun",      "sky",      "sh",      "atmosphere"};
enum class Kind { constant, gradient, checker, directions, faces, sun, sky, sh, atmosphere };

constexpr std::string_view scatterings[] = {"single", "multiple"};

struct Request {
  Kind kind{};
  std::string output;
  std::optional<Projection> to;
  std::optional<Forward> forward;
  int size = 256;
  std::optional<Vec3<double>> value, value2, towards, zenith, horizon, ground;
  int squares = 8;
  Sun sun;
  Harmonic harmonic;
  std::optional<double> elevation, azimuth;
  Atmosphere atmosphere;
  bool no_sun = false;
  WriteOptions write;
};

Direction unit_towards(const Direction& d) {
  if (d == Direction(0)) throw UsageError("--direction: not 0,0,0");
  // First by its largest part: squares of 1e-200 are 0, those of 1e200 infinite.
  const Vec3<double> size = glm::abs(d);
  return glm::normalize(d / std::max({size.x, size.y, size.z}));
}

Sky sky_of(const Request& o) {
  Sky sky;
  if (o.zenith) sky.zenith = Rgb<double>(*o.zenith);
  if (o.ground) sky.ground = Rgb<double>(*o.ground);
  if (o.horizon) sky.horizon = Rgb<double>(*o.horizon);
  return sky;
}

Pattern pattern(const Request& o) {
  switch (o.kind) {
    case Kind::constant: return Constant{Rgb<double>(o.value.value_or(Vec3<double>(1)))};
    case Kind::gradient:
      return Gradient{Rgb<double>(o.value2.value_or(Vec3<double>(0.1))),
                      Rgb<double>(o.value.value_or(Vec3<double>(1)))};
    case Kind::checker:
      return Checker{o.squares, Rgb<double>(o.value.value_or(Vec3<double>(1))),
                     Rgb<double>(o.value2.value_or(Vec3<double>(0.1)))};
    case Kind::directions: return Directions{};
    case Kind::faces: return Faces{};
    case Kind::sky: return sky_of(o);
    case Kind::sh: return o.harmonic;
    case Kind::sun:
    case Kind::atmosphere: break;
  }
  Sun sun = o.sun;
  sun.sky = sky_of(o);
  if (o.towards) sun.towards = unit_towards(*o.towards);
  if (o.value) sun.radiance = Rgb<double>(*o.value);
  return sun;
}

Atmosphere atmosphere_of(const Request& o) {
  Atmosphere a = o.atmosphere;
  const double up = o.elevation.value_or(30) / 180, round = o.azimuth.value_or(0) / 180;
  a.sun = {portable::cos_pi(up) * portable::sin_pi(round), portable::sin_pi(up),
           portable::cos_pi(up) * portable::cos_pi(round)};
  if (o.towards) a.sun = unit_towards(*o.towards);
  if (o.ground) a.ground = Rgb<double>(*o.ground);
  a.radius_degrees = o.sun.radius_degrees;
  a.disc = !o.no_sun;
  return a;
}

// Each option of the pattern, and the kinds that it changes.
struct OptionOfKinds {
  std::string_view option;
  std::vector<Kind> kinds;
};
const OptionOfKinds options_of_kinds[] = {
    {"--value", {Kind::constant, Kind::gradient, Kind::checker, Kind::sun}},
    {"--value2", {Kind::gradient, Kind::checker}},
    {"--squares", {Kind::checker}},
    {"--direction", {Kind::sun, Kind::atmosphere}},
    {"--radius", {Kind::sun, Kind::atmosphere}},
    {"--zenith", {Kind::sun, Kind::sky}},
    {"--horizon", {Kind::sun, Kind::sky}},
    {"--ground", {Kind::sun, Kind::sky, Kind::atmosphere}},
    {"--elevation", {Kind::atmosphere}},
    {"--azimuth", {Kind::atmosphere}},
    {"--turbidity", {Kind::atmosphere}},
    {"--altitude", {Kind::atmosphere}},
    {"--scattering", {Kind::atmosphere}},
    {"--no-sun", {Kind::atmosphere}},
    {"--degree", {Kind::sh}},
    {"--order", {Kind::sh}},
    {"--base", {Kind::sh}},
    {"--amplitude", {Kind::sh}},
};

void check_kind(Kind kind, const Options& options) {
  for (const auto& [option, of_kinds] : options_of_kinds) {
    if (!options.given(option) || std::ranges::find(of_kinds, kind) != of_kinds.end()) continue;
    std::vector<std::string_view> words;
    for (const Kind other : of_kinds) words.push_back(kinds[std::size_t(other)]);
    const bool aims = kind == Kind::sun && (option == "--elevation" || option == "--azimuth");
    throw UsageError(fmt::format("{} is for {}: {}", option, enumerated(words, " and "),
                                 aims ? "use --direction X,Y,Z" : "remove it"));
  }
}

void check(const Harmonic& h) {
  if (h.degree >= 0 && std::abs(h.order) > h.degree)
    throw UsageError(
        fmt::format("--order: must be from {} to {} with --degree {}, not {}", -h.degree, h.degree, h.degree, h.order));
}

EnvironmentMap daylight(const Request& o, const Frame& to, const Run& run, WriteOptions& write, Report& report) {
  const Atmosphere a = atmosphere_of(o);
  Daylight made = generate(a, to, o.size, run);
  write.provenance.white_luminance = float(luminous_efficacy);
  report.put("sun.direction", a.sun);
  report.put("sun.illuminance", made.sun_normal);
  report.put("sun.horizontal_illuminance", made.sun_horizontal);
  report.put("sky.horizontal_illuminance", made.sky_horizontal);
  report.put("white_luminance", luminous_efficacy);
  note(fmt::format("envmap generate: at the viewer's height {:.4g} lux of the sun and {:.4g} lux of the sky",
                   made.sun_horizontal, made.sky_horizontal));
  return std::move(made.map);
}

int run(const Request& o, const Options& options, Report& report) {
  const Frame to{o.to.value_or(Projection::latlong), o.forward.value_or(Forward::plus_z)};
  check_kind(o.kind, options);
  check(o.harmonic);
  check_output(o.output, o.write, to.projection);
  if (o.forward && !has_forward(to.projection)) throw UsageError("--forward is for latlong and angular maps");
  const Run run{.progress = progress_line("generate")};
  WriteOptions write = o.write;
  const EnvironmentMap map =
      o.kind == Kind::atmosphere ? daylight(o, to, run, write, report) : generate(pattern(o), to, o.size, run);
  report.put("kind", kinds[std::size_t(o.kind)]);
  report.put_written(o.output, write_map(o.output, rows_of(map), write, "write"));
  report.put_seconds();
  tell_lost_facts(o.output, map.frame(), write);
  return 0;
}

}  // namespace

Action define_generate(Options& o) {
  const auto r = std::make_shared<Request>();
  o.add("KIND", one_of(r->kind, kinds), "{}").required = true;
  o.writes("OUTPUT", r->output, "File to write, or '-' for stdout ({face} in the name: six files)").required = true;
  o.group = "Pattern";
  o.add("--value", "R,G,B", Triple{&r->value, true},
        "Radiance: constant, top of gradient, even squares, sun (default: 1)");
  o.add("--value2", "R,G,B", Triple{&r->value2, true}, "Radiance: bottom of gradient, odd squares (default: 0.1)");
  o.add("--squares", "N", &r->squares, "checker: squares from pole to pole (default: 8)");
  o.add("--direction", "X,Y,Z", Triple{&r->towards},
        "sun, atmosphere: direction of the sun (default: 0,0,1; of an atmosphere by --elevation)");
  o.add("--radius", "DEGREES", &r->sun.radius_degrees, "sun, atmosphere: angular radius in degrees (default: 0.2666)");
  o.add("--zenith", "R,G,B", Triple{&r->zenith, true}, "sun, sky: radiance of the zenith (default: 1)");
  o.add("--horizon", "R,G,B", Triple{&r->horizon, true},
        "sun, sky: radiance of the horizon (default: a third of the zenith's)");
  o.add("--ground", "R,G,B", Triple{&r->ground, true},
        "sun, sky: radiance of the ground; atmosphere: its albedo (default: 0.2)");
  o.add("--elevation", "DEGREES", &r->elevation, {-90, 90}, "atmosphere: height of the sun (default: 30)").excludes =
      "--direction";
  o.add("--azimuth", "DEGREES", &r->azimuth, {-360, 360}, "atmosphere: sun's angle from +Z towards +X (default: 0)")
      .excludes = "--direction";
  o.add("--turbidity", "T", &r->atmosphere.turbidity, range_of(limits::turbidity),
        "atmosphere: haze, from 1 (none) to 10 (default: 2.5)");
  o.add("--altitude", "METRES", &r->atmosphere.altitude, range_of(limits::altitude),
        "atmosphere: height of the viewer above the ground (default: 0)");
  o.add("--scattering", one_of(r->atmosphere.scattering, scatterings), "atmosphere: {} (default: multiple)");
  o.flag("--no-sun", r->no_sun, "atmosphere: leave out the sun's disc");
  o["--no-sun"].excludes = "--radius";
  o.add("--degree", "L", &r->harmonic.degree, "sh: degree l of the harmonic (default: 2)");
  o.add("--order", "M", &r->harmonic.order, "sh: order m of the harmonic, -L to L (default: 0)");
  o.add("--base", "L", &r->harmonic.base, "sh: radiance to which the harmonic is added (default: 1)");
  o.add("--amplitude", "A", &r->harmonic.amplitude, "sh: factor of the harmonic (default: 0.5)");
  o.group = groups::output_map;
  add_projection(o, "--to PROJECTION", r->to, "{} (default: latlong)");
  add_size(o, &r->size, "Height of the image or of one cube face (default: 256)");
  add_forward(o, "--forward AXIS", r->forward, "Axis at the centre of latlong and angular maps: {} (default: +z)");
  add_layout(o, "--layout", r->write.layout, "Cube faces: {} (default: column)");
  add_faces(o, r->write);
  add_write_options(o, r->write, "float, or nearest");
  return [r, &o](Report& report) { return run(*r, o, report); };
}

}  // namespace tools

#include "envmap/operate/generate.h"

#include <fmt/format.h>

#include <algorithm>

#include "command.h"
#include "envmap/base/error.h"
#include "shared/map_options.h"
#include "shared/maps.h"

namespace tools {
namespace {

using namespace envmap;

constexpr std::string_view kinds[] = {"constant", "gradient", "checker", "directions", "faces", "sun", "sky", "sh"};
enum class Kind { constant, gradient, checker, directions, faces, sun, sky, sh };

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
  WriteOptions write;
};

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
    case Kind::sun: break;
  }
  Sun sun = o.sun;
  sun.sky = sky_of(o);
  if (o.towards == Direction(0)) throw UsageError("--direction: not 0,0,0");
  if (o.towards) {
    // First by its largest part: squares of 1e-200 are 0, those of 1e200 infinite.
    const Vec3<double> size = glm::abs(*o.towards);
    sun.towards = glm::normalize(*o.towards / std::max({size.x, size.y, size.z}));
  }
  if (o.value) sun.radiance = Rgb<double>(*o.value);
  return sun;
}

int run(const Request& o) {
  const Projection to = o.to.value_or(Projection::latlong);
  check_output(o.output, o.write, to);
  if (o.forward && !has_forward(to)) throw UsageError("--forward is for latlong and angular maps");
  const EnvironmentMap map =
      generate(pattern(o), {to, o.forward.value_or(Forward::plus_z)}, o.size, {.progress = progress_line("generate")});
  write_map(o.output, rows_of(map), o.write, "write");
  tell_lost_axis(o.output, map.frame(), o.write);
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
  o.add("--direction", "X,Y,Z", Triple{&r->towards}, "sun: direction (default: 0,0,1)");
  o.add("--radius", "DEGREES", &r->sun.radius_degrees, "sun: angular radius in degrees (default: 0.2666)");
  o.add("--zenith", "R,G,B", Triple{&r->zenith, true}, "sun, sky: radiance of the zenith (default: 1)");
  o.add("--horizon", "R,G,B", Triple{&r->horizon, true},
        "sun, sky: radiance of the horizon (default: a third of the zenith's)");
  o.add("--ground", "R,G,B", Triple{&r->ground, true}, "sun, sky: radiance of the ground (default: 0.2)");
  o.add("--degree", "L", &r->harmonic.degree, "sh: degree l of the harmonic (default: 2)");
  o.add("--order", "M", &r->harmonic.order, "sh: order m of the harmonic, -L to L (default: 0)");
  o.add("--base", "L", &r->harmonic.base, "sh: radiance to which the harmonic is added (default: 1)");
  o.add("--amplitude", "A", &r->harmonic.amplitude, "sh: factor of the harmonic (default: 0.5)");
  o.group = groups::output_map;
  add_projection(o, "--to PROJECTION", r->to, "{} (default: latlong)");
  add_size(o, &r->size, "Height of the image or of one cube face (default: 256)");
  add_forward(o, "--forward AXIS", r->forward, "Axis at the centre of latlong and angular maps: {} (default: +z)");
  add_layout(o, "--layout", r->write.layout, "Cube faces: {} (default: column)");
  add_write_options(o, r->write, "float, or nearest");
  return [r](Report&) { return run(*r); };
}

}  // namespace tools

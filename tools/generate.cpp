#include "envmap/operate/generate.h"

#include <fmt/format.h>

#include <algorithm>

#include "command.h"
#include "envmap/base/error.h"

namespace tools {
namespace {

using namespace envmap;

constexpr std::string_view kinds[] = {"constant", "gradient", "checker", "directions", "faces", "sun", "sky", "sh"};
enum class Kind { constant, gradient, checker, directions, faces, sun, sky, sh };

struct Options {
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

Sky sky_of(const Options& o) {
  Sky sky;
  if (o.zenith) sky.zenith = Rgb<double>(*o.zenith);
  if (o.ground) sky.ground = Rgb<double>(*o.ground);
  if (o.horizon) sky.horizon = Rgb<double>(*o.horizon);
  return sky;
}

Pattern pattern(const Options& o) {
  switch (o.kind) {
    case Kind::constant: return Constant{Rgb<double>(o.value.value_or(Vec3<double>(1)))};
    case Kind::gradient: return Gradient{Rgb<double>(o.value2.value_or(Vec3<double>(0.1))), Rgb<double>(o.value.value_or(Vec3<double>(1)))};
    case Kind::checker: return Checker{o.squares, Rgb<double>(o.value.value_or(Vec3<double>(1))), Rgb<double>(o.value2.value_or(Vec3<double>(0.1)))};
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

int run(const Options& o, const Common& common) {
  const Projection to = o.to.value_or(Projection::latlong);
  check_output(o.output, o.write, to);
  if (o.forward && !has_forward(to)) throw UsageError("--forward is for latlong and angular maps");
  const EnvironmentMap map =
      generate(pattern(o), {to, o.forward.value_or(Forward::plus_z)}, o.size, progress_line(common, "generate"));
  write_map(o.output, rows_of(map), o.write, {}, "write", common);
  return 0;
}

}  // namespace

Command generate_command() {
  return {
      .name = "generate",
      .summary = "Make an environment map with a known answer",
      .description =
          "constant: --value everywhere. gradient: --value2 at -Y to --value at +Y, linear in y. checker: squares of "
          "longitude and "
          "latitude. directions: RGB = (direction + 1) / 2 of each texel's centre, world frame. faces: those of a cube, +X "
          "red, -X cyan, +Y green, -Y magenta, +Z blue, -Z yellow. sky: CIE overcast sky, "
          "zenith "
          "(1 + 2 y) / 3, over an even ground; a floor receives 7 pi / 9 x zenith. sun: a disc of even radiance over "
          "such "
          "a sky; its flux, 2 pi (1 - cos radius) x radiance, is kept at any size. sh: base + amplitude x one real "
          "orthonormal "
          "spherical harmonic with +Y as polar axis, longitude from +Z to +X, no Condon-Shortley phase, cosines for "
          "positive "
          "and sines for negative orders.",
      .examples = {{"envmap generate directions axes.exr --to cube --size 64",
                    "colours that tell the direction, to look for flips"},
                   {"envmap generate sun sun.exr --size 1024 --radius 0.27 --value 1e6 --direction 1,2,1",
                    "a sun over an overcast sky"},
                   {"envmap generate sun day.exr --direction 1,1,1 --value 20000,18000,15000 --zenith 0.15,0.35,0.9 --horizon 0.75,0.85,1",
                    "a sun in a blue sky"},
                   {"envmap generate sh y20.exr --degree 2 --order 0", "one spherical harmonic on a grey ground"}},
      .writes = true,
      .define = [](CLI::App& app, const Common& common) -> std::function<int()> {
        auto o = std::make_shared<Options>();
        add_choice(app, "KIND", o->kind, joined(kinds), one_of<Kind>(kinds), "What to make")->required();
        app.add_option("OUTPUT", o->output, "File to write, '-' for standard output")->required();
        add_projection(app, "--to", o->to, "Projection (default: latlong)");
        add_size(app, o->size, "Height of a face (default: 256)");
        add_layout(app, "--layout", o->write.layout, "Where cube faces lie (default: column)");
        add_forward(app, "--forward", o->forward, "World axis at the centre of a latlong or angular map (default: +z)");
        add_triple(app, "--value", o->value, "R,G,B", true, "Radiance: of all, at the top, of even squares, of the sun");
        add_triple(app, "--value2", o->value2, "R,G,B", true, "Radiance at the bottom, of odd squares (default: 0.1)");
        app.add_option("--squares", o->squares, "checker: squares from pole to pole (default: 8)")->type_name("N");
        add_triple(app, "--direction", o->towards, "X,Y,Z", false, "sun: where it stands (default: 0,0,1)");
        app.add_option("--radius", o->sun.radius, "sun: its angular radius in degrees (default: 0.2666)")
            ->type_name("DEGREES");
        add_triple(app, "--zenith", o->zenith, "R,G,B", true, "sun, sky: radiance of the zenith (default: 1)");
        add_triple(app, "--horizon", o->horizon, "R,G,B", true,
                   "sun, sky: radiance at the horizon, linear in y from there to the zenith (default: a third of the zenith's)");
        add_triple(app, "--ground", o->ground, "R,G,B", true, "sun, sky: radiance of the ground (default: 0.2)");
        app.add_option("--degree", o->harmonic.degree, "sh: degree of the harmonic (default: 2)")->type_name("L");
        app.add_option("--order", o->harmonic.order, "sh: order of the harmonic, -L to L (default: 0)")->type_name("M");
        app.add_option("--base", o->harmonic.base, "sh: radiance the harmonic is added to (default: 1)")
            ->type_name("L");
        app.add_option("--amplitude", o->harmonic.amplitude, "sh: factor of the harmonic (default: 0.5)")
            ->type_name("A");
        add_write_options(app, o->write);
        return [o, &common] { return run(*o, common); };
      }};
}

}  // namespace tools

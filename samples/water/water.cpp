// Water in a basin: drops fall, waves run, and every frame the library draws them: what the water reflects and what it
// refracts are looked up in a dual-paraboloid map of sky and surroundings, or followed by rays. Writes one picture a frame.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <iostream>

#include "envmap/envmap.h"
#include "envmap/scenes/read/read_scene.h"
#include "envmap/scenes/render/context.h"
#include "envmap/scenes/render/rays/raycast.h"
#include "painter.h"

namespace {

using namespace envmap;
using namespace water;

struct Settings {
  std::string output, sky, model, method = "maps";
  int frames = 96, first = 0, height = 360, samples = 4, columns = 192, steps = 6, drops = 20;
  double spring = 0.12, damping = 0.0015, depth = 0.05, exposure = 0, fov = 45, model_height = 0.6;
  std::vector<double> tint{0.7, 0.16, 0.1}, camera{0.5, 0.52, 1.35}, look_at{-0.1, 0.14, -0.6};
  Basin basin;
};

Direction direction_of(const std::vector<double>& v) { return {v[0], v[1], v[2]}; }

// What a file holds, or a blue sky with a sun.
EnvironmentMap make_sky(const std::string& path) {
  if (!path.empty()) return convert(std::move(read(path).map), {.to = Projection::cube, .size = 512});
  return generate(
      Sun{.towards = glm::normalize(Direction(-0.4, 0.8, 0.4)),
          .radius_degrees = 1,
          .radiance = {6000, 5300, 4300},
          .sky = {.zenith = {0.1, 0.3, 0.9}, .ground = {0.16, 0.19, 0.11}, .horizon = Rgb<double>(0.7, 0.82, 0.95)}},
      Projection::cube, 512);
}

// To where the sky is brightest; from above, where that is not.
Direction sun_of(const EnvironmentMap& sky) {
  const Direction brightest = measure(sky).brightest_direction;
  return brightest.y > 0.2 ? brightest : Direction(0, 1, 0);
}

Viewpoint camera_of(const Settings& s) {
  const Direction at = direction_of(s.camera), back = glm::normalize(at - direction_of(s.look_at));
  const Direction right = glm::normalize(glm::cross(Direction(0, 1, 0), back));
  const double up = std::tan(0.5 * s.fov * pi / 180);
  const int width = s.height * 16 / 9;
  return {.size = s.height,
          .at = at,
          .axes = {right, glm::cross(back, right), back},
          .samples = s.samples,
          .lens = Lens{width, {up * width / s.height, up}}};
}

// Every so many frames a drop, at places that the golden ratio spreads.
void let_fall(HeightField& field, const Settings& s, int frame) {
  if (s.drops == 0 || frame % s.drops != 0) return;
  const int k = frame / s.drops;
  const auto place = [](double part, int size) { return (0.1 + 0.8 * std::fmod(part, 1)) * size; };
  field.drop(place(0.3 + 0.618034 * k, field.columns()), place(0.45 + 0.754878 * k, field.rows()),
             0.04 * field.columns(), s.depth);
}

void run(const Settings& s) {
  const Environment sky(make_sky(s.sky));
  const std::vector<DistantLight> lights = distant_lights(sky.map, 64);
  const Direction sun = sun_of(sky.map);
  HeightField field(s.columns, int(s.columns * s.basin.deep / s.basin.wide));
  Pool pool = make_pool(s.basin, field);
  if (!s.model.empty()) add_model(pool, s.basin, read_scene(s.model), s.model_height);
  const Viewpoint from = camera_of(s);
  std::optional<Context> context;
  std::optional<Painter> painter;
  if (s.method == "maps") context.emplace(ContextKind::automatic), painter.emplace(pool, &sky);
  const FrameState shot{.scene = pool.scene, .pose = pose(pool.scene, 0), .environment = &sky, .distant = lights};
  for (int frame = 0; frame < s.first + s.frames; ++frame) {
    let_fall(field, s, frame);
    for (int k = 0; k < s.steps; ++k) field.step(s.spring, 1 - s.damping);
    if (frame < s.first) continue;
    set_waves(pool, s.basin, field, sun);
    std::vector<Colour> picture =
        painter ? painter->paint(from, shot) : raycast_picture(shot, from, {.mirrors = {pool.water_node}});
    for (Colour& c : picture) c *= float(std::exp2(s.exposure));
    std::string path = s.output;
    path.replace(path.find("{frame}"), 7, fmt::format("{:04}", frame));
    write_picture(path, from.lens->width, picture, {.display = Display::neutral});
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Water in a basin, a picture a frame. Example: water frame-{frame}.png --frames 48");
  Settings s;
  const auto triple = [&](const char* name, std::vector<double>& value, const char* text) {
    app.add_option(name, value, text)->delimiter(',')->expected(3)->type_name("X,Y,Z")->capture_default_str();
  };
  const auto number = [&](const char* name, auto& value, auto low, auto high, const char* text) {
    app.add_option(name, value, text)->check(CLI::Range(low, high))->capture_default_str();
  };
  app.add_option("OUT", s.output, "Name of the pictures, with {frame} in it: .png, .jpg or .exr")
      ->required()
      ->check([](const std::string& name) { return name.find("{frame}") == name.npos ? "{frame} is missing" : ""; });
  number("--frames", s.frames, 1, 100000, "How many");
  number("--first", s.first, 0, 100000, "The first that is drawn");
  number("--size", s.height, 16, 4320, "Height of a picture");
  number("--samples", s.samples, 1, 1024, "Rays a pixel");
  app.add_option("--method", s.method, "Reflection and refraction by dynamic maps, or by rays")
      ->check(CLI::IsMember({"maps", "raycast"}))
      ->capture_default_str();
  app.add_option("--sky", s.sky, "An environment map; otherwise a blue sky");
  app.add_option("--model", s.model, "A glTF or OBJ file that stands in the basin");
  number("--model-height", s.model_height, 0.001, 100.0, "Of the model, in metres; the water is 0.7 deep");
  number("--exposure", s.exposure, -100.0, 100.0, "Stops");
  triple("--camera", s.camera, "Where the camera stands; the water is y = 0, in metres");
  triple("--look-at", s.look_at, "What is in the middle of the picture");
  number("--fov", s.fov, 1.0, 170.0, "Degrees from the bottom to the top of the picture");
  number("--grid", s.columns, 16, 1024, "Columns of water along the basin");
  number("--steps", s.steps, 1, 1000, "Of the springs, a frame");
  number("--spring", s.spring, 0.0, 0.41, "Spring constant x time step squared / mass; stable up to 0.41");
  number("--damping", s.damping, 0.0, 1.0, "Part of the speed that a step takes");
  number("--drops", s.drops, 0, 100000, "Frames from drop to drop; 0: none falls");
  number("--depth", s.depth, 0.0, 0.2, "Of the dent that a drop makes");
  number("--eta", s.basin.eta, 0.3, 1.0, "Refractive index of air over that of water");
  triple("--tint", s.tint, "What water absorbs of red, green and blue, a metre (Beer and Lambert)");
  try {
    app.parse(argc, argv);
    s.basin.tint = Colour(direction_of(s.tint));
    run(s);
    return 0;
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  } catch (const envmap::Error& e) {
    std::cerr << "water: " << e.what() << '\n';
    return e.code() == ErrorCode::usage ? 2 : e.code() == ErrorCode::input ? 3 : e.code() == ErrorCode::output ? 4 : 5;
  }
}

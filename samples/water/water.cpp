// Water in a basin: drops fall, waves run, the sky is reflected through a dual-paraboloid map and the basin refracted by
// Snell's law. Writes one picture a frame.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <iostream>

#include "basin.h"

namespace {

using namespace envmap;
using namespace water;

const Direction sun = glm::normalize(Direction(-0.45, 0.7, -0.55));

// A blue sky, or what a file holds, as a dual-paraboloid map whose axis is up.
EnvironmentLookup make_sky(const std::string& path, int size) {
  const EnvironmentMap map = path.empty() ? generate(Gradient{{0.55, 0.5, 0.4}, {0.12, 0.3, 0.75}}, Projection::cube, 256)
                                          : std::move(read(path).map);
  return EnvironmentLookup(convert(map, {.to = Projection::paraboloid,
                                         .size = size,
                                         .filter = Filter::bilinear,
                                         .samples = 4,
                                         .rotation = glm::transpose(sky_axes())}));  // From the world to the map.
}

struct Settings {
  std::string output, sky;
  int frames = 96, height = 360, samples = 2;
};

std::vector<Colour> picture(const View& view, const Settings& s, int width) {
  const Direction eye(0.5, 1.75, 2.6), towards = glm::normalize(Direction(0.02, -0.1, -0.05) - eye);
  const Direction right = glm::normalize(glm::cross(towards, Direction(0, 1, 0))), up = glm::cross(right, towards);
  const double half = std::tan(0.5 * 0.75);
  std::vector<Colour> pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(s.height));
  tbb::parallel_for(0, s.height, [&](int j) {
    for (int i = 0; i < width; ++i) {
      Flux sum(0);
      for (int k = 0; k < s.samples * s.samples; ++k) {
        const double x = i + (k % s.samples + 0.5) / s.samples - 0.5 * width;
        const double y = 0.5 * s.height - j - (k / s.samples + 0.5) / s.samples;
        sum += look(view, eye, glm::normalize(towards + half * 2 / s.height * (x * right + y * up)));
      }
      pixels[static_cast<std::size_t>(j) * static_cast<std::size_t>(width) + static_cast<std::size_t>(i)] =
          Colour(sum / static_cast<double>(s.samples * s.samples));
    }
  });
  return pixels;
}

void run(const Settings& s) {
  const int width = s.height * 16 / 9;
  const EnvironmentLookup sky = make_sky(s.sky, 512);
  const Flux disc = s.sky.empty() ? Flux(60, 52, 40) : Flux(0);  // A file brings its own sun.
  const Basin basin;
  HeightField field(192, 120);
  constexpr double stiffness = 0.12, kept = 0.9985;
  constexpr int steps = 6;  // A frame.
  for (int frame = 0; frame < s.frames; ++frame) {
    // Every 20 frames a drop, at places that the golden ratio spreads.
    if (frame % 20 == 0) {
      const double x = std::fmod(0.3 + 0.618034 * (frame / 20), 1), y = std::fmod(0.45 + 0.754878 * (frame / 20), 1);
      field.drop(20 + x * 152, 20 + y * 80, 5, 0.07);
    }
    for (int k = 0; k < steps; ++k) field.step(stiffness, kept);
    const View view{basin, field, sky, sun, disc, caustics(basin, field, sun)};
    std::string path = s.output;
    path.replace(path.find("{frame}"), 7, fmt::format("{:04}", frame));
    write_picture(path, width, picture(view, s, width));
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Water in a basin, a picture a frame. Example: water frame-{frame}.png --frames 48");
  Settings s;
  app.add_option("OUT", s.output, "Name of the pictures, with {frame} in it: .png or .exr")
      ->required()
      ->check([](const std::string& name) { return name.find("{frame}") == name.npos ? "{frame} is missing" : ""; });
  app.add_option("--frames", s.frames, "How many")->check(CLI::Range(1, 100000))->capture_default_str();
  app.add_option("--size", s.height, "Height of a picture")->check(CLI::Range(16, 4320))->capture_default_str();
  app.add_option("--samples", s.samples, "N x N samples a pixel")->check(CLI::Range(1, 16))->capture_default_str();
  app.add_option("--sky", s.sky, "An environment map to reflect; otherwise a blue sky");
  try {
    app.parse(argc, argv);
    run(s);
    return 0;
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  } catch (const envmap::Error& e) {
    std::cerr << "water: " << e.what() << '\n';
    return e.code() == ErrorCode::usage ? 2 : e.code() == ErrorCode::input ? 3 : 4;
  }
}

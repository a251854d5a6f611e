#include "envmap/engine/jpeg_background.h"

#include "envmap/engine/engine_text.h"

namespace envmap {

// three.js: examples/jsm/loaders/UltraHDRLoader.js; equirectUv in src/renderers/shaders/ShaderChunk/common.glsl.js has
// +X in the middle.
std::optional<Engine> with_jpeg_background(const Engine& engine) {
  if (engine.name != "three") return std::nullopt;
  Engine made = engine;
  made.maps.front() = {.file = "background.jpg",
                       .frame = {Projection::latlong, Forward::plus_x},
                       .depth = Depth::uint8,
                       .only_depth = true};
  made.turns = "background.jpg is not.";
  made.steps = engine_text("three-jpeg.txt");
  made.steps.remove_suffix(1);
  return made;
}

bool is_jpeg(std::string_view file) { return file.ends_with(".jpg"); }

}  // namespace envmap

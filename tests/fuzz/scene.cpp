#include <fstream>
#include <string>

#include "envmap/base/error.h"
#include "envmap/scenes/read/read_scene.h"
#include "sound_scene.h"
#include "targets.h"

using namespace envmap;

std::string write_scene(Bytes data) {
  const char first = data.empty() ? 'v' : static_cast<char>(data[0]);
  const std::string file = first == 'g'   ? "fuzz_scene.glb"
                           : first == '{' ? "fuzz_scene.gltf"
                           : first == 'n' ? "fuzz_scene.mtl"
                                          : "fuzz_scene_plain.obj";
  const std::string path = first == 'n' ? "fuzz_scene.obj" : file;
  if (first == 'n')
    std::ofstream(path) << "mtllib fuzz_scene.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(data.data()), std::streamsize(data.size()));
  return path;
}

void fuzz_scene(Bytes data) {
  const std::string path = write_scene(data);
  try {
    expect_sound(read_scene(path));
  } catch (const InputError& e) {
    expect_harmless(e.what());
  }
}

// Any bytes, read as a scene: it is one, or an InputError comes out. The first byte tells GLB and glTF from OBJ; with 'n',
// as in newmtl, they are the materials of an OBJ file.
#include <sys/resource.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "envmap/base/error.h"
#include "envmap/scene/read/read_scene.h"

using namespace envmap;

// What a header promises must be bounded by what the file holds.
extern "C" int LLVMFuzzerInitialize(int*, char***) {
  constexpr rlimit memory{std::size_t{2} << 30, std::size_t{2} << 30};
  return ::setrlimit(RLIMIT_AS, &memory);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const char first = size > 0 ? static_cast<char>(data[0]) : 'v';
  const std::string file = first == 'g'   ? "fuzz_scene.glb"
                           : first == '{' ? "fuzz_scene.gltf"
                           : first == 'n' ? "fuzz_scene.mtl"
                                          : "fuzz_scene_plain.obj";
  const std::string path = first == 'n' ? "fuzz_scene.obj" : file;
  if (first == 'n')
    std::ofstream(path) << "mtllib fuzz_scene.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
  std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    const Scene scene = read_scene(path);
    for (const Node& node : scene.nodes)
      for (const int mesh : node.meshes)
        if (mesh < 0 || mesh >= static_cast<int>(scene.meshes.size())) std::abort();
    for (const Mesh& mesh : scene.meshes)
      for (const std::uint32_t corner : mesh.indices)
        if (corner >= mesh.positions.size()) std::abort();
  } catch (const InputError& e) {
    for (const unsigned char c : std::string(e.what()))
      if (c < ' ') std::abort();  // One line, harmless to a terminal.
  }
  return 0;
}

#include "envmap/scene/read/read_scene.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "envmap/base/error.h"
#include "envmap/scene/read/read_gltf.h"
#include "envmap/scene/read/read_obj.h"

namespace envmap {
namespace {

namespace fs = std::filesystem;

// Names and texts come from the file: nothing for the terminal to obey remains.
std::string harmless(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < ' ' || c == 0x7f; }, '?');
  return text;
}

bool is_obj(const std::string& path) {
  std::string extension = fs::path(path).extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
  return extension == ".obj";
}

// GLB by its mark, glTF by the brace that JSON begins with.
bool is_gltf(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  char head[4] = {};
  stream >> std::ws;
  stream.read(head, sizeof head);
  return head[0] == '{' || std::string_view(head, 4) == "glTF" || std::string_view(head, 3) == "\xef\xbb\xbf";
}

Scene read_any(const std::string& path) {
  std::error_code error;
  if (!fs::exists(path, error)) throw InputError("no such file");
  if (fs::is_directory(path, error)) throw InputError("is a folder; name a file");
  if (!fs::is_regular_file(path, error)) throw InputError("is not a file");
  if (fs::file_size(path, error) == 0) throw InputError("is empty");
  if (is_obj(path)) return read_obj(path);
  if (is_gltf(path)) return read_gltf(path);
  throw InputError("not a scene that can be read: neither glTF 2.0 (.gltf, .glb) nor OBJ");
}

void check(const Scene& scene) {
  std::size_t corners = 0;
  for (const Node& node : scene.nodes)
    for (const int mesh : node.meshes) corners += scene.meshes[mesh].indices.size();
  if (corners == 0) throw InputError("holds no triangles");
  for (const Matrix& world : pose(scene, 0))
    for (int k = 0; k < 16; ++k)
      if (!(std::abs(world[k / 4][k % 4]) < 1e30)) throw InputError("its nodes multiply to sizes beyond 1e30");
}

}  // namespace

Scene read_scene(const std::string& path) {
  try {
    Scene scene = read_any(path);
    scene.files.insert(scene.files.begin(), path);
    check(scene);
    std::ranges::transform(scene.unmodelled, scene.unmodelled.begin(), harmless);
    std::ranges::transform(scene.remarks, scene.remarks.begin(), harmless);
    return scene;
  } catch (const InputError& e) {
    throw InputError(harmless(path + ": " + e.what()));
  }
}

}  // namespace envmap

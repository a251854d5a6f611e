#include "envmap/scenes/read/read_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "envmap/base/error.h"
#include "envmap/io/formats/file_format.h"
#include "envmap/io/formats/gltf_light.h"
#include "envmap/scenes/read/read_gltf.h"
#include "envmap/scenes/read/read_obj.h"
#include "envmap/scenes/read/text_lines.h"
#include "envmap/scenes/scene/mesh.h"

namespace envmap {
namespace {

namespace fs = std::filesystem;

// Names and texts come from the file: nothing for the terminal to obey remains.
std::string harmless(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < ' ' || c == 0x7f; }, '?');
  return text;
}

Scene read_any(const std::string& path, std::uint64_t max_pixels, bool allow_missing) {
  std::error_code error;
  if (path != "-" && fs::is_directory(path, error)) throw InputError("is a folder: give a file name");
  if (path != "-" && !fs::exists(path, error)) throw InputError("no such file");
  const std::vector<std::byte> bytes = path == "-" ? standard_input() : file_bytes(path);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const SceneFolder folder(path);
  if (extension_of(path) == "obj") return read_obj(bytes, folder, max_pixels, allow_missing);
  if (is_gltf(text)) return read_gltf(bytes, folder, max_pixels, allow_missing);
  // A stream has no name to tell it by. No text has a byte 0.
  if (path == "-" && text.find('\0') == text.npos) return read_obj(bytes, folder, max_pixels, allow_missing);
  throw InputError("not a scene that can be read: neither glTF 2.0 (.gltf, .glb) nor OBJ");
}

void check(const Scene& scene) {
  std::size_t corners = 0;
  for (const Node& node : scene.nodes)
    for (const int mesh : node.meshes) corners += scene.meshes[mesh].indices.size();
  if (corners == 0) throw InputError("holds no triangles");
  if (corners > max_corners)
    throw InputError(fmt::format("its nodes draw over {} million corners: remove nodes or simplify their meshes",
                                 max_corners / 1000000));
  if (!is_bounded(pose(scene, 0))) throw InputError("its nodes multiply to sizes beyond 1e30");
}

}  // namespace

Scene read_scene(const std::string& path, std::uint64_t max_pixels, bool allow_missing) {
  try {
    Scene scene = read_any(path, max_pixels, allow_missing);
    scene.files.insert(scene.files.begin(), path);
    check(scene);
    std::ranges::transform(scene.unsupported, scene.unsupported.begin(), harmless);
    std::ranges::transform(scene.remarks, scene.remarks.begin(), harmless);
    return scene;
  } catch (const MissingFile& e) {
    throw MissingFile(harmless((path == "-" ? "standard input" : path) + ": " + e.what()));
  } catch (const InputError& e) {
    throw InputError(path == "-" ? "standard input" : path, harmless(e.what()), e.remedy());
  }
}

}  // namespace envmap

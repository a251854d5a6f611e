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

constexpr const char* unknown = "not a scene that can be read: neither glTF 2.0 (.gltf, .glb) nor OBJ";

// Names and texts come from the file: nothing for the terminal to obey remains.
std::string harmless(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < ' ' || c == 0x7f; }, '?');
  return text;
}

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// What has no name is told by its bytes: no text has a byte 0.
SceneGraph read_nameless(std::span<const std::byte> bytes, const SceneFolder& folder, std::uint64_t max_pixels,
                         bool allow_missing) {
  if (is_gltf(text_of(bytes))) return read_gltf(bytes, folder, max_pixels, allow_missing);
  if (text_of(bytes).find('\0') == std::string_view::npos) return read_obj(bytes, folder, max_pixels, allow_missing);
  throw InputError(unknown);
}

SceneGraph read_any(const std::string& path, std::uint64_t max_pixels, bool allow_missing) {
  std::error_code error;
  const SceneFolder folder(path);
  if (path == "-") return read_nameless(standard_input(), folder, max_pixels, allow_missing);
  if (fs::is_directory(path, error)) throw InputError("is a folder: give a file name");
  if (!fs::exists(path, error)) throw InputError("no such file");
  const std::vector<std::byte> bytes = file_bytes(path);
  if (extension_of(path) == "obj") return read_obj(bytes, folder, max_pixels, allow_missing);
  if (is_gltf(text_of(bytes))) return read_gltf(bytes, folder, max_pixels, allow_missing);
  throw InputError(unknown);
}

void check(const SceneGraph& scene) {
  std::size_t corners = 0;
  for (const Node& node : scene.nodes)
    for (const int mesh : node.meshes) corners += scene.meshes[mesh].indices.size();
  if (corners == 0)
    throw InputError(scene.lights.empty() ? "holds no triangles"
                                          : "holds lights alone, and no triangles that they could light: copy its "
                                            "lights and their nodes into a scene with meshes");
  if (corners > max_corners)
    throw InputError(fmt::format("its nodes draw over {} million corners: remove nodes or simplify their meshes",
                                 max_corners / 1000000));
  if (!is_bounded(pose(scene, 0))) throw InputError("its nodes multiply to sizes beyond 1e30");
}

// @param name of the file, for errors. @param read makes the scene.
template <class Read>
SceneGraph read_checked(const std::string& path, const std::string& name, const Read& read) {
  try {
    SceneGraph scene = read();
    scene.files.insert(scene.files.begin(), path);
    check(scene);
    std::ranges::transform(scene.unsupported, scene.unsupported.begin(), harmless);
    std::ranges::transform(scene.remarks, scene.remarks.begin(), harmless);
    return scene;
  } catch (const MissingFile& e) {
    throw MissingFile(harmless(name + ": " + e.what()));
  } catch (const InputError& e) {
    throw InputError(name, harmless(e.what()), e.remedy());
  }
}

}  // namespace

SceneGraph read_scene(const std::string& path, std::uint64_t max_pixels, bool allow_missing) {
  return read_checked(path, path == "-" ? "standard input" : path,
                      [&] { return read_any(path, max_pixels, allow_missing); });
}

SceneGraph read_scene(std::span<const std::byte> file, const std::string& folder, std::uint64_t max_pixels,
                      bool allow_missing) {
  return read_checked(scene_in_memory, scene_in_memory, [&] {
    if (file.empty()) throw InputError("is empty");
    const SceneFolder there = folder.empty() ? SceneFolder() : SceneFolder((fs::path(folder) / "scene").string());
    return read_nameless(file, there, max_pixels, allow_missing);
  });
}

}  // namespace envmap

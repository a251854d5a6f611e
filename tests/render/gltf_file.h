// glTF files made by hand, as small as their tests want them.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/scenes/read/read_scene.h"

namespace scenes {

using nlohmann::json;

/// A document and the bytes of its buffer, to be changed at will and written.
struct GltfFile {
  json document = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", {0}}}}}};
  std::string bytes;

  /// Adds an accessor of floats or indices. @return its index.
  template <class T>
  int add(const std::vector<T>& values, const char* type, int components) {
    constexpr int kind = std::is_same_v<T, float> ? 5126 : std::is_same_v<T, std::uint8_t> ? 5121 : 5123;
    while (bytes.size() % 4 != 0) bytes += '\0';
    const auto size = values.size() * sizeof(T);
    document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", size}});
    bytes.append(reinterpret_cast<const char*>(values.data()), size);
    document["accessors"].push_back({{"bufferView", document["bufferViews"].size() - 1},
                                     {"componentType", kind},
                                     {"count", values.size() / std::size_t(components)},
                                     {"type", type}});
    return int(document["accessors"].size()) - 1;
  }

  /// The text of a .gltf whose buffer is "data.bin", written beside it, and of a GLB.
  void write(const std::filesystem::path& path) const {
    std::ofstream stream(path, std::ios::binary);
    stream << (path.extension() == ".glb" ? glb() : text(path));
  }

 private:
  [[nodiscard]] std::string text(const std::filesystem::path& path) const {
    json whole = document;
    if (!whole.contains("buffers")) whole["buffers"] = {{{"uri", "data.bin"}, {"byteLength", bytes.size()}}};
    std::ofstream(path.parent_path() / "data.bin", std::ios::binary) << bytes;
    return whole.dump();
  }
  [[nodiscard]] std::string glb() const {
    json whole = document;
    whole["buffers"] = {{{"byteLength", bytes.size()}}};
    std::string json_text = whole.dump(), bin = bytes;
    while (json_text.size() % 4 != 0) json_text += ' ';
    while (bin.size() % 4 != 0) bin += '\0';
    const auto word = [](std::size_t n) {
      const auto value = std::uint32_t(n);
      return std::string(reinterpret_cast<const char*>(&value), 4);
    };
    return "glTF" + word(2) + word(28 + json_text.size() + bin.size()) + word(json_text.size()) + "JSON" + json_text +
           word(bin.size()) + std::string("BIN\0", 4) + bin;
  }
};

/// One triangle (0,0,0) (1,0,0) (0,1,0) on node 0.
inline GltfFile triangle() {
  GltfFile file;
  const int positions = file.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  const int indices = file.add<std::uint16_t>({0, 1, 2}, "SCALAR", 1);
  file.document["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", positions}}}, {"indices", indices}}}}}};
  file.document["nodes"] = {{{"mesh", 0}, {"name", "first"}}};
  return file;
}

/// A folder of the test's own.
class SceneTest : public ::testing::Test {
 protected:
  SceneTest() {
    std::string name = (std::filesystem::temp_directory_path() / "envmap-scene-XXXXXX").string();
    folder = ::mkdtemp(name.data());
  }
  ~SceneTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }
  [[nodiscard]] std::string path(const std::string& name) const { return (folder / name).string(); }
  void put(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name, std::ios::binary) << text;
  }
  std::filesystem::path folder;
};

/// What is said of a file that cannot be read; nothing of one that can.
inline std::string why(const std::string& path) {
  try {
    envmap::read_scene(path);
  } catch (const envmap::InputError& e) {
    return e.what();
  }
  return "";
}

}  // namespace scenes

// Scenes from files: what is said of broken ones.
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>

#include "render/gltf_file.h"

namespace scenes {
namespace {

using namespace envmap;

struct Broken {
  const char* name;
  std::function<void(GltfFile&)> damage;
  const char* word;  // That the message must hold.
};

class BrokenGltf : public SceneTest, public ::testing::WithParamInterface<Broken> {};

TEST_P(BrokenGltf, IsRefusedInOneLine) {
  for (const char* name : {"a.gltf", "a.glb"}) {
    GltfFile file = triangle();
    GetParam().damage(file);
    if (file.document.contains("buffers") && std::string(name) == "a.glb") continue;
    file.write(folder / name);
    const std::string message = why(path(name));
    EXPECT_TRUE(message.starts_with(path(name) + ": ")) << message;
    EXPECT_NE(message.find(GetParam().word), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
}

template <class T>
void poke(GltfFile& f, std::size_t at, T value) {
  std::memcpy(f.bytes.data() + at, &value, sizeof value);
}

const Broken broken[] = {
    {"MissingBuffer",
     [](GltfFile& f) {
       f.document["buffers"] = {{{"uri", "gone.bin"}, {"byteLength", 44}}};
     },
     "gone.bin"},
    {"ShortBuffer",
     [](GltfFile& f) {
       f.document["buffers"] = {{{"uri", "data.bin"}, {"byteLength", 4000}}};
     },
     "ends early"},
    {"HugeBuffer",
     [](GltfFile& f) {
       f.document["buffers"] = {{{"uri", "data.bin"}, {"byteLength", 1e18}}};
     },
     "byteLength"},
    {"NoUri",
     [](GltfFile& f) {
       f.document["buffers"] = {{{"byteLength", 44}}};
     },
     "URI"},
    {"Network",
     [](GltfFile& f) {
       f.document["buffers"] = {{{"uri", "http://a/b"}, {"byteLength", 44}}};
     },
     "names no file"},
    {"Device",
     [](GltfFile& f) {
       f.document["buffers"] = {{{"uri", "/dev/zero"}, {"byteLength", 44}}};
     },
     "not a file"},
    {"Base64",
     [](GltfFile& f) {
       f.document["buffers"] = {{{"uri", "data:;base64,####"}, {"byteLength", 3}}};
     },
     "Base64"},
    {"BadIndex", [](GltfFile& f) { poke(f, 36, std::uint16_t{3}); }, "vertex 3"},
    {"NaNVertex", [](GltfFile& f) { poke(f, 4, std::nanf("")); }, "NaN"},
    {"InfiniteVertex", [](GltfFile& f) { poke(f, 8, std::numeric_limits<float>::infinity()); }, "infinite"},
    {"Cycle",
     [](GltfFile& f) {
       f.document["nodes"] = {{{"children", {1}}, {"mesh", 0}}, {{"children", {0}}}};
     },
     "below itself"},
    {"OwnChild", [](GltfFile& f) { f.document["nodes"][0]["children"] = {0}; }, "below itself"},
    {"TwoParents",
     [](GltfFile& f) {
       f.document["nodes"] = {{{"children", {2}}}, {{"children", {2}}}, {{"mesh", 0}}};
     },
     "another parent"},
    {"NoTriangles", [](GltfFile& f) { f.document["nodes"][0].erase("mesh"); }, "no triangles"},
    {"NoMeshes", [](GltfFile& f) { f.document.erase("meshes"); }, "nodes[0].mesh"},
    {"EmptyIndices", [](GltfFile& f) { f.document["accessors"][1]["count"] = 0; }, "no triangles"},
    {"TwoCorners", [](GltfFile& f) { f.document["accessors"][1]["count"] = 2; }, "three a triangle"},
    {"HugeCount", [](GltfFile& f) { f.document["accessors"][0]["count"] = 100000000; }, "beyond its buffer view"},
    {"HugerCount", [](GltfFile& f) { f.document["accessors"][0]["count"] = 1e19; }, "count"},
    {"HugeZeros",
     [](GltfFile& f) { f.document["accessors"][0].erase("bufferView"), f.document["accessors"][0]["count"] = 1e8; },
     "count"},
    {"NegativeCount", [](GltfFile& f) { f.document["accessors"][0]["count"] = -1; }, "whole number"},
    {"Offset", [](GltfFile& f) { f.document["accessors"][0]["byteOffset"] = 4; }, "beyond its buffer view"},
    {"ViewOffset", [](GltfFile& f) { f.document["bufferViews"][0]["byteOffset"] = 1000; }, "byteOffset"},
    {"ViewLength", [](GltfFile& f) { f.document["bufferViews"][0]["byteLength"] = 1000; }, "byteLength"},
    {"Stride", [](GltfFile& f) { f.document["bufferViews"][0]["byteStride"] = 4; }, "less than an element"},
    {"ComponentType", [](GltfFile& f) { f.document["accessors"][0]["componentType"] = 7; }, "component type"},
    {"Type", [](GltfFile& f) { f.document["accessors"][0]["type"] = "VEC2"; }, "components"},
    {"NoAccessor", [](GltfFile& f) { f.document["meshes"][0]["primitives"][0]["indices"] = 9; }, "indices"},
    {"Material", [](GltfFile& f) { f.document["meshes"][0]["primitives"][0]["material"] = 0; }, "material"},
    {"Scene", [](GltfFile& f) { f.document["scene"] = 4; }, "scene"},
    {"Version", [](GltfFile& f) { f.document["asset"]["version"] = "1.0"; }, "glTF 2.0"},
    {"Required", [](GltfFile& f) { f.document["extensionsRequired"] = {"EXT_meshopt_compression"}; },
     "EXT_meshopt_compression"},
    {"Matrix",
     [](GltfFile& f) {
       f.document["nodes"][0]["matrix"] = {1, 2, 3};
     },
     "matrix"},
    {"Rotation",
     [](GltfFile& f) {
       f.document["nodes"][0]["rotation"] = {0, 0, 0, 0};
     },
     "no rotation"},
    {"Text", [](GltfFile& f) { f.document["nodes"][0]["mesh"] = "one\n"; }, "no number"},
    {"Terminal", [](GltfFile& f) { f.document["extensionsRequired"] = {"\033[2J"}; }, "?[2J"},
    {"Shape", [](GltfFile& f) { f.document["nodes"] = 3; }, "no array"},
};
INSTANTIATE_TEST_SUITE_P(Scenes, BrokenGltf, ::testing::ValuesIn(broken),
                         [](const auto& each) { return each.param.name; });

TEST_F(SceneTest, FilesCutShortAnywhereAreRefused) {
  GltfFile file = triangle();
  for (const char* name : {"a.glb", "a.gltf"}) {
    file.write(folder / name);
    std::ifstream stream(folder / name, std::ios::binary);
    const std::string whole{std::istreambuf_iterator<char>(stream), {}};
    ASSERT_EQ(why(path(name)), "");
    for (std::size_t length = 0; length < whole.size(); length += 1 + length / 50) {
      put("cut.glb", whole.substr(0, length));
      EXPECT_NE(why(path("cut.glb")), "") << length;
    }
  }
  EXPECT_NE(why(path("none.glb")).find("no such file"), std::string::npos);
  EXPECT_NE(why(folder.string()).find("folder"), std::string::npos);
  EXPECT_NE(why("/dev/zero").find("not a file"), std::string::npos);
  put("a.txt", "hello");
  EXPECT_NE(why(path("a.txt")).find("neither glTF"), std::string::npos);
}

// The same bytes named again and again ask for far more memory than the file has.
TEST_F(SceneTest, RepeatedMeshesAreBounded) {
  GltfFile file = triangle();
  file.document["accessors"][1] = {{"componentType", 5121}, {"count", 999999}, {"type", "SCALAR"}};
  const json primitive = file.document["meshes"][0]["primitives"][0];
  for (int k = 0; k < 5000; ++k) file.document["meshes"][0]["primitives"].push_back(primitive);
  file.write(folder / "a.gltf");
  EXPECT_NE(why(path("a.gltf")).find("million corners"), std::string::npos);
}

TEST_F(SceneTest, BrokenObjIsRefused) {
  const std::pair<const char*, const char*> files[] = {
      {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "OBJ"},
      {"v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3\n", "NaN"},
      {"v 0 0 0\nv 1 0 0\n", "OBJ"},
      {"# nothing\n", "OBJ"},
  };
  for (const auto& [text, word] : files) {
    put("a.obj", text);
    EXPECT_NE(why(path("a.obj")).find(word), std::string::npos) << text << why(path("a.obj"));
  }
}

}  // namespace
}  // namespace scenes

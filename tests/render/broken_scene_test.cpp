// Scenes from files: what is said of broken ones.
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>

#include "render/gltf_file.h"

namespace scenes::broken_scene_test {
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
     "outside the scene's folder"},
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
    {"LightsAlone",
     [](GltfFile& f) {
       f.document["nodes"] = {{{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}}};
       f.document["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "directional"}}};
     },
     "holds lights alone"},
    {"NoMeshes", [](GltfFile& f) { f.document.erase("meshes"); }, "nodes[0].mesh"},
    {"EmptyIndices", [](GltfFile& f) { f.document["accessors"][1]["count"] = 0; }, "no triangles"},
    {"TwoCorners", [](GltfFile& f) { f.document["accessors"][1]["count"] = 2; }, "no triangles"},
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
    {"NegativeColour",
     [](GltfFile& f) {
       f.document["materials"] = {{{"pbrMetallicRoughness", {{"baseColorFactor", {1, -1, 1, 1}}}}}};
     },
     "baseColorFactor[1] is -1, not from 0 to 1"},
    {"BrightEmission",
     [](GltfFile& f) {
       f.document["materials"] = {{{"emissiveFactor", {1, 1, 1e30}}}};
     },
     "emissiveFactor[2] is 1e+30, not from 0 to 1000000"},
    {"NegativeLight",
     [](GltfFile& f) {
       f.document["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"color", {-1, 1, 1}}}};
       f.document["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
     },
     "color[0] is -1, not from 0 to 1000000"},
    {"TransformedCoordinates",
     [](GltfFile& f) {
       json texture = {{"index", 0}};
       texture["extensions"]["KHR_texture_transform"]["scale"] = {1e38, 1};
       f.document["textures"] = {json::object()};
       f.document["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", texture}}}}};
       json& primitive = f.document["meshes"][0]["primitives"][0];
       primitive["material"] = 0;
       primitive["attributes"]["TEXCOORD_0"] = f.add<float>({0, 0, 100, 0, 0, 1}, "VEC2", 2);
     },
     "texture coordinates beyond float32"},
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

TEST_F(SceneTest, NodesOfOneMeshAreBounded) {
  GltfFile file = triangle();
  file.document["accessors"][1] = {{"componentType", 5121}, {"count", 999999}, {"type", "SCALAR"}};
  const json node = file.document["nodes"][0];
  for (int k = 1; k < 150; ++k)
    file.document["nodes"].push_back(node), file.document["scenes"][0]["nodes"].push_back(k);
  file.write(folder / "a.gltf");
  EXPECT_NE(why(path("a.gltf")).find("nodes draw over 134 million corners"), std::string::npos);
}

TEST_F(SceneTest, BrokenObjIsRefused) {
  const std::pair<const char*, const char*> files[] = {
      {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "line 4: names vertex 9, but there are 3"},
      {"v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3\n", "NaN"},
      {"v 0 0 0\nv 1 0 0\n", "no triangles"},
      {"# nothing\n", "no triangles"},
      {"v 0 0 0\nv 1 0\n", "line 2: a number is missing"},
      {"v 0 0 0\nv 1 0 1e99\n", "beyond float32"},
      {"v 0 0 0\nf 1 0 1\n", "'0' is no index"},
      {"v 0 0 0\nf -2 1 1\n", "'-2' is no index"},
      {"v 0 0 0\nf 1/1 1/1 1/1\n", "texture coordinate 1, but there are 0"},
      {"v 0 0 0\nf 1//7 1//7 1//7\n", "normal 7"},
      {"v 0 0 0\nf 1/1/1/1 1 1\n", "more than three"},
      {"v 0 0 0\nf 1.5 1 1\n", "no index"},
      {"v 0 0 0\nf 99999999999999999999 1 1\n", "no index"},
      {"v 0 0 0\nf\n", "no corners"},
      {"<html>\n", "'<html>' is no statement of OBJ"},
      {"v 0 0 0\ns on\n", "smoothing group"},
      {"\xff\xfev\n", "UTF-16"},
  };
  for (const auto& [text, word] : files) {
    put("a.obj", text);
    EXPECT_NE(why(path("a.obj")).find(word), std::string::npos) << text << why(path("a.obj"));
  }
}

TEST_F(SceneTest, DamagedMaterialsAreRefusedOrDrawn) {
  put("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
  const std::pair<const char*, const char*> files[] = {
      {"map_Kd x.png\nnewmtl a\n", "'a.mtl': line 1: 'map_kd' stands before the first newmtl"},
      {"newmtl a\nKd", "line 2: a number is missing"},
      {"newmtl a\nKd x y z\n", "'x' is no number"},
      {"newmtl a\nKd 1 1 nan\n", "NaN"},
      {"newmtl a\nKd 1 -1 1\n", "negative"},
      {"newmtl a\nmap_Kd\n", "no name"},
      {"newmtl a\nmap_Kd -s 1 1 1\n", "no name"},
      {"newmtl a\nmap_Kd -what 3 x.png\n", "unknown option '-what'"},
      {"newmtl a\nmap_Kd x.png\n", "names the texture 'x.png', which is missing"},
      {"newmtl a\nmap_Kd a.obj\n", "a.obj: not an image"},
      {"newmtl a\nmap_Kd ../x.png\n", "outside the scene's folder"},
      {"newmtl a\nmap_Kd ..\\x.png\n", "outside the scene's folder"},
      {"newmtl a\nmap_Ke /etc/passwd\n", "'/etc/passwd', which is missing"},
      {"newmtl a\nNs", "line 2: a number is missing"},
      {"newmtl", ""},
      {"newmtl a\naniso 0.5\nanisor 0\nPs 0\nPc 0\nPcr 0\nsharpness 60\nillum 2\nfoo\n", ""},
  };
  for (const auto& [text, word] : files) {
    put("a.mtl", text);
    const std::string message = why(path("a.obj"));
    EXPECT_NE(message.find(word), std::string::npos) << text << message;
    EXPECT_EQ(message.empty(), *word == '\0') << text << message;
  }
  put("a.mtl", std::string("newmtl a\nKd 1 1 1\0\n", 19));
  EXPECT_NE(why(path("a.obj")).find("is not text"), std::string::npos);
}

// Whatever stands in them, and wherever they end, files of materials crash nothing.
TEST_F(SceneTest, CutAndChangedMaterialsDoNoHarm) {
  const std::string whole =
      "newmtl a\nKd 0.5 1 1\nNs 3\nmap_Kd -clamp on -s 1 2 3 x y.png\nKe 1\nd -halo 0.5\nmap_bump -bm 1 b.png\n";
  put("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
  for (std::size_t k = 0; k < whole.size(); ++k) {
    put("a.mtl", whole.substr(0, k));
    why(path("a.obj"));
    for (const char c : {'\n', '\\', ' ', '#', '-', '\xff', '9'}) {
      std::string changed = whole;
      changed[k] = c;
      put("a.mtl", changed);
      why(path("a.obj"));
    }
  }
}

// A scene from a stranger opens nothing beyond its folder.
TEST_F(SceneTest, NamesStayInTheFolder) {
  namespace fs = std::filesystem;
  fs::create_directories(folder / "scene" / "sub");
  GltfFile file = triangle();
  file.write(folder / "a.gltf");  // Leaves data.bin above the scene's folder.
  const auto reason = [&](const std::string& uri) {
    file.document["buffers"] = {{{"uri", uri}, {"byteLength", 42}}};
    put("scene/a.gltf", file.document.dump());
    return why(path("scene/a.gltf"));
  };
  for (const std::string& uri :
       {std::string("../data.bin"), std::string("%2e%2e/data.bin"), std::string("sub/../../data.bin"), path("data.bin"),
        std::string("link.bin"), std::string("sub/up/data.bin"), std::string("..")}) {
    std::error_code ignored;
    fs::create_symlink("../data.bin", folder / "scene" / "link.bin", ignored);
    fs::create_symlink("../..", folder / "scene" / "sub" / "up", ignored);
    EXPECT_NE(reason(uri).find("outside the scene's folder"), std::string::npos) << uri << ": " << reason(uri);
  }
  EXPECT_NE(reason("gone.bin").find("'gone.bin', which is missing"), std::string::npos);
  fs::copy(folder / "data.bin", folder / "scene" / "sub" / "data 1.bin");
  EXPECT_EQ(reason("sub/data%201.bin"), "");
  EXPECT_EQ(reason("sub/../sub/./data%201.bin"), "");
  // A link to a scene: what lies beside the scene itself is as good as what lies beside the link.
  fs::create_directory(folder / "sandbox");
  fs::create_symlink("../scene/a.gltf", folder / "sandbox" / "a.gltf");
  fs::create_directory(folder / "sandbox" / "sub");
  fs::create_symlink("../../scene/sub/data 1.bin", folder / "sandbox" / "sub" / "data 1.bin");
  EXPECT_EQ(why(path("sandbox/a.gltf")), "");
}

}  // namespace
}  // namespace scenes::broken_scene_test

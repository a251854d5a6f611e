// Scenes from files: what is in hand-written glTF and OBJ.
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>

#include <cmath>
#include <cstdlib>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include "envmap/base/error.h"
#include "envmap/io/files/scene_folder.h"
#include "envmap/scenes/read/read_scene.h"
#include "envmap/scenes/scene/camera.h"
#include "render/gltf_file.h"

namespace scenes::read_gltf_test {
namespace {

using namespace envmap;

Direction at(const Matrix& m, const Direction& p) { return Direction(m * glm::vec<4, double, glm::highp>(p, 1)); }

void near(const Direction& a, const Direction& b, double within = 1e-6) {
  EXPECT_LT(glm::length(a - b), within) << a.x << ' ' << a.y << ' ' << a.z << " is not " << b.x << ' ' << b.y << ' '
                                        << b.z;
}

TEST_F(SceneTest, TransformsGoDownTheTree) {
  GltfFile file = triangle();
  const double h = std::sqrt(0.5);
  file.document["scenes"] = {{{"nodes", {2}}}};
  file.document["nodes"] = {{{"mesh", 0}, {"name", "leaf"}, {"translation", {1, 0, 0}}},
                            // 90 degrees about +Y.
                            {{"name", "turned"}, {"rotation", {0, h, 0, h}}, {"scale", {2, 2, 2}}, {"children", {0}}},
                            {{"name", "root"},
                             {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 20, 30, 1}},
                             {"children", {1}}}};
  for (const char* name : {"a.gltf", "a.glb"}) {
    file.write(folder / name);
    const SceneGraph scene = read_scene(path(name));
    ASSERT_EQ(scene.nodes.size(), 3U);
    const int leaf = find_node(scene, "leaf").value(), root = find_node(scene, "root").value();
    EXPECT_LT(root, leaf) << "parents come first";
    EXPECT_TRUE(lies_under(scene, leaf, root));
    const Pose world = pose(scene, 0);
    // (1,0,0) of the mesh: moved to (2,0,0), doubled (4,0,0), turned to (0,0,-4), moved.
    near(at(world[leaf], {1, 0, 0}), {10, 20, 26});
    ASSERT_EQ(scene.meshes.size(), 1U);
    EXPECT_EQ(scene.meshes[0].normals[0], glm::vec3(0, 0, 1));
    EXPECT_TRUE(scene.unsupported.empty());
  }
}

TEST_F(SceneTest, MaterialsAreReadAsTheFileSays) {
  GltfFile file = triangle();
  file.document["materials"] = {
      {{"name", "lamp"},
       {"pbrMetallicRoughness",
        {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}}, {"metallicFactor", 0.25}, {"roughnessFactor", 0.5}}},
       {"emissiveFactor", {1, 0.5, 0}},
       {"alphaMode", "MASK"},
       {"doubleSided", true},
       {"extensions",
        {{"KHR_materials_emissive_strength", {{"emissiveStrength", 100}}},
         {"KHR_materials_transmission", {{"transmissionFactor", 0.75}}},
         {"KHR_materials_ior", {{"ior", 1.33}}},
         {"KHR_materials_sheen", {{"sheenColorFactor", {1, 0.5, 0}}, {"sheenRoughnessFactor", 0.25}}},
         {"KHR_materials_clearcoat", {{"clearcoatFactor", 0.5}, {"clearcoatRoughnessFactor", 0.125}}},
         {"KHR_materials_volume", {{"thicknessFactor", 0.1}}}}}},
      {{"alphaMode", "BLEND"}}};
  file.document["extensionsUsed"] = {"KHR_materials_ior", "KHR_materials_iridescence"};
  file.document["meshes"][0]["primitives"].push_back(file.document["meshes"][0]["primitives"][0]);
  file.document["meshes"][0]["primitives"][0]["material"] = 0;
  file.write(folder / "a.gltf");
  const SceneGraph scene = read_scene(path("a.gltf"));
  const Material& m = scene.materials[0];
  EXPECT_EQ(m.name, "lamp");
  EXPECT_EQ(m.base_colour, glm::vec4(0.1F, 0.2F, 0.3F, 0.4F));
  EXPECT_EQ(m.emissive, Colour(100, 50, 0));
  EXPECT_FLOAT_EQ(m.metallic, 0.25F);
  EXPECT_FLOAT_EQ(m.transmission, 0.75F);
  EXPECT_TRUE(m.solid);
  EXPECT_EQ(m.sheen, Colour(1, 0.5F, 0));
  EXPECT_EQ(m.sheen_roughness, 0.25F);
  EXPECT_EQ(m.coat, 0.5F);
  EXPECT_EQ(m.coat_roughness, 0.125F);
  EXPECT_FLOAT_EQ(m.ior, 1.33F);
  EXPECT_FLOAT_EQ(m.alpha_cutoff, 0.5F);
  EXPECT_TRUE(m.double_sided);
  // A primitive without one has glTF's own, which is a metal.
  const Material& plain = scene.materials[scene.meshes[1].material];
  EXPECT_EQ(plain.metallic, 1);
  EXPECT_EQ(plain.roughness, 1);
  EXPECT_EQ(scene.unsupported, (std::vector<std::string>{"the extension KHR_materials_iridescence"}));
  EXPECT_FALSE(m.blended);
  EXPECT_TRUE(scene.materials[1].blended);
}

// 2 x 2 texels: red green, blue white; alpha 255 0, 128 255.
const std::string png =
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAYAAABytg0kAAAAFUlEQVR4nGP4z8DwHwhB4H/DfyAAAD1XCHmTHjG4AA"
    "AAAElFTkSuQmCC";

// What is not lit shines by itself, and its textures lie as they are scaled, turned a quarter to the left, and moved:
// (0.25, 0.5) -> (0.5, 1.5) -> (1.5, -0.5) -> (1.6, -0.3).
TEST_F(SceneTest, UnlitMaterialsAndTransformsOfTextures) {
  GltfFile file = triangle();
  file.add<float>({0.25F, 0.5F, 0, 0, 1, 0}, "VEC2", 2);
  json& primitive = file.document["meshes"][0]["primitives"][0];
  primitive["attributes"]["TEXCOORD_0"] = file.document["accessors"].size() - 1;
  primitive["material"] = 0;
  const json transform = {
      {"KHR_texture_transform", {{"offset", {0.1, 0.2}}, {"rotation", 0.5 * pi}, {"scale", {2, 3}}}}};
  file.document["textures"] = {{{"source", 0}}};
  file.document["images"] = {{{"uri", "data:image/png;base64," + png}}};
  file.document["materials"] = {
      {{"pbrMetallicRoughness",
        {{"baseColorFactor", {0.1, 0.2, 0.3, 1}}, {"baseColorTexture", {{"index", 0}, {"extensions", transform}}}}},
       {"emissiveFactor", {1, 1, 1}},
       {"extensions", {{"KHR_materials_unlit", json::object()}}}}};
  file.document["extensionsUsed"] = {"KHR_materials_unlit", "KHR_texture_transform"};
  file.write(folder / "a.gltf");
  const SceneGraph scene = read_scene(path("a.gltf"));
  EXPECT_TRUE(scene.unsupported.empty());
  const Material& m = scene.materials[0];
  EXPECT_EQ(m.emissive, Colour(0.1F, 0.2F, 0.3F));
  EXPECT_EQ(m.emissive_texture, m.base_colour_texture);
  EXPECT_EQ(glm::vec3(m.base_colour), glm::vec3(0));
  const std::vector<glm::vec2>& at = scene.meshes[0].coordinates;
  EXPECT_NEAR(at[0].x, 1.6, 1e-6);
  EXPECT_NEAR(at[0].y, -0.3, 1e-6);
  EXPECT_NEAR(at[2].x, 0.1, 1e-6);
  EXPECT_NEAR(at[2].y, -1.8, 1e-6);
}

// Tangents of the file are taken; where it has none they run along u, (1,0,0) here, and the image is not mirrored.
TEST_F(SceneTest, NormalAndOcclusionMaps) {
  GltfFile file = triangle();
  const int coordinates = file.add<float>({0, 1, 1, 1, 0, 0}, "VEC2", 2);
  const int normals = file.add<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
  const int tangents = file.add<float>({0, 1, 0, -1, 0, 1, 0, -1, 0, 1, 0, -1}, "VEC4", 4);
  json& primitive = file.document["meshes"][0]["primitives"][0];
  primitive["attributes"].update({{"TEXCOORD_0", coordinates}, {"NORMAL", normals}});
  primitive["material"] = 0;
  file.document["textures"] = {{{"source", 0}}};
  file.document["images"] = {{{"uri", "data:image/png;base64," + png}}};
  file.document["materials"] = {
      {{"normalTexture", {{"index", 0}, {"scale", 0.5}}}, {"occlusionTexture", {{"index", 0}, {"strength", 0.25}}}}};
  file.write(folder / "a.gltf");
  const SceneGraph made = read_scene(path("a.gltf"));
  EXPECT_TRUE(made.unsupported.empty());
  EXPECT_EQ(made.materials[0].normal_scale, 0.5F);
  EXPECT_EQ(made.materials[0].occlusion_strength, 0.25F);
  EXPECT_FALSE(made.textures[made.materials[0].normal_texture].srgb);
  for (const glm::vec4& t : made.meshes[0].tangents) EXPECT_EQ(t, glm::vec4(1, 0, 0, 1));
  file.document["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] = tangents;
  file.write(folder / "a.gltf");
  const SceneGraph given = read_scene(path("a.gltf"));
  for (const glm::vec4& t : given.meshes[0].tangents) EXPECT_EQ(t, glm::vec4(0, 1, 0, -1));
}

TEST_F(SceneTest, TexturesLieInFilesViewsAndTheDocument) {
  GltfFile file = triangle();
  file.add<float>({0, 0, 1, 0, 0, 1}, "VEC2", 2);
  file.document["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 2;
  file.document["meshes"][0]["primitives"][0]["material"] = 0;
  put("Kachel 1.ppm", std::string("P6 2 1 255 \xff\0\0\0\xff\0", 17));
  std::ofstream(folder / "Kachel 1.ppm", std::ios::binary) << "P6 2 1 255\n" << std::string("\xff\0\0\0\xff\x80", 6);
  file.document["images"] = {{{"uri", "Kachel%201.ppm"}}};
  file.document["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}}};
  file.document["textures"] = {{{"source", 0}, {"sampler", 0}}, {{"source", 0}}};
  file.document["materials"] = {
      {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"metallicRoughnessTexture", {{"index", 0}}}}},
       {"emissiveTexture", {{"index", 1}}}}};
  file.write(folder / "a.gltf");
  const SceneGraph scene = read_scene(path("a.gltf"));
  EXPECT_EQ(scene.meshes[0].coordinates[2], glm::vec2(0, 1));
  ASSERT_EQ(scene.textures.size(), 3U);
  const Texture& t = scene.textures[scene.materials[0].base_colour_texture];
  EXPECT_EQ(t.width, 2);
  EXPECT_EQ(t.texels[1], glm::u8vec4(0, 255, 128, 255));
  EXPECT_TRUE(t.srgb);
  EXPECT_EQ(t.wrap_u, Texture::Wrap::clamp);
  EXPECT_EQ(t.wrap_v, Texture::Wrap::mirror);
  EXPECT_FALSE(scene.textures[scene.materials[0].metallic_roughness_texture].srgb);

  file.document["images"] = {{{"uri", "data:image/png;base64," + png}}};
  file.write(folder / "b.gltf");
  // Alpha does not change colours.
  EXPECT_EQ(read_scene(path("b.gltf")).textures[0].texels,
            (std::vector<glm::u8vec4>{{255, 0, 0, 255}, {0, 255, 0, 0}, {0, 0, 255, 128}, {255, 255, 255, 255}}));
  file.document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 0}, {"byteLength", 8}});
  file.document["images"] = {{{"bufferView", 3}}};
  file.write(folder / "c.gltf");
  EXPECT_NE(why(path("c.gltf")).find("not an image"), std::string::npos);
  file.document["images"] = {{{"uri", "gone.png"}}};
  file.write(folder / "c.gltf");
  EXPECT_NE(why(path("c.gltf")).find("gone.png"), std::string::npos);
}

TEST_F(SceneTest, LightsAndCamerasStandInTheirNodes) {
  GltfFile file = triangle();
  file.document["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "spot"},
       {"intensity", 10},
       {"color", {1, 0.5, 0}},
       {"range", 7},
       {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.4}}}},
      {{"type", "directional"}}};
  file.document["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}},
                              {{"type", "orthographic"},
                               {"orthographic", {{"xmag", 3}, {"ymag", 2}, {"znear", 0.5}, {"zfar", 9}}}}};
  file.document["nodes"].push_back(
      {{"name", "lit"}, {"translation", {1, 2, 3}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  file.document["nodes"].push_back({{"name", "eye"},
                                    {"rotation", {0, std::sqrt(0.5), 0, std::sqrt(0.5)}},
                                    {"camera", 0},
                                    {"extensions", {{"KHR_lights_punctual", {{"light", 1}}}}}});
  file.document["nodes"].push_back({{"camera", 1}});
  file.document["scenes"] = {{{"nodes", {0, 1, 2, 3}}}};
  file.write(folder / "a.glb");
  const SceneGraph scene = read_scene(path("a.glb"));
  ASSERT_EQ(scene.lights.size(), 2U);
  const PunctualLight& spot = scene.lights[0];
  EXPECT_EQ(spot.kind, PunctualLight::Kind::spot);
  EXPECT_EQ(spot.intensity, Colour(10, 5, 0));
  EXPECT_EQ(spot.range, 7);
  EXPECT_EQ(spot.inner, 0.2);
  EXPECT_EQ(spot.outer, 0.4);
  EXPECT_EQ(scene.lights[1].kind, PunctualLight::Kind::directional);
  ASSERT_EQ(scene.cameras.size(), 2U);
  const Camera& parallel = scene.cameras[1];
  EXPECT_EQ(parallel.name, "camera 1");  // It has no name, and neither has its node.
  EXPECT_EQ(parallel.half_height, 2);
  EXPECT_EQ(parallel.near, 0.5);
  EXPECT_EQ(parallel.far, 9);
  const Camera& camera = scene.cameras[0];
  EXPECT_EQ(camera.name, "eye");
  EXPECT_EQ(camera.vertical_field, 0.7);
  const Pose world = pose(scene, 0);
  near(at(world[spot.node], {0, 0, 0}), {1, 2, 3});
  near(at(world[camera.node], {0, 0, -1}), {-1, 0, 0});  // It looks along -X.
}

// float32 rounds pi / 2 up.
TEST_F(SceneTest, SpotsOfAHalfSphereInFloat32) {
  GltfFile file = triangle();
  const auto quarter = float(pi / 2);
  file.document["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "spot"}, {"spot", {{"innerConeAngle", quarter}, {"outerConeAngle", quarter}}}}};
  file.document["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
  file.write(folder / "a.gltf");
  const SceneGraph scene = read_scene(path("a.gltf"));
  EXPECT_EQ(scene.lights.at(0).outer, pi / 2);
  EXPECT_EQ(scene.lights.at(0).inner, pi / 2);
}

TEST(Camera, AxesAreOrthonormalUnderAnyScale) {
  const Camera camera{.name = "eye"};
  for (const Direction& scale : {Direction(-1, 1, 1), {3, 1, 1}, {1e-9, 1, 1e20}, {2, -3, -4}}) {
    const Matrix node = glm::scale(Matrix(1), scale) * glm::rotate(Matrix(1), 0.7, Direction(0.48, 0.6, 0.64));
    const Rotation axes = view_of(camera, {node}).axes;
    for (int k = 0; k < 9; ++k)
      EXPECT_NEAR(glm::dot(axes[k / 3], axes[k % 3]), k / 3 == k % 3 ? 1 : 0, 1e-12) << scale.x;
    EXPECT_NEAR(glm::determinant(axes), 1, 1e-12) << scale.x;
    near(axes[2], glm::normalize(Direction(node[2])));
  }
  EXPECT_THROW(view_of(camera, {glm::scale(Matrix(1), Direction(1, 0, 1))}), InputError);
}

TEST_F(SceneTest, NodesMoveAsTheirKeysSay) {
  GltfFile file = triangle();
  const float h = std::sqrt(0.5F);
  const int times = file.add<float>({0, 2}, "SCALAR", 1), places = file.add<float>({0, 0, 0, 4, 0, 0}, "VEC3", 3);
  const int turns = file.add<float>({0, 0, 0, 1, 0, h, 0, h}, "VEC4", 4);
  const int spline = file.add<float>({0, 0, 0, 1, 1, 1, 2, 0, 0, 0, 0, 0, 3, 3, 3, 0, 0, 0}, "VEC3", 3);
  file.document["nodes"][0]["translation"] = {0, 5, 0};
  file.document["nodes"][0]["scale"] = {1, 1, -2};  // Mirrored: no matrix says which axis was.
  const auto animate = [&](const char* what, int output, const char* how) {
    file.document["animations"] = {{{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", what}}}}}},
                                    {"samplers", {{{"input", times}, {"output", output}, {"interpolation", how}}}}}};
    file.write(folder / "a.gltf");
    return read_scene(path("a.gltf"));
  };
  const auto moved = [](const SceneGraph& scene, double time, const Direction& p) {
    return at(pose(scene, time)[0], p);
  };
  SceneGraph scene = animate("translation", places, "LINEAR");
  near(moved(scene, -1, {0, 0, 1}), {0, 0, -2});
  near(moved(scene, 0.5, {0, 0, 1}), {1, 0, -2});
  near(moved(scene, 3, {0, 0, 1}), {4, 0, -2});
  scene = animate("translation", places, "STEP");
  near(moved(scene, 1.99, {0, 0, 1}), {0, 0, -2});
  near(moved(scene, 2, {0, 0, 1}), {4, 0, -2});
  scene = animate("rotation", turns, "LINEAR");
  const double c = std::sqrt(0.5);
  near(moved(scene, 1, {1, 0, 0}), {c, 5, -c});  // Half of 90 degrees about +Y.
  near(moved(scene, 1, {0, 0, 1}), {-2 * c, 5, -2 * c});
  scene = animate("scale", spline, "CUBICSPLINE");
  near(moved(scene, 0, {1, 1, 1}), {1, 6, 1});
  // Hermite's spline half way: (p0 + p1) / 2 + span (m0 - m1) / 8 = 2 + 2 x 2 / 8 in x, 2 in y and z.
  near(moved(scene, 1, {1, 1, 1}), {2.5, 7, 2});
}

TEST_F(SceneTest, StripsFansQuantisedAndSparseVertices) {
  GltfFile file = triangle();
  const int square = file.add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, "VEC3", 3);
  auto& primitive = file.document["meshes"][0]["primitives"][0];
  primitive = {{"attributes", {{"POSITION", square}}}, {"mode", 5}};
  file.write(folder / "a.gltf");
  SceneGraph scene = read_scene(path("a.gltf"));
  ASSERT_EQ(scene.meshes[0].indices.size(), 6U);
  for (const glm::vec3& n : scene.meshes[0].normals)
    EXPECT_EQ(n, glm::vec3(0, 0, 1)) << "a strip turns every other triangle";
  primitive["mode"] = 6;
  file.write(folder / "a.gltf");
  scene = read_scene(path("a.gltf"));
  EXPECT_EQ(scene.meshes[0].positions[4], glm::vec3(0, 1, 0));

  const int bytes = file.add<std::uint8_t>({0, 0, 0, 255, 0, 0, 0, 51, 0}, "VEC3", 3);
  file.document["accessors"][bytes]["normalized"] = true;
  primitive = {{"attributes", {{"POSITION", bytes}}}};
  file.document["extensionsRequired"] = {"KHR_mesh_quantization"};
  file.write(folder / "a.gltf");
  EXPECT_EQ(read_scene(path("a.gltf")).meshes[0].positions[2], glm::vec3(0, 0.2F, 0));

  const int at_vertex = file.add<std::uint16_t>({2}, "SCALAR", 1), value = file.add<float>({7, 8, 9}, "VEC3", 3);
  primitive = {{"attributes", {{"POSITION", 0}}}, {"indices", 1}};
  file.document["accessors"][0]["sparse"] = {{"count", 1},
                                             {"indices", {{"bufferView", at_vertex}, {"componentType", 5123}}},
                                             {"values", {{"bufferView", value}}}};
  file.write(folder / "a.gltf");
  EXPECT_EQ(read_scene(path("a.gltf")).meshes[0].positions[2], glm::vec3(7, 8, 9));
}

// What glTF forbids and every program of the field draws.
TEST_F(SceneTest, ScenesThatListChildrenAreDrawn) {
  GltfFile file = triangle();
  file.document["nodes"] = {{{"mesh", 0}, {"name", "leaf"}, {"translation", {1, 0, 0}}},
                            {{"name", "parent"}, {"translation", {10, 0, 0}}, {"children", {0}}}};
  const auto read = [&](const json& listed) {
    file.document["scenes"] = {{{"nodes", listed}}};
    file.write(folder / "a.gltf");
    return read_scene(path("a.gltf"));
  };
  const auto leaf = [](const SceneGraph& scene) {
    return at(pose(scene, 0)[std::size_t(find_node(scene, "leaf").value())], {0, 0, 0});
  };
  SceneGraph scene = read({0});  // Its parent is not in the scene: it is a root.
  ASSERT_EQ(scene.nodes.size(), 1U);
  near(leaf(scene), {1, 0, 0});
  ASSERT_EQ(scene.remarks.size(), 1U);
  EXPECT_NE(scene.remarks[0].find("drawn as roots"), std::string::npos);
  for (const json& listed : {json{0, 1}, json{1, 0}}) {  // Once, below its parent.
    scene = read(listed);
    ASSERT_EQ(scene.nodes.size(), 2U);
    near(leaf(scene), {11, 0, 0});
    EXPECT_EQ(scene.remarks.size(), 1U);
  }
  scene = read({1, 1});
  EXPECT_EQ(scene.nodes.size(), 2U);
  EXPECT_EQ(scene.remarks.size(), 1U);
  EXPECT_TRUE(read({1}).remarks.empty());
}

TEST_F(SceneTest, CornersBeyondTheLastTriangleAreNotDrawn) {
  GltfFile file = triangle();
  file.document["meshes"][0]["primitives"][0]["indices"] = file.add<std::uint16_t>({0, 1, 2, 0, 1}, "SCALAR", 1);
  file.write(folder / "a.gltf");
  const SceneGraph scene = read_scene(path("a.gltf"));
  EXPECT_EQ(scene.meshes[0].indices.size(), 3U);
  EXPECT_EQ(scene.remarks.size(), 1U);
}

TEST_F(SceneTest, MissingTexturesMayBeLeftOut) {
  GltfFile file = triangle();
  file.document["images"] = {{{"uri", "none.png"}}};
  file.document["textures"] = {{{"source", 0}}};
  file.document["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  file.document["meshes"][0]["primitives"][0]["material"] = 0;
  file.write(folder / "a.gltf");
  EXPECT_THROW(read_scene(path("a.gltf")), MissingFile);
  EXPECT_NE(why(path("a.gltf")).find("'none.png', which is missing"), std::string::npos) << why(path("a.gltf"));
  const SceneGraph scene = read_scene(path("a.gltf"), 1 << 20, true);
  EXPECT_EQ(scene.materials[0].base_colour_texture, -1);
  ASSERT_EQ(scene.remarks.size(), 1U);
  EXPECT_NE(scene.remarks[0].find("none.png"), std::string::npos);
  put("none.png", "no picture");
  EXPECT_THROW(read_scene(path("a.gltf"), 1 << 20, true), InputError) << "a damaged one is no missing one";
}

// Of both kinds, on a mesh that gets its normals, and so vertices of its own for each triangle.
TEST_F(SceneTest, ColoursOfVertices) {
  GltfFile file = triangle();
  auto& attributes = file.document["meshes"][0]["primitives"][0]["attributes"];
  attributes["COLOR_0"] = file.add<float>({1, 0, 0, -1, 2, 0, 0, 0.5F, 1}, "VEC3", 3);  // Clamped.
  file.write(folder / "a.gltf");
  EXPECT_EQ(read_scene(path("a.gltf")).meshes[0].colours,
            (std::vector<glm::vec4>{{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0.5F, 1, 1}}));
  const int bytes = file.add<std::uint8_t>({255, 0, 0, 255, 0, 255, 0, 51, 0, 0, 255, 0}, "VEC4", 4);
  file.document["accessors"][bytes]["normalized"] = true;
  attributes["COLOR_0"] = bytes;
  file.write(folder / "b.gltf");
  EXPECT_EQ(read_scene(path("b.gltf")).meshes[0].colours,
            (std::vector<glm::vec4>{{1, 0, 0, 1}, {0, 1, 0, 0.2F}, {0, 0, 1, 0}}));
  attributes["COLOR_0"] = file.add<float>({1, 0, 0}, "VEC3", 3);
  file.write(folder / "c.gltf");
  EXPECT_NE(why(path("c.gltf")), "") << "one colour for three vertices";
}

// A triangle and its normals, compressed by Draco's own encoder.
std::string draco_triangle() {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(1);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int normal = builder.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32);
  const float corners[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, up[3] = {0, 1, 0};
  builder.SetAttributeValuesForFace(position, draco::FaceIndex(0), corners[0], corners[1], corners[2]);
  builder.SetAttributeValuesForFace(normal, draco::FaceIndex(0), up, up, up);
  draco::EncoderBuffer buffer;
  draco::Encoder encoder;
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*builder.Finalize(), &buffer).ok());
  return {buffer.data(), buffer.size()};
}

TEST_F(SceneTest, MeshesThatDracoCompressed) {
  GltfFile file = triangle();
  const std::string bytes = draco_triangle();
  const int view = file.add<std::uint8_t>({bytes.begin(), bytes.end()}, "SCALAR", 1);
  file.document["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  json& extension = file.document["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"];
  extension = {{"bufferView", view}, {"attributes", {{"POSITION", 0}, {"NORMAL", 1}}}};
  file.write(folder / "a.glb");
  const SceneGraph scene = read_scene(path("a.glb"));
  ASSERT_EQ(scene.meshes[0].indices.size(), 3U);
  Direction sum(0);
  for (const std::uint32_t v : scene.meshes[0].indices) sum += Direction(scene.meshes[0].positions[v]);
  near(sum, {1, 1, 0}, 1e-3);
  near(Direction(scene.meshes[0].normals[0]), {0, 1, 0}, 2e-2);
  EXPECT_TRUE(scene.unsupported.empty());
  extension["attributes"]["POSITION"] = 7;
  file.write(folder / "a.glb");
  EXPECT_NE(why(path("a.glb")).find("lacks an attribute"), std::string::npos);
  extension["attributes"]["POSITION"] = 0;
  for (std::size_t k = 0; k < bytes.size(); ++k) {  // Damaged anywhere it is refused or still a mesh.
    GltfFile damaged = file;
    damaged.bytes[file.bytes.size() - bytes.size() + k] ^= 0x55;
    damaged.write(folder / "b.glb");
    EXPECT_EQ(why(path("b.glb")).find('\n'), std::string::npos);
    damaged = file;
    damaged.document["bufferViews"][view]["byteLength"] = k;
    damaged.write(folder / "b.glb");
    EXPECT_NE(why(path("b.glb")), "") << k;
  }
}

// ---- samples --------------------------------------------------------------------------------------------------------

TEST_F(SceneTest, TheSampleScenesAreRead) {
  const std::string command =
      std::string("PYTHONDONTWRITEBYTECODE=1 python3 '") + ENVMAP_MAKE_SCENES + "' '" + folder.string() + "'";
  ASSERT_EQ(std::system(command.c_str()), 0);
  for (const auto& [name, side] :
       {std::pair("room-2.glb", 1), std::pair("room-4.glb", 3), std::pair("room-21.glb", 20)}) {
    const SceneGraph room = read_scene(path(name));
    EXPECT_EQ(room.meshes[0].indices.size() / 6, std::size_t(side * side)) << name;
    EXPECT_TRUE(room.unsupported.empty());
  }
  EXPECT_EQ(read_scene(path("wire-cube.glb")).nodes.size(), 22U);  // 12 edges, 8 corners, a lamp, a camera.
  const SceneGraph cellar = read_scene(path("cellar.glb"));
  EXPECT_TRUE(cellar.unsupported.empty());
  EXPECT_EQ(cellar.cameras.size(), 2U);
  EXPECT_EQ(cellar.lights.size(), 3U);
  EXPECT_EQ(cellar.animations.size(), 3U);
  for (const char* mirror : {"mirror ball", "mirror ring"}) {
    const auto node = find_node(cellar, mirror);
    ASSERT_TRUE(node);
    const Mesh& mesh = cellar.meshes[cellar.nodes[std::size_t(*node)].meshes.at(0)];
    const Material& material = cellar.materials[mesh.material];
    EXPECT_EQ(material.metallic, 1);
    EXPECT_EQ(material.roughness, 0);
  }
  // The lamp swings on its cord: half way to a side after 0.75 s it is where 7 degrees about the hook take it.
  const auto light = std::size_t(cellar.lights[2].node);
  near(at(pose(cellar, 0.75)[light], {0, 0, 0}),
       Direction(0.3 + 1.02 * std::sin(7 * pi / 180), 3.15 - 1.02 * std::cos(7 * pi / 180), 0.6), 1e-3);
}

}  // namespace
}  // namespace scenes::read_gltf_test

// Scenes from files: what is in OBJ and MTL.
#include <cmath>
#include <random>

#include "envmap/scenes/read/read_scene.h"
#include "envmap/scenes/read/triangulate.h"
#include "render/gltf_file.h"

namespace scenes::read_obj_test {
namespace {

using namespace envmap;

double area_of(const Mesh& mesh) {
  double sum = 0;
  for (std::size_t k = 0; k < mesh.indices.size(); k += 3) {
    const auto corner = [&](std::size_t c) { return Direction(mesh.positions[mesh.indices[k + c]]); };
    sum += glm::length(glm::cross(corner(1) - corner(0), corner(2) - corner(0))) / 2;
  }
  return sum;
}

TEST_F(SceneTest, ObjWithMaterialsAndWindowsPaths) {
  std::filesystem::create_directory(folder / "maps");
  std::ofstream(folder / "maps" / "a.ppm", std::ios::binary) << "P6 1 2 255\n"
                                                             << std::string("\x01\x02\x03\x04\x05\x06", 6);
  put("a.mtl", "newmtl shiny\nKd 0.5 0.25 1\nKe 3 2 1\nNs 6\nmap_Kd maps\\a.ppm\n");
  put("a.obj",
      "mtllib a.mtl\nv 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\no square\nusemtl shiny\n"
      "f 1/1 2/2 3/3 4/4\n");
  const SceneGraph scene = read_scene(path("a.obj"));
  ASSERT_EQ(scene.meshes.size(), 1U);
  const Mesh& mesh = scene.meshes[0];
  ASSERT_EQ(mesh.indices.size(), 6U);
  for (const std::uint32_t v : mesh.indices) {
    EXPECT_EQ(mesh.normals[v], glm::vec3(0, 0, 1));
    EXPECT_EQ(mesh.coordinates[v], glm::vec2(mesh.positions[v].x / 2, 1 - mesh.positions[v].y / 2))
        << "0 is the upper edge";
  }
  const Material& m = scene.materials[mesh.material];
  EXPECT_EQ(m.base_colour, glm::vec4(0.5F, 0.25F, 1, 1));
  EXPECT_EQ(m.emissive, Colour(3, 2, 1));
  EXPECT_FLOAT_EQ(m.roughness, std::sqrt(0.5F));  // alpha^2 = 2 / (6 + 2).
  ASSERT_EQ(m.base_colour_texture, 0);
  EXPECT_EQ(scene.textures[0].texels[0], glm::u8vec4(1, 2, 3, 255));
}

TEST_F(SceneTest, ObjOfOldMacsAndWithAbsolutePaths) {
  std::ofstream(folder / "a.ppm", std::ios::binary) << "P6 1 1 255\n\x01\x02\x03";
  put("a.mtl", "newmtl red\rKd 1 0 0\rmap_Kd /home/someone/a.ppm\r");
  put("a.obj", "mtllib C:\\models\\a.mtl\rv 0 0 0\rv 1 0 0\rv 0 1 0\rusemtl red\rf 1 2 3\r");
  SceneGraph scene = read_scene(path("a.obj"));
  EXPECT_EQ(scene.materials[scene.meshes.at(0).material].base_colour, glm::vec4(1, 0, 0, 1));
  ASSERT_EQ(scene.textures.size(), 1U);
  ASSERT_EQ(scene.remarks.size(), 2U);
  EXPECT_NE(scene.remarks[0].find("absolute path"), std::string::npos);
  put("b.obj", "mtllib /models/none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  scene = read_scene(path("b.obj"));
  EXPECT_NE(scene.remarks.back().find("missing"), std::string::npos) << scene.remarks.back();
}

TEST_F(SceneTest, MissingTexturesOfObjMayBeLeftOut) {
  put("a.mtl", "newmtl red\nKd 1 0 0\nmap_Kd none.ppm\n");
  put("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n");
  EXPECT_NE(why(path("a.obj")).find("'none.ppm', which is missing"), std::string::npos) << why(path("a.obj"));
  const SceneGraph scene = read_scene(path("a.obj"), 1 << 20, true);
  EXPECT_EQ(scene.materials[0].base_colour_texture, -1);
  EXPECT_EQ(scene.remarks.size(), 1U);
}

TEST_F(SceneTest, ObjAsTheManualHasIt) {
  // CR LF, a line that goes on, negative indices, a colour and a weight, a comment behind, a name with spaces and a #.
  put("my colours.mtl", "\xef\xbb\xbf# first\r\nnewmtl red #1\r\nKd 1 0 \\\r\n 0\r\nNi 2\r\n");
  put("a.obj",
      "mtllib my colours.mtl\r\no one\r\nv 0 0 0 1 0 0\r\nv 1 0 0 1.0\r\nv 0 \\\r\n1 0\r\nusemtl red #1\r\n"
      "f -3 -2 -1 # all\r\nl 1 2\r\ng two more\r\nusemtl none\r\nf 1 2 3\r\no one\r\nf 3 2 1");
  const SceneGraph scene = read_scene(path("a.obj"));
  ASSERT_EQ(scene.nodes.size(), 2U);
  EXPECT_EQ(scene.nodes[0].name, "one");
  EXPECT_EQ(scene.nodes[1].name, "two more");
  ASSERT_EQ(scene.nodes[0].meshes.size(), 2U) << "two materials, of which the second came after another group";
  const Mesh& mesh = scene.meshes[0];
  EXPECT_EQ(mesh.positions[mesh.indices[2]], glm::vec3(0, 1, 0));
  const Material& red = scene.materials[mesh.material];
  EXPECT_EQ(red.name, "red #1");
  EXPECT_EQ(red.base_colour, glm::vec4(1, 0, 0, 1));
  EXPECT_EQ(red.ior, 2);
  EXPECT_EQ(scene.unsupported, (std::vector<std::string>{"colours of vertices", "points and lines"}));
  EXPECT_EQ(scene.remarks, (std::vector<std::string>{"no .mtl defines the material 'none': it is white"}));
  EXPECT_EQ(scene.files, (std::vector<std::string>{path("a.obj"), path("my colours.mtl")}));
}

TEST_F(SceneTest, MaterialLibrariesThatAreMissingAreSaid) {
  put("there.mtl", "newmtl a\nKd 0.5 0.5 0.5\n");
  put("a.obj", "mtllib there.mtl gone.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n");
  const SceneGraph scene = read_scene(path("a.obj"));
  EXPECT_EQ(scene.remarks, (std::vector<std::string>{"'gone.mtl' is missing: its materials are white"}));
  EXPECT_EQ(scene.materials[0].base_colour, glm::vec4(0.5F, 0.5F, 0.5F, 1));
  EXPECT_EQ(scene.materials[1].base_colour, glm::vec4(1));
}

TEST_F(SceneTest, OptionsAndExtensionsOfMaterials) {
  std::ofstream(folder / "my map.ppm", std::ios::binary) << "P6 1 1 255\nabc";
  put("a.mtl",
      "newmtl metal\nPm 1\nPr 0.25\naniso 0\nillum 3\nKs 0.5 0.5 0.5\nmap_Ke -blendu on -clamp on -o 0 -s 1 1 1 -mm 0 "
      "1 my map.ppm\n"
      "newmtl matte\nKd 0.5\nKs 0 0 0\nNs 1000\nillum 2\nTr 0\nd 1\nTf 1 1 1\nKa 0 0 0\nmap_Kd -s 2 2 2 my map.ppm\n"
      "newmtl window\nd -halo 0.5\nbump -bm 0.1 x.png\nmap_Pr x.png\nPc 0.5\nPcr 0.25\nPs 1\nKd spectral x.rfl\n");
  put("a.obj",
      "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl metal\nf 1 2 3\nusemtl matte\nf 1 2 3\nusemtl window\nf 1 2 "
      "3\n");
  const SceneGraph scene = read_scene(path("a.obj"));
  const Material &metal = scene.materials[0], &matte = scene.materials[1];
  EXPECT_EQ(metal.metallic, 1);
  EXPECT_EQ(metal.roughness, 0.25F);
  EXPECT_EQ(metal.ior, 1.5F);
  EXPECT_EQ(metal.emissive, Colour(1)) << "a texture alone shines";
  ASSERT_EQ(metal.emissive_texture, 0);
  EXPECT_EQ(scene.textures[0].wrap_u, Texture::Wrap::clamp);
  EXPECT_EQ(matte.base_colour, glm::vec4(0.5F, 0.5F, 0.5F, 1)) << "one number is grey";
  EXPECT_EQ(matte.ior, 1) << "no highlight";
  ASSERT_EQ(matte.base_colour_texture, 1) << "not clamped, so another";
  EXPECT_EQ(scene.materials[2].coat, 0.5F);
  EXPECT_EQ(scene.materials[2].coat_roughness, 0.25F);
  EXPECT_EQ(scene.unsupported, (std::vector<std::string>{"scaled textures", "alpha blending", "normal maps",
                                                         "textures of roughness, metalness and highlights",
                                                         "sheen and anisotropy", "colours as spectra or CIE XYZ"}));
}

TEST_F(SceneTest, LinearTexturesAreEncoded) {
  const float colour[] = {0.5F, 0, 4};
  put("a.pfm", "PF\n1 1\n-1\n" + std::string(reinterpret_cast<const char*>(colour), sizeof colour));
  put("a.mtl", "newmtl a\nmap_Ke a.pfm\n");
  put("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
  const SceneGraph scene = read_scene(path("a.obj"));
  EXPECT_TRUE(scene.textures.at(0).srgb);
  EXPECT_EQ(scene.textures[0].texels[0], glm::u8vec4(188, 0, 255, 255));
  EXPECT_EQ(scene.unsupported, (std::vector<std::string>{"colours of textures above 1"}));
}

TEST_F(SceneTest, CommentsEndWithTheirLine) {
  put("a.obj", "# from C:\\models\\\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(why(path("a.obj")), "");
}

// A cube in one smoothing group: at a corner three faces meet at right angles, so the normal is (1,1,1)/sqrt(3),
// however the faces are cut into triangles.
TEST_F(SceneTest, SmoothingGroupsShareNormals) {
  const std::string cube = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n";
  const std::string faces = "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  put("smooth.obj", cube + "s 1\n" + faces);
  put("flat.obj", cube + "s off\n" + faces);
  const SceneGraph smooth = read_scene(path("smooth.obj")), flat = read_scene(path("flat.obj"));
  ASSERT_EQ(smooth.meshes[0].positions.size(), 8U);
  for (std::size_t k = 0; k < 8; ++k)
    EXPECT_LT(glm::length(smooth.meshes[0].normals[k] - smooth.meshes[0].positions[k] / std::sqrt(3.0F)), 1e-6F);
  EXPECT_EQ(flat.meshes[0].positions.size(), 26U) << "of six faces, one in two parts";
  for (std::size_t k = 0; k < flat.meshes[0].normals.size(); ++k) {
    const glm::vec3 n = flat.meshes[0].normals[k];
    EXPECT_FLOAT_EQ(std::abs(n.x) + std::abs(n.y) + std::abs(n.z), 1);
    EXPECT_GT(glm::dot(n, flat.meshes[0].positions[k]), 0);
  }
  EXPECT_DOUBLE_EQ(area_of(smooth.meshes[0]), 24);
}

// ---- polygons -------------------------------------------------------------------------------------------------------

// What triangles cover: their areas have one sign and sum to the polygon's, so they neither overlap nor leave a gap.
void expect_exact(const std::vector<Direction>& polygon) {
  const Direction whole = area_vector(polygon);
  double sum = 0;
  const auto triangles = triangulate(polygon);
  ASSERT_EQ(triangles.size(), polygon.size() - 2);
  for (const auto& [a, b, c] : triangles) {
    const Direction one = glm::cross(polygon[b] - polygon[a], polygon[c] - polygon[a]);
    EXPECT_GE(glm::dot(one, whole), -1e-9);
    sum += glm::length(one);
  }
  EXPECT_NEAR(sum, glm::length(whole), 1e-9 * sum);
}

std::vector<Direction> turned(std::vector<Direction> polygon, int turn) {
  const Rotation r = rotation(37.0 * turn, 51.0 * turn, 11.0 * turn);
  for (Direction& p : polygon) p = r * p;
  return polygon;
}

TEST(Triangulate, PolygonsOfAllShapes) {
  std::vector<Direction> comb, spiral;
  for (int k = 0; k < 40; ++k) comb.insert(comb.end(), {{2.0 * k, 0, 0}, {2 * k + 1.0, -9, 0}});
  comb.insert(comb.end(), {{80, 1, 0}, {0, 1, 0}});
  for (int k = 0; k <= 200; ++k)
    spiral.push_back({(1 + 0.05 * k) * std::cos(0.1 * k), (1 + 0.05 * k) * std::sin(0.1 * k), 0});
  for (int k = 200; k >= 0; --k)
    spiral.push_back({(0.9 + 0.05 * k) * std::cos(0.1 * k), (0.9 + 0.05 * k) * std::sin(0.1 * k), 0});
  const std::vector<Direction> shapes[] = {
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
      {{0, 0, 0}, {2, 0, 0}, {0.5, 0.5, 0}, {0, 2, 0}},                               // An arrow.
      {{0.5, 0.5, 0}, {0, 2, 0}, {0, 0, 0}, {2, 0, 0}},                               // From its inner corner.
      {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 2, 0}, {1, 1, 0}, {0, 1, 0}},  // Corners on an edge.
      // A hole.
      {{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}, {0, 0, 0}, {1, 1, 0}, {1, 2, 0}, {2, 2, 0}, {2, 1, 0}, {1, 1, 0}},
      comb,
      spiral};
  for (const auto& shape : shapes)
    for (int turn = 0; turn < 4; ++turn) {
      expect_exact(turned(shape, turn));
      auto backwards = turned(shape, turn);
      std::ranges::reverse(backwards);
      expect_exact(backwards);
    }
}

TEST(Triangulate, StarsAroundAPoint) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> radius(0.1, 1);
  for (int shape = 0; shape < 200; ++shape) {
    std::vector<Direction> star;
    const int corners = 4 + shape;
    for (int k = 0; k < corners; ++k) {
      const double angle = 2 * pi * k / corners, r = radius(random);
      star.push_back({r * std::cos(angle), r * std::sin(angle), 0});
    }
    expect_exact(turned(star, shape % 5));
  }
}

// Those that cross themselves, and points without any area, become triangles all the same;
// too many corners are refused.
TEST(Triangulate, WhatIsNoPolygonEnds) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int shape = 0; shape < 300; ++shape) {
    std::vector<Direction> points;
    for (int k = 0; k < 4 + shape % 60; ++k)
      points.push_back(shape % 3 == 0 ? Direction(0)
                                      : Direction(any(random), any(random), shape % 3 == 1 ? 0 : any(random)));
    EXPECT_EQ(triangulate(points).size(), points.size() - 2);
  }
  std::vector<Direction> large;
  for (std::size_t k = 0; k <= max_concave_corners; ++k) large.push_back({double(k), double(k % 2), 0});
  EXPECT_THROW(triangulate(large), InputError);
}

}  // namespace
}  // namespace scenes::read_obj_test

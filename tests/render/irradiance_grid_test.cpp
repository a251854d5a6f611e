// Irradiance grids against closed forms, and their files as Bevy's shader and JSON readers see them.
#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>

#include "envmap/scenes.h"
#include "render/gltf_file.h"

namespace irradiance_grid_test {
namespace {

using namespace envmap;
using namespace scenes;

// The box [-1,1]^3, its fronts inwards or outwards; the wall at -Z has a material of its own.
std::string box(bool inwards) {
  std::string text = "mtllib box.mtl\n";
  for (const int z : {-1, 1})
    for (const int y : {-1, 1})
      for (const int x : {-1, 1}) text += fmt::format("v {} {} {}\n", x, y, z);
  text += "usemtl wall\n";
  const char* const sides[] = {"1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"};  // Outwards.
  for (int k = 0; k < 6; ++k) {
    if (k == 1) text += "usemtl other\n";
    std::string side = sides[k];
    if (inwards) std::ranges::reverse(side);  // Numbers of one digit.
    text += "f " + side + "\n";
  }
  return text;
}

class IrradianceGrids : public SceneTest {
 protected:
  // @param wall, other what materials send out.
  [[nodiscard]] Scene scene(bool inwards, double wall, double other) const {
    const auto material = [](const char* name, double e) {
      return fmt::format("newmtl {}\nKd 0 0 0\nKe {} {} {}\n", name, e, e, e / 2);
    };
    put("box.mtl", material("wall", wall) + material("other", other));
    put("box.obj", box(inwards));
    return Scene::read(path("box.obj"));
  }
  [[nodiscard]] std::string bytes(const std::string& name) const {
    std::ifstream stream(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
};

// In a room that shines evenly, irradiance is pi everywhere.
TEST_F(IrradianceGrids, AnEvenRoomIsEven) {
  const IrradianceGrid grid = irradiance_grid(scene(true, 1, 1), {.cells = {3, 2, 4}});
  ASSERT_EQ(grid.light.size(), 24U);
  EXPECT_EQ(grid.invalid(), 0);
  EXPECT_EQ(grid.box.low, Direction(-1));
  EXPECT_EQ(grid.box.high, Direction(1));
  for (const ShaderSh& nine : grid.light) {
    EXPECT_NEAR(nine[0].x, std::sqrt(4 * pi), 1e-5);
    EXPECT_NEAR(nine[0].z, std::sqrt(pi), 1e-5);
    for (std::size_t k = 1; k < 9; ++k) EXPECT_NEAR(nine[k].x, 0, 1e-5);
  }
  EXPECT_NEAR(grid.irradiance({0.3, -0.2, 5}, {1, 2, 3}).x, pi, 1e-5);
  EXPECT_EQ(grid.error.places, 64);
  EXPECT_LT(grid.error.max, 0.01);
}

// A square of side 2 at distance 1, seen from over its middle by a surface that faces it: 4 times the form factor of a
// quarter (Howell, catalogue of configuration factors, B-4).
TEST_F(IrradianceGrids, AShiningWallLightsTheMiddle) {
  const IrradianceGrid grid = irradiance_grid(scene(true, 1, 0), {.cells = {3, 3, 3}, .size = 32});
  const double quarter = 2 / (2 * pi) * std::sqrt(0.5) * std::atan(std::sqrt(0.5));
  EXPECT_NEAR(grid.irradiance({0, 0, 0}, {0, 0, -1}).x / pi, 4 * quarter, 0.03);
  EXPECT_LT(grid.irradiance({0, 0, 0}, {0, 0, 1}).x, 0.02);
  EXPECT_GT(grid.irradiance({0, 0, -0.6}, {0, 0, -1}).x, grid.irradiance({0, 0, 0.6}, {0, 0, -1}).x);
  EXPECT_GT(grid.error.rms, 1e-3) << "three cells cannot follow it";
  EXPECT_LT(grid.error.rms, 0.3);
}

TEST_F(IrradianceGrids, MoreCellsHaveLessError) {
  const Scene room = scene(true, 1, 0);
  const auto rms = [&](int n) { return irradiance_grid(room, {.cells = {n, n, n}}).error.rms; };
  EXPECT_LT(rms(6), rms(2));
}

// The same box of one material, which shows its front alone: OBJ files cannot say so.
Scene solid(const std::filesystem::path& path) {
  GltfFile file;
  std::vector<float> corners;
  for (const float z : {-1.F, 1.F})
    for (const float y : {-1.F, 1.F})
      for (const float x : {-1.F, 1.F}) corners.insert(corners.end(), {x, y, z});
  json& primitive = file.document["meshes"][0]["primitives"][0];
  primitive["attributes"]["POSITION"] = file.add<float>(corners, "VEC3", 3);
  primitive["indices"] = file.add<std::uint16_t>({0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                                  2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5},
                                                 "SCALAR", 1);
  file.document["nodes"] = {{{"mesh", 0}}};
  file.write(path);
  return Scene::read(path.string());
}

// Of 4 x 4 x 4 cells over [-2,2]^3, the eight in the middle lie in the box.
TEST_F(IrradianceGrids, CellsInsideSolidsAreFound) {
  const Light even(generate(Constant{}, Projection::latlong, 32));
  const GridOptions options{.cells = {4, 4, 4}, .box = SceneBox{Direction(-2), Direction(2)}};
  const IrradianceGrid grid = irradiance_grid(solid(folder / "solid.glb"), options, &even);
  EXPECT_EQ(grid.invalid(), 8);
  for (int z = 0; z < 4; ++z)
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 4; ++x) {
        const auto inner = [](int k) { return k == 1 || k == 2; };
        const std::size_t cell = grid.index(x, y, z);
        if (inner(x) && inner(y) && inner(z)) {
          EXPECT_NEAR(grid.validity[cell], 0, 1e-12);
          EXPECT_GT(grid.light[cell][0].x, 1) << "neighbours fill it";
        } else {
          EXPECT_GT(grid.validity[cell], 0.9) << "but for rays that graze an edge";
        }
      }
  EXPECT_EQ(grid.error.places, 64) << "outside of the box alone";
}

TEST_F(IrradianceGrids, ThreadsChangeNothing) {
  const Scene room = scene(true, 1, 0.25);
  const IrradianceGrid one = irradiance_grid(room, {}, nullptr, {.threads = 1}),
                       four = irradiance_grid(room, {}, nullptr, {.threads = 4});
  EXPECT_EQ(one.light, four.light);
  EXPECT_EQ(one.error.rms, four.error.rms);
}

template <class T>
T number_at(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

// Of a positive half float, or 0.
double half_at(const std::string& bytes, std::size_t at) {
  const auto h = number_at<std::uint16_t>(bytes, at);
  return (h >> 10) == 0 ? std::ldexp(h, -24) : std::ldexp(1024 + (h & 1023), (h >> 10) - 25);
}

// As irradiance_volume.wgsl looks a direction along an axis up: neg_offset is half of the height, axes are thirds of
// the depth.
TEST_F(IrradianceGrids, BevyFindsWhatTheGridHas) {
  const Light sky(
      generate(Sun{.towards = {1, 2, -0.5}, .radius_degrees = 30, .radiance = {4, 3, 2}}, Projection::latlong, 64));
  const std::array<int, 3> n{3, 2, 4};
  const IrradianceGrid grid =
      irradiance_grid(scene(false, 1, 0.5), {.cells = n, .box = SceneBox{{-2, -1, 1.5}, {2, 3, 3}}}, &sky);
  write_grid(path("volume.ktx2"), grid);
  const std::string file = bytes("volume.ktx2");
  ASSERT_EQ(file.substr(0, 12), std::string("\xabKTX 20\xbb\r\n\x1a\n", 12));
  const auto word = [&](std::size_t k) { return number_at<std::uint32_t>(file, 12 + 4 * k); };
  EXPECT_EQ(word(0), 97U) << "VK_FORMAT_R16G16B16A16_SFLOAT";
  EXPECT_EQ(word(1), 2U);
  const std::array<std::uint32_t, 3> size{word(2), word(3), word(4)};
  EXPECT_EQ(size, (std::array<std::uint32_t, 3>{3, 4, 12}));
  EXPECT_EQ(word(5), 0U) << "no layers";
  EXPECT_EQ(word(6), 1U) << "faces";
  EXPECT_EQ(word(7), 1U) << "levels";
  const auto offset = number_at<std::uint64_t>(file, 80), length = number_at<std::uint64_t>(file, 88);
  EXPECT_EQ(length, 8U * 3 * 4 * 12);
  ASSERT_EQ(offset + length, file.size());
  EXPECT_EQ(offset % 8, 0U);
  for (int z = 0; z < n[2]; ++z)
    for (int y = 0; y < n[1]; ++y)
      for (int x = 0; x < n[0]; ++x)
        for (int axis = 0; axis < 3; ++axis)
          for (const int sign : {-1, 1}) {
            Direction normal(0);
            normal[axis] = sign;
            const std::size_t t = std::size_t(y) + (sign < 0 ? size[1] / 2 : 0),
                              p = std::size_t(z) + std::size_t(axis) * size[2] / 3;
            const std::size_t texel = (p * size[1] + t) * size[0] + std::size_t(x);
            const Flux wanted = grid.irradiance(grid.centre(x, y, z), normal) / pi;
            for (int c = 0; c < 3; ++c)
              EXPECT_NEAR(half_at(file, offset + 8 * texel + 2 * std::size_t(c)), wanted[c], 1e-3 * wanted[c] + 1e-6);
          }
  EXPECT_NE(file.find("envmap:grid-centre"), file.npos);
}

TEST_F(IrradianceGrids, JsonHoldsEveryNumber) {
  const IrradianceGrid grid = irradiance_grid(scene(true, 1, 0.25), {.cells = {3, 1, 2}});
  write_grid(path("grid.json"), grid);
  const json read = json::parse(bytes("grid.json"));
  EXPECT_EQ(read["cells"], (json{3, 1, 2}));
  EXPECT_EQ(read["low"], (json{-1.0, -1.0, -1.0}));
  EXPECT_EQ(read["error"]["rms"], grid.error.rms);
  ASSERT_EQ(read["coefficients"].size(), 6U);
  for (std::size_t cell = 0; cell < 6; ++cell) {
    EXPECT_EQ(read["validity"][cell], grid.validity[cell]);
    for (std::size_t k = 0; k < 9; ++k)
      for (int c = 0; c < 3; ++c) EXPECT_EQ(read["coefficients"][cell][k][std::size_t(c)], grid.light[cell][k][c]);
  }
  // Where the cell at (2, 0, 1) is.
  for (int axis = 0; axis < 3; ++axis) {
    const int at[] = {2, 0, 1};
    EXPECT_NEAR(double(read["first"][std::size_t(axis)]) + at[axis] * double(read["step"][std::size_t(axis)]),
                grid.centre(2, 0, 1)[axis], 1e-12);
  }
}

TEST_F(IrradianceGrids, WhatMakesNoSense) {
  const Scene room = scene(true, 1, 1);
  EXPECT_THROW((void)irradiance_grid(room, {.cells = {0, 1, 1}}), UsageError);
  EXPECT_THROW((void)irradiance_grid(room, {.cells = {1, 257, 1}}), UsageError);
  EXPECT_THROW((void)irradiance_grid(room, {.size = 3}), UsageError);
  EXPECT_THROW((void)irradiance_grid(room, {.box = SceneBox{Direction(0), Direction(1, 0, 1)}}), UsageError);
  EXPECT_THROW((void)irradiance_grid(room, {.box = SceneBox{Direction(0), Direction(1, NAN, 1)}}), UsageError);
  EXPECT_THROW((void)IrradianceGrid{}.irradiance({}, {0, 1, 0}), UsageError);
  const IrradianceGrid bright = irradiance_grid(scene(true, 1e6, 1e6), {.cells = {1, 1, 1}});
  EXPECT_THROW(write_grid(path("bright.ktx2"), bright), OutputError);
  EXPECT_THROW(write_grid(path("bright.exr"), bright), UsageError);
  EXPECT_FALSE(std::filesystem::exists(path("bright.ktx2")));
}

}  // namespace
}  // namespace irradiance_grid_test

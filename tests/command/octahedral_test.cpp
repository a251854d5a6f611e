// Octahedral maps as users meet them: borders that are written and read back, the frame that pbrt reads.
#include <cmath>
#include <nlohmann/json.hpp>

#include "picture.h"
#include "run.h"

namespace command_tests::octahedral_test {
namespace {

class OctahedralMaps : public CommandTest {};

TEST_F(OctahedralMaps, ABorderIsLeftOutWhenItIsRead) {
  succeeds({"generate", "sun", "sun.exr", "--size", "32", "--direction", "3,-2,1", "--radius", "12"});
  for (const std::string to : {"octahedral", "equal-area"}) {
    succeeds({"convert", "sun.exr", "plain.exr", "--to", to, "--size", "28"});
    for (const std::string file : {"bordered.exr", "bordered.ktx2", "bordered.tif"}) {
      succeeds({"convert", "sun.exr", file, "--to", to, "--size", "32", "--border", "2"});
      const Result r = envmap({"compare", file, "plain.exr", "--max-rms", "0"});
      EXPECT_EQ(r.status, 0) << file << r.out << r.err;
      EXPECT_EQ(r.err, "") << "of another size";
    }
    // Without metadata the border must be said.
    succeeds({"convert", "sun.exr", "bordered.pfm", "--to", to, "--size", "32", "--border", "2"});
    succeeds({"convert", "bordered.pfm", "back.exr", "--from", to, "--from-border", "2"});
    succeeds({"compare", "back.exr", "plain.exr", "--max-error", "0"});
  }
}

// The texels of the image itself: those of the border are those of the square,
// mirrored along each side about its middle.
TEST_F(OctahedralMaps, TheBorderIsTheSquareMirrored) {
  succeeds({"generate", "directions", "map.pfm", "--to", "octahedral", "--size", "6"});
  for (const int border : {1, 2, 7}) {
    const int n = 6, w = n + 2 * border;
    succeeds({"convert", "map.pfm", "out.pfm", "--from", "octahedral", "--size", std::to_string(w), "--border",
              std::to_string(border)});
    const Picture map = load(path("map.pfm")), out = load(path("out.pfm"));
    ASSERT_EQ(out.width, w);
    ASSERT_EQ(out.height, w);
    for (int j = 0; j < w; ++j)
      for (int i = 0; i < w; ++i) {
        int x = i - border, y = j - border;
        // One side after another, until the place lies inside.
        while (x < 0 || x >= n || y < 0 || y >= n) {
          if (x < 0) x = -1 - x, y = n - 1 - y;
          else if (x >= n) x = 2 * n - 1 - x, y = n - 1 - y;
          else if (y < 0) y = -1 - y, x = n - 1 - x;
          else y = 2 * n - 1 - y, x = n - 1 - x;
        }
        for (int c = 0; c < 3; ++c) ASSERT_EQ(out.at(i, j)[c], map.at(x, y)[c]) << border << ": " << i << "," << j;
      }
  }
}

TEST_F(OctahedralMaps, LevelsHalveWithTheirBorderAndKeepTheLight) {
  succeeds({"generate", "sun", "sun.exr", "--to", "equal-area", "--size", "60", "--radius", "5"});
  succeeds({"mipmap", "sun.exr", "chain.ktx2", "--border", "2"});
  const Result r = envmap({"info", "chain.ktx2", "--levels", "--json"});
  const auto map = nlohmann::json::parse(r.out);
  EXPECT_EQ(map["border"], 2);
  EXPECT_EQ(map["width"], 64);
  EXPECT_EQ(map["face_width"], 60);
  EXPECT_EQ(map["levels"], 4) << "60, 28, 12, 4";
  succeeds({"prefilter", "sun.exr", "ggx.ktx2", "--lobe", "ggx", "--to", "octahedral", "--size", "32", "--levels", "3",
            "--border", "1", "-q"});
  fails(2,
        {"prefilter", "sun.exr", "ggx.ktx2", "--lobe", "ggx", "--to", "octahedral", "--size", "8", "--levels", "4",
         "--border", "2"},
        {"--border 2", "4"});
  fails(2, {"convert", "sun.exr", "out.exr", "--to", "cube", "--border", "1"}, {"octahedral", "cube"});
}

// pbrt-v4's EqualAreaSphereToSquare (util/math.cpp), by libm where pbrt has a polynomial: where pbrt looks for its
// direction w our file shows (x, y, z) = (w.x, w.z, -w.y), as the manual says.
TEST_F(OctahedralMaps, PbrtFindsItsDirections) {
  const int n = 64;
  succeeds({"generate", "directions", "map.pfm", "--to", "equal-area", "--size", std::to_string(n)});
  const Picture map = load(path("map.pfm"));
  const double pi = std::acos(-1.0);
  for (const double x : {-0.8, -0.1, 0.4})
    for (const double y : {-0.6, 0.2, 0.7})
      for (const double z : {-0.9, -0.2, 0.5}) {
        const double length = std::sqrt(x * x + y * y + z * z), w[] = {x / length, y / length, z / length};
        const double r = std::sqrt(1 - std::abs(w[2])), part = std::atan2(std::abs(w[1]), std::abs(w[0])) * 2 / pi;
        double v = part * r, u = r - v;
        if (w[2] < 0) {
          const double old = u;
          u = 1 - v, v = 1 - old;
        }
        u = 0.5 * (std::copysign(u, w[0]) + 1), v = 0.5 * (std::copysign(v, w[1]) + 1);
        const auto found = map.at(int(u * n), int(v * n));
        const double wanted[] = {w[0], w[2], -w[1]};
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(2 * found[c] - 1, wanted[c], 3.0 / n) << x << " " << y << " " << z;
      }
}

// Only what casts rays draws them.
TEST_F(OctahedralMaps, WhatCannotDrawThemSaysSo) {
  ASSERT_EQ(shell("python3 \"" ENVMAP_SCENES "/make.py\" .").status, 0);
  for (const char* method : {"exact", "distort", "tessellate"})
    fails(2, {"render", "room-4.glb", "out.exr", "--to", "octahedral", "--size", "16", "--method", method},
          {method, "resample or raycast"});
  succeeds({"render", "room-4.glb", "cast.exr", "--to", "equal-area", "--size", "32", "--method", "raycast", "--at",
            "0.3,0.2,0.1", "--ambient", "0.3", "-q"});
  succeeds({"render", "room-4.glb", "auto.exr", "--to", "equal-area", "--size", "32", "--at", "0.3,0.2,0.1",
            "--ambient", "0.3", "-q"});
  const Result r = envmap({"compare", "auto.exr", "cast.exr", "--max-rms", "0.1"});
  EXPECT_EQ(r.status, 0) << r.out << r.err;
  fails(2, {"view", "room-4.glb", "out.png", "--maps", "octahedral"}, {"octahedral"});
}

}  // namespace
}  // namespace command_tests::octahedral_test

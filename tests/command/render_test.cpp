// envmap render as its users run it.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "on_processor.h"
#include "picture.h"
#include "run.h"

namespace command_tests::render_test {
namespace {

class Render : public CommandTest {
 protected:
  // A tetrahedron round the origin.
  Render() { write("scene.obj", "v 1 1 1\nv -1 -1 1\nv -1 1 -1\nv 1 -1 -1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n"); }
};

TEST_F(Render, AFileAFrame) {
  ASSERT_EQ(envmap({"render", "scene.obj", "m_{frame}.exr", "-q", "--size", "8", "--frames", "9:10"}).status, 0);
  ASSERT_EQ(envmap({"render", "scene.obj", "n_%02d.exr", "-q", "--size", "8", "--frames", "9:10"}).status, 0);
  EXPECT_EQ(names(), (std::vector<std::string>{"m_0009.exr", "m_0010.exr", "n_09.exr", "n_10.exr", "scene.obj"}));
}

// One run draws what three do.
TEST_F(Render, AFileAPlace) {
  const std::vector<std::string> cast{"-q", "--method", "raycast", "--ambient", "1", "--size", "8"};
  const auto render = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "render");
    words.insert(words.end(), cast.begin(), cast.end());
    return words;
  };
  const std::vector<std::string> places{"0,0,0", "0.1,0.2,0", "-0.2,0,0.1"};
  std::vector<std::string> all{"scene.obj", "{at}_{index}.exr"};
  for (const std::string& place : places) all.push_back("--at=" + place);
  succeeds(render(all));
  for (std::size_t k = 0; k < places.size(); ++k) {
    succeeds(render({"scene.obj", "alone.exr", "--at=" + places[k]}));
    EXPECT_EQ(read("alone.exr"), read(places[k] + "_" + std::to_string(k) + ".exr")) << places[k];
  }
  fails(2, render({"scene.obj", "a.exr", "--at", "0,0,0", "--at", "1,0,0"}), {"must contain {at} or {index}"});
  fails(2, render({"scene.obj", "{at}.exr", "--at", "0,0,0", "--at", "0,0,0"}), {"two places have this name"});
  fails(2, render({"scene.obj", "{at}.exr"}), {"go with --at"});
  fails(2, render({"scene.obj", "{index}.exr", "--at", "0,0,0", "--at", "nobody"}), {"'nobody' is neither a node"});
  const std::vector<std::string> left = names();
  EXPECT_EQ(std::ranges::find(left, "0.exr"), left.end());
}

TEST_F(Render, PlacesAndFramesTogether) {
  succeeds({"render", "scene.obj", "m_{index}_{frame}.exr", "-q", "--size", "8", "--method", "raycast", "--ambient",
            "1", "--frames", "1:2", "--at", "0,0,0", "--at", "0,0.1,0"});
  EXPECT_EQ(names(),
            (std::vector<std::string>{"m_0_0001.exr", "m_0_0002.exr", "m_1_0001.exr", "m_1_0002.exr", "scene.obj"}));
}

TEST_F(Render, GridsOfLight) {
  const Result run =
      envmap({"render", "scene.obj", "grid.json", "--ambient", "1", "--grid", "2,3,1", "--size", "8", "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  const nlohmann::json report = nlohmann::json::parse(run.out), grid = nlohmann::json::parse(read("grid.json"));
  EXPECT_EQ(grid["cells"], (nlohmann::json{2, 3, 1}));
  EXPECT_EQ(grid["coefficients"].size(), 6U);
  EXPECT_EQ(report["grid"]["error"]["rms"], grid["error"]["rms"]);
  EXPECT_NE(run.err.find("error against rays at "), std::string::npos) << run.err;
  succeeds({"render", "scene.obj", "grid.ktx2", "-q", "--ambient", "1", "--grid", "2,3,1", "--size", "8"});
  EXPECT_EQ(read("grid.ktx2").substr(1, 6), "KTX 20");
  fails(2, {"render", "scene.obj", "grid.exr", "--grid", "2,3,1"}, {".json"});
  fails(2, {"render", "scene.obj", "grid.json", "--grid", "2,3"}, {"--grid", "three whole numbers"});
  fails(2, {"render", "scene.obj", "grid.json", "--grid", "2,3,0"}, {"--grid", "three whole numbers"});
  fails(2, {"render", "scene.obj", "grid.json", "--grid", "2,3,1", "--to", "cube"}, {"--to", "--grid"});
  fails(2, {"render", "scene.obj", "grid.json", "--grid", "2,3,1", "--at", "0,0,0"}, {"--at", "--grid"});
  fails(2, {"render", "scene.obj", "grid.json", "--grid", "2,3,1", "--grid-low", "5,0,0"}, {"no extent along x"});
  fails(2, {"render", "scene.obj", "map.exr", "--grid-low", "5,0,0"}, {"--grid"});
}

// A map turned to +X is the map of the world, turned.
TEST_F(Render, MapsLookWhereTheyAreToldTo) {
  const std::vector<std::string> cast{"-q",     "--method", "raycast", "--ambient", "1",
                                      "--size", "16",       "--at",    "0.1,0.2,0"};
  const auto render = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "render");
    words.insert(words.end(), cast.begin(), cast.end());
    return words;
  };
  write("bright.obj", "v 1 1 1\nv -1 -1 1\nv -1 1 -1\nf 1 2 3\nf 1 3 2\n");
  for (const std::string wrong : {"-1", "1e39", "0,-1,0"})
    fails(2, {"render", "bright.obj", "dark.exr", "--ambient", wrong}, {"--ambient must be finite and at least 0"});
  succeeds(render({"bright.obj", "world.exr"}));
  succeeds(render({"bright.obj", "turned.exr", "--forward", "1,0,0"}));
  succeeds({"convert", "world.exr", "expected.exr", "--rotate=-90,0,0", "--to", "cube"});
  EXPECT_EQ(envmap({"compare", "turned.exr", "expected.exr", "--max-error", "1e-6"}).status, 0);
  EXPECT_EQ(envmap({"compare", "turned.exr", "world.exr", "--max-error", "1e-6"}).status, 1);
  fails(2, render({"bright.obj", "a.exr", "--forward", "+x"}), {"--forward", "latlong"});
  fails(2, render({"bright.obj", "a.exr", "--forward", "camera"}), {"no camera"});
  fails(2, render({"bright.obj", "a.exr", "--forward", "Nobody"}), {"Nobody"});
  fails(2, render({"bright.obj", "a.exr", "--epsilon", "0.1"}), {"--epsilon", "distort"});
}

TEST_F(Render, SaysThatNothingIsInSight) {
  const auto said = [&](const std::string& at) {
    return envmap(
               {"render", "scene.obj", "out.exr", "--method", "raycast", "--ambient", "1", "--size", "8", "--at", at})
        .err;
  };
  EXPECT_EQ(said("0,0,0"), "");
  EXPECT_EQ(said("5000,0,0"),
            "out.exr: is black: no texel shows a lit surface within 1000 m: change --at, raise --far or use "
            "--environment MAP\n");
}

// Along d a wall of the box [-1,1]^3 is as far away as the nearest of the three planes ahead. Of a cube in a column,
// and of a latlong map; cross and row hold the same.
TEST_F(Render, DistancesAreThoseOfTheWalls) {
  write("box.obj",
        "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
        "f 1 2 3 4\nf 5 6 7 8\nf 1 2 6 5\nf 4 3 7 8\nf 1 4 8 5\nf 2 3 7 6\n");
  const double at[] = {0.1, 0.2, -0.3};
  const auto wall = [&](const Vec& d) {
    double nearest = 1e9;
    for (std::size_t k = 0; k < 3; ++k)
      if (d[k] != 0) nearest = std::min(nearest, ((d[k] > 0 ? 1 : -1) - at[k]) / d[k]);
    return nearest * std::hypot(d[0], d[1], d[2]);
  };
  constexpr int n = 16;
  const auto on_face = [](int face, double s, double t) {
    const Vec all[] = {{1, t, s}, {-1, t, -s}, {s, 1, t}, {s, -1, -t}, {-s, t, 1}, {s, t, -1}};
    return all[face];
  };
  const std::vector<std::string> rays{"raycast"}, drawn{"exact", "--context", on_processor()};
  for (const auto& method : {rays, drawn}) {
    const auto distances = [&](std::vector<std::string> words) {
      words.insert(words.begin(), {"render", "box.obj", "z.exr", "--distance", "-q", "--ambient", "1", "--size",
                                   std::to_string(n), "--at", "0.1,0.2,-0.3", "--method"});
      words.insert(words.begin() + 12, method.begin(), method.end());
      succeeds(words);
      succeeds({"convert", "z.exr", "d.exr", "--channels", "Z", "--filter", "nearest", "--layout", "column"});
      return load(path("d.exr"));
    };
    const Picture cube = distances({});
    for (int j = 0; j < 6 * n; ++j)
      for (int i = 0; i < n; ++i) {
        const Vec d = on_face(j / n, (2 * i + 1.0) / n - 1, 1 - (2 * (j % n) + 1.0) / n);
        ASSERT_NEAR(cube.at(i, j)[0], wall(d), 2e-5) << method[0] << " " << i << " " << j;
      }
    succeeds({"convert", "z.exr", "near.ktx2", "--channels", "1/Z", "--depth", "half"});
    succeeds({"convert", "near.ktx2", "near.exr", "--layout", "column", "--filter", "nearest", "--depth", "float"});
    const Picture nearness = load(path("near.exr"));
    for (int k = 0; k < 6 * n * n; ++k)
      ASSERT_NEAR(nearness.at(k % n, k / n)[0] * cube.at(k % n, k / n)[0], 1, 1e-3) << method[0] << " " << k;
    for (const std::string layout : {"row", "vcross", "3x2"})
      EXPECT_EQ(distances({"--layout", layout}), cube) << layout;
  }
  succeeds({"render", "box.obj", "z.exr", "--distance", "-q", "--to", "latlong", "--size", "8", "--at", "0.1,0.2,-0.3",
            "--ambient", "1"});
  succeeds({"convert", "z.exr", "d.exr", "--channels", "Z", "--filter", "nearest", "--to", "latlong"});
  const Picture latlong = load(path("d.exr"));
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 16; ++i) {
      const double longitude = (0.5 - (i + 0.5) / 16) * 2 * M_PI, latitude = (0.5 - (j + 0.5) / 8) * M_PI;
      const double c = std::cos(latitude);
      ASSERT_NEAR(latlong.at(i, j)[0], wall({c * std::sin(longitude), std::sin(latitude), c * std::cos(longitude)}),
                  2e-5);
    }
}

TEST_F(Render, DistancesAreInfiniteWhereNothingIs) {
  write("floor.obj", "v -9 -1 -9\nv 9 -1 -9\nv 9 -1 9\nv -9 -1 9\nf 1 2 3 4\n");
  succeeds({"render", "floor.obj", "z.exr", "--distance", "-q", "--size", "8", "--ambient", "1"});
  succeeds({"render", "floor.obj", "plain.exr", "--method", "raycast", "-q", "--size", "8", "--ambient", "1"});
  succeeds({"convert", "z.exr", "rgb.exr", "--drop-channels", "--filter", "nearest", "--layout", "column"});
  EXPECT_EQ(load(path("rgb.exr")), load(path("plain.exr")));
  const auto report = nlohmann::json::parse(envmap({"info", "z.exr", "--channels", "Z", "--json"}).out);
  EXPECT_EQ(report["infinite"], 8 * 8 * 3) << "the upper half of the sides, and the top";
  const auto nearness = nlohmann::json::parse(envmap({"info", "z.exr", "--channels", "1/Z", "--json"}).out);
  EXPECT_EQ(nearness["infinite"], 0);
  EXPECT_EQ(nearness["minimum"][0], 0);
  fails(3, {"info", "z.exr", "--channels", "1/X"}, {"no channel 'X'"});
  fails(3, {"convert", "z.exr", "a.exr"}, {"channels besides R, G and B (Z)", "--drop-channels"});
  fails(2, {"render", "floor.obj", "z.hdr", "--distance"}, {"one .exr file"});
  fails(2, {"render", "floor.obj", "{face}.exr", "--distance"}, {"one .exr file"});
  fails(2, {"render", "floor.obj", "a.exr", "--distance", "--method", "distort"}, {"exact and raycast"});
  fails(2, {"render", "floor.obj", "a.exr", "--distance", "--to", "octahedral", "--context", "osmesa"}, {"--context"});
}

// All faces of the tetrahedron have two sides. Those behind the point share an edge, which holds -Z.
// A lamp 8 mm before a mirror.
TEST_F(Render, TheNearPlaneIsThatOfMirrorsToo) {
  write("small.mtl", "newmtl mirror\nPm 1\nPr 0\nnewmtl lamp\nKd 0 0 0\nKe 1 1 1\n");
  write("small.obj",
        "mtllib small.mtl\nv -.005 -.005 -.005\nv .005 -.005 -.005\nv .005 .005 -.005\nv -.005 .005 -.005\n"
        "v -.005 -.005 .003\nv .005 -.005 .003\nv .005 .005 .003\nv -.005 .005 .003\n"
        "g a\nusemtl mirror\nf 1 2 3 4\ng b\nusemtl lamp\nf 5 6 7 8\n");
  succeeds({"render", "small.obj", "m.exr", "--method", "exact", "--bounces", "1", "--near", "1e-5", "--size", "16"});
  EXPECT_NEAR(load(path("m.exr")).at(8, 5 * 16 + 8)[0], 1, 0.01);  // Of -Z.
}

TEST_F(Render, SaysWhatMovedVerticesLack) {
  const std::vector<std::string> words{"render", "scene.obj", "a.exr", "--context", on_processor(), "--ambient", "1",
                                       "--size", "32",        "--to",  "sphere",    "--json",       "--method"};
  const auto render = [&](const std::string& method) {
    std::vector<std::string> all = words;
    all.push_back(method);
    return envmap(all);
  };
  const Result distorted = render("distort"), exact = render("exact");
  ASSERT_EQ(distorted.status, 0) << distorted.err;
  EXPECT_NE(distorted.err.find(
                "a.exr: distort left out surfaces near the singularity, up to 6.3 sr: use --method exact"),
            std::string::npos)
      << distorted.err;
  EXPECT_EQ(exact.err, "");
  using nlohmann::json;
  const json map = json::parse(distorted.out)["maps"][0];
  EXPECT_EQ(map["output"], "a.exr");
  EXPECT_NEAR(map["missing_solid_angle"].get<double>(), 6.28319, 1e-3);  // Half of all directions: two faces.
  EXPECT_EQ(json::parse(exact.out)["maps"][0]["missing_solid_angle"], 0);
}

TEST_F(Render, ScenesMayComeThroughAPipe) {
  const std::string line = "\"$ENVMAP\" render -q --method raycast --ambient 1 --size 8 ";
  ASSERT_EQ(shell(line + "scene.obj a.exr").status, 0);
  ASSERT_EQ(shell("cat scene.obj | " + line + "- - >b.exr").status, 0);
  EXPECT_EQ(read("a.exr"), read("b.exr"));
  EXPECT_NE(shell("head -c 100 /dev/zero | " + line + "- c.exr").err.find("standard input: not a scene"),
            std::string::npos);
  EXPECT_NE(shell(line + "- c.exr </dev/null").err.find("standard input: is empty"), std::string::npos);
}

// Newer systems have no OSMesa: a file of its name that is no library stands for that.
TEST_F(Render, TheProcessorDrawsThroughEglWhereThereIsNoOsMesa) {
  std::filesystem::create_directory(path("none"));
  write("none/libOSMesa.so.8", "");
  const std::string line = "LIBGL_ALWAYS_SOFTWARE=1 \"$ENVMAP\" render scene.obj --ambient 1 --size 64 --method exact ";
  if (shell(line + "egl.exr -q --context egl").status != 0) GTEST_SKIP() << "no EGL";
  const Result r = shell("LD_LIBRARY_PATH=none " + line + "auto.exr -v");
  EXPECT_EQ(r.status, 0) << r.err;
  EXPECT_NE(r.err.find("EGL, llvmpipe"), std::string::npos) << r.err;
  EXPECT_EQ(read("auto.exr"), read("egl.exr"));
  if (on_processor() == std::string("egl")) return;
  succeeds({"render", "scene.obj", "osmesa.exr", "--ambient", "1", "--size", "64", "--method", "exact", "--context",
            "osmesa"});
  EXPECT_EQ(envmap({"compare", "osmesa.exr", "egl.exr", "--max-error", "1e-6"}).status, 0);
}

TEST_F(Render, AContextIsNotIgnored) {
  const std::vector<std::string> line{"render", "scene.obj", "a.exr", "--ambient", "1", "--size", "8", "-v"};
  const auto with = [&](std::vector<std::string> words) {
    words.insert(words.begin(), line.begin(), line.end());
    return envmap(words);
  };
  const std::string to = "equal-area";  // Which 'auto' leaves to rays.
  EXPECT_NE(with({"--to", to}).err.find("a.exr: raycast"), std::string::npos);
  EXPECT_NE(with({"--to", to, "--context", on_processor()}).err.find("a.exr: resample"), std::string::npos);
  fails(2, {"render", "scene.obj", "b.exr", "--method", "raycast", "--context", "egl"}, {"--context", "raycast"});
  fails(2, {"view", "scene.obj", "b.png", "--method", "raycast", "--context", "osmesa"}, {"--context", "raycast"});
}

// A driver that cannot be loaded, such as that of a system with a newer libc under the portable archive.
TEST_F(Render, ADriverThatDoesNotLoadIsPassedOver) {
  const std::string line = "\"$ENVMAP\" render scene.obj --ambient 1 --size 8 --method exact ";
  if (shell(line + "a.exr -q --context osmesa").status != 0) GTEST_SKIP() << "no OSMesa";
  write("libEGL.so.1", "");
  const Result r = shell("LD_LIBRARY_PATH=. " + line + "b.exr");
  EXPECT_EQ(r.status, 0);
  EXPECT_NE(r.err.find("the graphics card does not draw: EGL (./libEGL.so.1: file too short)"), std::string::npos)
      << r.err;
  EXPECT_EQ(shell("LD_LIBRARY_PATH=. " + line + "c.exr -q").err, "");
}

TEST_F(Render, NoRenderer) {
  // What stands before the system's libraries and is none.
  write("libEGL.so.1", "");
  write("libOSMesa.so.8", "");
  for (const std::string context : {"egl", "osmesa", "auto"}) {
    const Result r = shell("LD_LIBRARY_PATH=. \"$ENVMAP\" render scene.obj a.exr --method exact --context " + context);
    EXPECT_EQ(r.status, 5) << r.err;
    EXPECT_EQ(r.err.rfind("envmap render: no context through ", 0), 0U) << r.err;
    EXPECT_NE(r.err.find(": install "), std::string::npos) << r.err;
    EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1);
  }
  const Result version = shell("LD_LIBRARY_PATH=. \"$ENVMAP\" --version");
  EXPECT_EQ(version.status, 0);
  EXPECT_NE(version.out.find("draws with raycast alone: no context through "), std::string::npos) << version.out;
  EXPECT_EQ(names(), (std::vector<std::string>{"libEGL.so.1", "libOSMesa.so.8", "scene.obj"}));
}

TEST_F(Render, WhatMakesNoSense) {
  fails(2, {"render", "scene.obj", "a.exr", "--at", "Nobody"}, {"Nobody", "scene.obj"});
  fails(2, {"render", "scene.obj", "a.exr", "--near", "5", "--far", "1"}, {"--near"});
  fails(2, {"render", "scene.obj", "a.exr", "--method", "distort", "--to", "latlong"}, {"latlong"});
  fails(2, {"render", "scene.obj", "a.exr", "--frames", "1:2"}, {"{frame}"});
  fails(2, {"render", "scene.obj", "a{frame}.exr", "--frames", "2:1"}, {"2:1"});
  fails(2, {"render", "scene.obj", "a.exr", "--forward", "+x"}, {"--forward"});
  fails(2, {"render", "scene.obj", "a.exr", "--size", "65536", "--method", "exact", "--context", on_processor()},
        {"65536"});
  fails(3, {"render", "nothing.glb", "a.exr"}, {"nothing.glb"});
}

}  // namespace
}  // namespace command_tests::render_test

// envmap view as its users run it.
#include <cmath>
#include <nlohmann/json.hpp>

#include "on_processor.h"
#include "picture.h"
#include "run.h"

namespace command_tests::view_test {
namespace {

class View : public CommandTest {
 protected:
  // A mirror in the plane z = 0, a camera before it, and something bright behind the camera.
  View() {
    write("scene.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1,2]}],
      "nodes":[{"name":"mirror","mesh":0},{"name":"eye","camera":0,"translation":[0,0,3]},
               {"name":"lamp","mesh":1,"translation":[0,0,6],"rotation":[0,1,0,0]}],
      "cameras":[{"name":"front","type":"perspective","perspective":{"yfov":0.6,"znear":0.1}}],
      "materials":[{"pbrMetallicRoughness":{"metallicFactor":1,"roughnessFactor":0}},
                   {"emissiveFactor":[1,0.5,0.25],"pbrMetallicRoughness":{"baseColorFactor":[0,0,0,1]}}],
      "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]},
                {"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":1}]}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[-1,-1,0],"max":[1,1,0]},
                   {"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}],
      "bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],
      "buffers":[{"byteLength":60,"uri":"data:application/octet-stream;base64,)" +
                            quad + R"("}]})");
  }
  // The mirror as a rough metal.
  void write_rough(const std::string& roughness) {
    std::string scene = read("scene.gltf");
    const std::string smooth = "\"roughnessFactor\":0";
    ASSERT_NE(scene.find(smooth), std::string::npos);
    write("rough.gltf", scene.replace(scene.find(smooth), smooth.size(), "\"roughnessFactor\":" + roughness));
  }
  void write_orthographic() {
    std::string text = read("scene.gltf");
    const std::string from = R"("type":"perspective","perspective":{"yfov":0.6,"znear":0.1})";
    ASSERT_NE(text.find(from), std::string::npos);
    write("orthographic.gltf",
          text.replace(text.find(from), from.size(),
                       R"("type":"orthographic","orthographic":{"xmag":2,"ymag":2,"znear":0.1,"zfar":50})"));
  }
  // A metal of roughness .5, seen at 75 degrees from its normal, under a sun in the mirrored direction.
  void write_grazing_scene(const std::string& sun_size) {
    write_rough("0.5");
    succeeds({"generate", "sun", "sun.exr", "--size", sun_size, "--radius", "2.5", "--value", "100", "--direction",
              "-0.966,0,0.259"});
  }
  [[nodiscard]] static std::vector<std::string> grazing_view(const std::vector<std::string>& more) {
    std::vector<std::string> words{"view",     "rough.gltf",    "a.exr",     "--environment", "sun.exr",
                                   "--camera", "2.898,0,0.776", "--look-at", "0,0,0",         "--fov",
                                   "2",        "--width",       "9",         "--height",      "9"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  static const std::string quad;
};
// (-1,-1,0) (1,-1,0) (1,1,0) (-1,1,0), and 0 1 2 0 2 3.
const std::string View::quad = "AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAACAPwAAgD8AAAAAAACAvwAAgD8AAAAAAAABAAIAAAACAAMA";

// Pixels that show the lamp in the mirror, and others that show nothing. The lamp of 2 x 2 m at z = 6 is seen as if it
// hung at -6, 9 m from the camera: to 11.5 of 64 pixels from the middle. Of the 4 x 4 m that an orthographic camera
// sees, the mirror takes the middle half.
struct Shown {
  const char* options;
  int size;
  std::vector<std::pair<int, int>> lit, dark;
};
const Shown pictures[] = {
    {"scene.gltf --maps sphere", 32, {{16, 16}}, {{1, 1}}},
    {"scene.gltf --maps paraboloid", 32, {{16, 16}}, {{1, 1}}},
    {"scene.gltf --maps cube", 32, {{16, 16}}, {{1, 1}}},
    {"scene.gltf --method raycast",
     64,
     {{32, 32}, {42, 42}, {21, 21}, {42, 32}},
     {{44, 32}, {32, 44}, {19, 32}, {1, 1}}},
    {"scene.gltf --method raycast --bounces 5", 64, {{42, 42}, {21, 21}}, {{44, 32}, {19, 32}}},
    {"orthographic.gltf --method maps", 16, {{11, 8}, {4, 4}, {8, 11}}, {{12, 8}, {3, 4}, {8, 12}}},
    {"orthographic.gltf --method raycast", 16, {{11, 8}, {4, 4}, {8, 11}}, {{12, 8}, {3, 4}, {8, 12}}},
    {"scene.gltf --method maps --mirror mirror:off", 16, {}, {{8, 8}}},
    {"scene.gltf --method raycast --mirror mirror:off", 16, {}, {{8, 8}}},
};

TEST_F(View, AMirrorShowsTheLampBehindTheCameraInItsPlace) {
  write_orthographic();
  for (const Shown& shown : pictures) {
    SCOPED_TRACE(shown.options);
    const std::string size = std::to_string(shown.size), options = shown.options;
    const std::size_t name_ends = options.find(' ');
    const Result r = envmap(split("view " + options.substr(0, name_ends) + " a.exr -v --samples 1 --width " + size +
                                  " --height " + size + options.substr(name_ends)));
    ASSERT_EQ(r.status, 0) << r.err;
    if (const std::size_t maps = options.find("--maps "); maps != options.npos) {
      EXPECT_NE(r.err.find("mirror: " + options.substr(maps + 7)), std::string::npos) << r.err;
    }
    const Picture picture = load(path("a.exr"));
    for (const auto& [x, y] : shown.lit)
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(picture.at(x, y)[c], std::ldexp(1.0, -c), 0.02) << x << ' ' << y;
    for (const auto& [x, y] : shown.dark) EXPECT_NEAR(picture.at(x, y)[0], 0, 0.02) << x << ' ' << y;
  }
}

// The limit of a picture counts rough surfaces where the rays that judge it have the integral.
TEST_F(View, MaxErrorIncludesRoughSurfacesByTheIntegral) {
  write_grazing_scene("64");
  const auto error = [&](const std::vector<std::string>& more) {
    const Result run = envmap(grazing_view(more));
    EXPECT_EQ(run.status, 0) << run.err;
    const std::size_t at = run.err.find("off by ");
    return at == std::string::npos ? 0.0 : std::stod(run.err.substr(at + 7));
  };
  EXPECT_GT(error({"--max-error", "0.9", "--lobe-samples", "256"}), 0.3);
  EXPECT_LT(error({"--max-error", "0.9", "--lobe-samples", "256", "--reflection", "sampled"}), 0.1);
  // Beyond the limit the picture is that of the rays.
  EXPECT_GT(error({"--max-error", "0.1", "--lobe-samples", "256"}), 0.3);
  const std::string drawn = read("a.exr");
  error({"--method", "raycast", "--lobe-samples", "256"});
  EXPECT_EQ(drawn, read("a.exr"));
}

TEST_F(View, RoughReflectionsCanBeSampledAtGrazingAngles) {
  write_grazing_scene("128");
  const auto middle = [&](const std::vector<std::string>& more) {
    succeeds(grazing_view(more));
    return load(path("a.exr")).at(4, 4)[0];
  };
  const float integral = middle({"--method", "raycast", "--lobe-samples", "4096"});
  EXPECT_NEAR(middle({"--reflection", "sampled"}) / integral, 1, 0.1);
  EXPECT_NEAR(middle({"--reflection", "sampled", "--method", "raycast"}) / integral, 1, 0.1);
  EXPECT_LT(middle({}) / integral, 0.7);
  for (const std::string to : {"split-sum", "sampled"})
    succeeds({"view", "scene.gltf", to + ".png", "--environment", "sun.exr", "--reflection", to, "--width", "48",
              "--height", "48"});
  EXPECT_EQ(read("split-sum.png"), read("sampled.png"));  // Mirrors have no lobe.
}

// The scene's camera stands at (0,0,3) and looks at the origin.
TEST_F(View, APointIsAsGoodAsACamera) {
  const auto view = [&](const std::string& to, std::vector<std::string> words) {
    words.insert(words.begin(), {"view", "scene.gltf", to, "-q", "--width", "48", "--height", "48", "--samples", "1"});
    succeeds(words);
  };
  view("a.exr", {"--camera", "front"});
  view("b.exr", {"--camera", "0,0,3", "--look-at", "0,0,0", "--fov", "34.37746770784939"});
  EXPECT_EQ(envmap({"compare", "a.exr", "b.exr", "--from", "sphere", "--max-error", "1e-3"}).status, 0);
  // Half an orbit ends where a camera on the other side would stand; its second frame is a quarter on, towards +X.
  view("o{frame}.exr", {"--frames", "0:1", "--orbit", "180", "--look-at", "0,0,1"});
  view("c.exr", {"--camera", "2,0,1", "--look-at", "0,0,1", "--fov", "34.37746770784939"});
  EXPECT_EQ(envmap({"compare", "o0001.exr", "c.exr", "--from", "sphere", "--max-error", "1e-3"}).status, 0);
  EXPECT_NE(envmap({"compare", "o0000.exr", "c.exr", "--from", "sphere", "--max-error", "1e-3"}).status, 0);
}

// A bright square of 2 x 2 in the plane z = 0: all of it lies within the picture, and it fills a good part of it.
TEST_F(View, ASceneWithoutACameraIsSeenWhole) {
  std::string scene = read("scene.gltf");
  const auto replace = [&](const std::string& what, const std::string& by) {
    const auto at = scene.find(what);
    ASSERT_NE(at, std::string::npos) << what;
    scene.replace(at, what.size(), by);
  };
  replace(R"("nodes":[0,1,2])", R"("nodes":[2])");
  replace(R"("camera":0,)", "");
  replace(R"("translation":[0,0,6],"rotation":[0,1,0,0])", R"("translation":[5,0,6])");
  write("whole.gltf", scene);
  for (const auto& [width, height] : {std::pair{64, 64}, {96, 32}, {32, 96}}) {
    const Result r =
        envmap({"view", "whole.gltf", "w.exr", "--width", std::to_string(width), "--height", std::to_string(height)});
    ASSERT_EQ(r.status, 0) << r.err;
    EXPECT_NE(r.err.find("no camera"), std::string::npos) << r.err;
    const Picture picture = load(path("w.exr"));
    int lit = 0;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const bool bright = picture.at(x, y)[0] > 0.01;
        lit += bright;
        const bool rim = x == 0 || y == 0 || x == width - 1 || y == height - 1;
        EXPECT_FALSE(rim && bright) << x << ", " << y;
      }
    const double least = std::min(width, height);
    EXPECT_GT(lit, 0.25 * least * least);
    EXPECT_GT(picture.at(width / 2, height / 2)[0], 0.9);
  }
}

TEST_F(View, OfASceneWithoutLightSaysSo) {
  write("dark.obj", "v 1 1 1\nv -1 -1 1\nv -1 1 -1\nf 1 2 3\n");
  const std::vector<std::string> words{"view", "dark.obj", "d.png", "--width", "8", "--height", "8"};
  EXPECT_NE(envmap(words).err.find("--environment"), std::string::npos);
  std::vector<std::string> lit = words;
  lit.insert(lit.end(), {"--ambient", "1"});
  EXPECT_EQ(envmap(lit).err.find("--environment"), std::string::npos);
}

TEST_F(View, StreamsAreAsGoodAsFilesAndAllMapsAsThoseNeeded) {
  ASSERT_EQ(envmap({"view", "scene.gltf", "a.png", "--width", "8", "--height", "8"}).status, 0);
  ASSERT_EQ(envmap({"view", "scene.gltf", "all.png", "--all", "--width", "8", "--height", "8"}).status, 0);
  EXPECT_EQ(read("a.png"), read("all.png"));
  ASSERT_EQ(shell("cat scene.gltf | \"$ENVMAP\" view - - --width 8 --height 8 >b.png").status, 0);
  EXPECT_EQ(read("a.png"), read("b.png"));
  ASSERT_EQ(shell("\"$ENVMAP\" view scene.gltf - --format hdr --width 8 --height 8 | \"$ENVMAP\" info - --from sphere")
                .status,
            0);
}

TEST_F(View, FramesAndEyes) {
  const std::vector<std::string> small{"-q", "--width", "8", "--height", "8"};
  const auto run = [&](std::vector<std::string> words) {
    words.insert(words.end(), small.begin(), small.end());
    return envmap(words).status;
  };
  EXPECT_EQ(run({"view", "scene.gltf", "f{frame}.png", "--frames", "0:1"}), 0);
  EXPECT_EQ(run({"view", "scene.gltf", "e.jpg", "--anaglyph", "0.1"}), 0);
  EXPECT_EQ(run({"view", "scene.gltf", "t.hdr", "--show-maps", "--lookup", "vertex", "--mirror", "lamp:sphere"}), 0);
  EXPECT_EQ(names(), (std::vector<std::string>{"e.jpg", "f0000.png", "f0001.png", "scene.gltf", "t.hdr"}));
}

TEST_F(View, EachEyeHasItsFileBesideTheAnaglyph) {
  succeeds({"view", "scene.gltf", "{eye}.exr", "-q", "--anaglyph", "0.3", "--width", "16", "--height", "12",
            "--samples", "1"});
  EXPECT_EQ(names(), (std::vector<std::string>{"both.exr", "left.exr", "right.exr", "scene.gltf"}));
  const Picture left = load(path("left.exr")), right = load(path("right.exr")), both = load(path("both.exr"));
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 16; ++x) {
      EXPECT_EQ(both.at(x, y)[0], left.at(x, y)[0]);
      EXPECT_EQ(both.at(x, y)[1], right.at(x, y)[1]);
      EXPECT_EQ(both.at(x, y)[2], right.at(x, y)[2]);
    }
  EXPECT_NE(read("left.exr"), read("right.exr"));
}

TEST_F(View, SideBySideHoldsBothEyes) {
  succeeds({"view", "scene.gltf", "{eye}.exr", "-q", "--side-by-side", "0.3", "--width", "16", "--height", "12",
            "--samples", "1"});
  const Picture left = load(path("left.exr")), right = load(path("right.exr")), both = load(path("both.exr"));
  EXPECT_EQ(both.width, 32);
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 16; ++x)
      for (int c = 0; c < 3; ++c) {
        EXPECT_EQ(both.at(x, y)[c], left.at(x, y)[c]);
        EXPECT_EQ(both.at(x + 16, y)[c], right.at(x, y)[c]);
      }
  EXPECT_NE(read("left.exr"), read("right.exr"));
}

TEST_F(View, MapsOfMirrorsAreSavedInAnyFormat) {
  succeeds({"view", "scene.gltf", "a.png", "-q", "--width", "16", "--height", "12", "--save-maps", "maps", "--maps",
            "cube", "--all", "--map-format", "ktx2"});
  succeeds({"info", "maps/mirror.ktx2"});
  fails(2, {"view", "scene.gltf", "a.png", "--save-maps", "maps", "--map-format", "xyz"}, {"xyz"});
}

TEST_F(View, TextureFiltersAreForRays) {
  succeeds({"view", "scene.gltf", "a.png", "-q", "--width", "8", "--height", "8", "--method", "raycast",
            "--texture-filter", "ewa"});
  fails(2, {"view", "scene.gltf", "a.png", "--texture-filter", "ewa"}, {"--texture-filter", "--method raycast"});
  fails(2, {"render", "scene.gltf", "a.exr", "--texture-filter", "ewa"}, {"--texture-filter", "--method raycast"});
}

// The lamp stands in direction +Z of the mirror: in the middle of the front half.
TEST_F(View, MapsAreSaved) {
  std::filesystem::create_directory(path("maps"));
  const std::vector<std::string> small{"view", "scene.gltf", "a.exr", "-q",        "--width",
                                       "16",   "--height",   "12",    "--samples", "1"};
  const auto with = [&](std::vector<std::string> words) {
    words.insert(words.begin(), small.begin(), small.end());
    return words;
  };
  succeeds(with({"--save-maps", "maps", "--size", "32"}));
  EXPECT_NEAR(load(path("maps/mirror.exr")).at(16, 16)[1], 0.5, 1e-3);
  EXPECT_NEAR(load(path("a.exr")).at(8, 6)[1], 0.5, 0.02);
  succeeds(with({"--save-maps", "new/maps", "--size", "32"}));
  EXPECT_EQ(read("new/maps/mirror.exr"), read("maps/mirror.exr"));
}

TEST_F(View, SavedMapsReplaceNeitherInputsNorOutputs) {
  succeeds({"generate", "checker", "mirror.exr", "--size", "8"});
  fails(2, {"view", "scene.gltf", "a.exr", "--environment", "mirror.exr", "--save-maps", "."},
        {"mirror.exr", "both input and output"});
  fails(2, {"view", "scene.gltf", "mirror.exr", "--save-maps", "."}, {"mirror.exr", "written twice"});
  fails(2, {"view", "scene.gltf", "mirror.{frame}.exr", "--save-maps", ".", "--frames", "0:1"}, {"written twice"});
}

// In the box [-1,1]^3, along d, the wall is as far from the ball as the nearest of the three planes ahead. The other
// projections are turned towards the camera: their distances are interpolated, but for the edges of the box.
TEST_F(View, SavedMapsHaveTheDistancesOfTheWalls) {
  write("box.obj",
        "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
        "g walls\nf 1 2 3 4\nf 5 6 7 8\nf 1 2 6 5\nf 4 3 7 8\nf 1 4 8 5\nf 2 3 7 6\n"
        "v .15 .2 -.3\nv .05 .2 -.3\nv .1 .25 -.3\nv .1 .15 -.3\nv .1 .2 -.25\nv .1 .2 -.35\n"
        "g ball\nf 9 11 13\nf 11 10 13\nf 10 12 13\nf 12 9 13\nf 11 9 14\nf 10 11 14\nf 12 10 14\nf 9 12 14\n");
  std::filesystem::create_directory(path("maps"));
  const std::vector<std::string> line{"view",      "box.obj",      "a.exr",        "-q",          "--ambient",
                                      "1",         "--context",    on_processor(), "--camera",    "0.8,0.7,0.9",
                                      "--look-at", "0.1,0.2,-0.3", "--width",      "16",          "--height",
                                      "12",        "--mirror",     "ball",         "--save-maps", "maps"};
  const auto with = [&](std::vector<std::string> words) {
    words.insert(words.begin(), line.begin(), line.end());
    return words;
  };
  const auto distances = [&](const std::string& maps, int size) {
    succeeds(with({"--distance", "--all", "--size", std::to_string(size), "--maps", maps}));
    succeeds({"convert", "maps/ball.exr", "d.exr", "--channels", "Z", "--filter", "nearest", "--to", "cube", "--layout",
              "column", "--size", "16"});
    return load(path("d.exr"));
  };
  const auto worst = [&](const Picture& cube) {
    double off = 0;
    for (int j = 0; j < 6 * 16; ++j)
      for (int i = 0; i < 16; ++i) {
        const double s = (2 * i + 1.0) / 16 - 1, t = 1 - (2 * (j % 16) + 1.0) / 16;
        const Vec all[] = {{1, t, s}, {-1, t, -s}, {s, 1, t}, {s, -1, -t}, {-s, t, 1}, {s, t, -1}};
        const Vec &d = all[j / 16], at{0.1, 0.2, -0.3};
        double nearest = 1e9;
        for (std::size_t k = 0; k < 3; ++k) nearest = std::min(nearest, ((d[k] > 0 ? 1 : -1) - at[k]) / d[k]);
        off = std::max(off, std::abs(cube.at(i, j)[0] / (nearest * std::hypot(d[0], d[1], d[2])) - 1));
      }
    return off;
  };
  EXPECT_LT(worst(distances("cube", 16)), 2e-5);
  EXPECT_LT(worst(distances("paraboloid", 128)), 0.03);
  EXPECT_LT(worst(distances("sphere", 256)), 0.03);
  EXPECT_NE(envmap({"info", "maps/ball.exr", "--drop-channels"}).out.find("0.1,0.2,-0.3"), std::string::npos);
}

// The figure is that of the files; what it took is what the words say;
// and where no maps will do the picture is that of rays.
TEST_F(View, MaxErrorTakesTheCheapestMapsThatDoOrRays) {
  // A pane of glass: a flat mirror would be shown without a map.
  std::string scene = read("scene.gltf");
  const std::string metal = R"({"pbrMetallicRoughness":{"metallicFactor":1,"roughnessFactor":0}})";
  ASSERT_NE(scene.find(metal), std::string::npos);
  write("scene.gltf", scene.replace(scene.find(metal), metal.size(),
                                    R"({"pbrMetallicRoughness":{"metallicFactor":0,"roughnessFactor":0},
    "extensions":{"KHR_materials_transmission":{"transmissionFactor":1}}})"));
  const std::vector<std::string> size{"--width", "48", "--height", "40", "--samples", "1"};
  const auto view = [&](const std::string& out, std::vector<std::string> more) {
    more.insert(more.begin(), {"view", "scene.gltf", out});
    more.insert(more.end(), size.begin(), size.end());
    return envmap(more);
  };
  ASSERT_EQ(view("rays.exr", {"--method", "raycast"}).status, 0);
  const Result loose = view("loose.exr", {"--max-error", "0.5"});
  ASSERT_EQ(loose.status, 0) << loose.err;
  const Picture picture = load(path("loose.exr")), rays = load(path("rays.exr"));
  double off = 0, all = 0;
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 48; ++x)
      for (int c = 0; c < 3; ++c) {
        off += std::pow(double(picture.at(x, y)[c]) - rays.at(x, y)[c], 2);
        all += std::pow(rays.at(x, y)[c], 2);
      }
  const std::size_t at = loose.err.find("off by ");
  ASSERT_NE(at, std::string::npos) << loose.err;
  EXPECT_NEAR(std::stod(loose.err.substr(at + 7)), std::sqrt(off / all), 0.005 + 0.05 * std::sqrt(off / all));
  EXPECT_LE(std::sqrt(off / all), 0.5);
  const std::size_t first = loose.err.find("--lookup"), end = loose.err.find(": off");
  ASSERT_LT(first, end) << loose.err;
  ASSERT_EQ(shell("\"$ENVMAP\" view scene.gltf again.exr --width 48 --height 40 --samples 1 " +
                  loose.err.substr(first, end - first))
                .status,
            0);
  EXPECT_EQ(read("again.exr"), read("loose.exr"));

  const Result strict = view("strict.exr", {"--max-error", "1e-6"});
  ASSERT_EQ(strict.status, 0) << strict.err;
  EXPECT_NE(strict.err.find("by rays"), std::string::npos) << strict.err;
  EXPECT_EQ(read("strict.exr"), read("rays.exr"));
  for (const std::vector<std::string>& chosen : {std::vector<std::string>{"--method", "raycast"},
                                                 {"--size", "64"},
                                                 {"--max-size", "64"},
                                                 {"--lookup", "direction"},
                                                 {"--bounces", "1"},
                                                 {"--save-maps", "."}}) {
    std::vector<std::string> line{"--max-error", "0.5"};
    line.insert(line.end(), chosen.begin(), chosen.end());
    EXPECT_EQ(view("no.exr", line).status, 2) << chosen[0];
  }
}

// The lamp shrinks by a morph target, from a size at which the mirror shows nothing else.
TEST_F(View, ErrorsAreThoseOfTheMomentsWithTheirVertices) {
  std::string scene = read("scene.gltf");
  const auto put = [&](const std::string& before, const std::string& more) {
    ASSERT_NE(scene.rfind(before), std::string::npos);
    scene.insert(scene.rfind(before) + before.size(), more);
  };
  put(R"("material":1)", R"(,"targets":[{"POSITION":0}])");
  put(R"("type":"SCALAR"})",
      R"(,{"bufferView":2,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[1]},
          {"bufferView":3,"componentType":5126,"count":2,"type":"SCALAR"})");
  put(R"("byteLength":12})", R"(,{"buffer":1,"byteLength":8},{"buffer":2,"byteLength":8})");
  const std::string numbers = R"(,{"byteLength":8,"uri":"data:application/octet-stream;base64,)";
  put(quad + "\"}", numbers + "AAAAAAAAgD8=\"}" + numbers + "AACAPwAAAAA=\"}");  // 0 and 1; 1 and 0.
  put(R"("scene":0,)", R"("animations":[{"channels":[{"sampler":0,"target":{"node":2,"path":"weights"}}],
                                         "samplers":[{"input":2,"output":3}]}],)");
  write("morph.gltf", scene);
  const auto error = [&](const std::string& option, const std::string& value) {
    const Result r = envmap(
        {"view", "morph.gltf", "o{frame}.exr", "--width", "48", "--height", "40", "--max-error", "0.9", option, value});
    const std::size_t at = r.err.find("off by ");
    return at == std::string::npos ? -1 : std::stod(r.err.substr(at + 7));
  };
  const double first = error("--frames", "0:0"), last = error("--frames", "24:24");
  EXPECT_GE(first, 0);
  EXPECT_LT(first, 0.1 * last);
  EXPECT_EQ(error("--frames", "0:24"), last);
}

TEST_F(View, RefusesNamesOfTwoNodes) {
  std::string scene = read("scene.gltf");
  scene.replace(scene.find("lamp"), 4, "mirror");
  write("twins.gltf", scene);
  fails(2, {"view", "twins.gltf", "a.png", "--mirror", "mirror"}, {"2 nodes", "'mirror'"});
  fails(2, {"render", "twins.gltf", "a.exr", "--at", "mirror"}, {"2 nodes", "'mirror'"});
}

TEST_F(View, WhatMakesNoSense) {
  succeeds({"generate", "sky", "sky.exr", "--size", "4"});
  const std::pair<const char*, std::vector<std::string>> refused[] = {
      {"a.png --camera Nobody", {"Nobody", "front", "X,Y,Z"}},
      {"a.png --camera 1,2,3 --look-at 1,2,3", {"look at"}},
      {"a.png --mirror Nobody", {"Nobody", "the scene's nodes are mirror, eye, lamp"}},
      {"a.png --mirror eye", {"eye", "no triangles"}},
      {"a.png --mirror lamp:latlong", {"lamp:latlong"}},
      {"a.txt", {"a.txt"}},
      {"a.png --frames 1:2", {"{frame}"}},
      {"{frame}.png --frames 0:999999999", {"--frames", "1000000 frames"}},
      {"{eye}.png", {"{eye}", "--anaglyph"}},
      {"a.png --anaglyph 0.1 --side-by-side 0.1", {"--anaglyph", "--side-by-side"}},
      {"a.png --maps latlong", {"latlong"}},
      {"a.exr --display reinhard", {"a.exr", "--display"}},
      {"a.exr --save-maps scene.gltf", {"scene.gltf", "not a folder"}},
      {"a.exr --distance", {"--distance", "--save-maps"}},
      {"a.exr --lobe-samples 64", {"--lobe-samples", "--method raycast"}},
      {"a.exr --environment sky.exr --method raycast --reflection sampled --lobe-samples 64",
       {"--lobe-samples", "--reflection"}},
      {"a.png --method raycast --maps=cube", {"--method raycast", "--lookup"}},
      {"a.png --method raycast --size=64", {"--method raycast", "--lookup"}},
      {"a.png --method raycast --show-maps", {"--method raycast", "--lookup"}},
      {"a.png --method raycast --lookup=vertex", {"--method raycast", "--lookup"}},
      {"a.png --method raycast --all", {"--method raycast", "--lookup"}},
      {"a.png --method raycast --mirror=lamp:sphere", {"--method raycast", "--lookup"}},
  };
  for (const auto& [line, words] : refused) fails(2, split(std::string("view scene.gltf ") + line), words);
  write_orthographic();
  fails(2, {"view", "orthographic.gltf", "a.png", "--anaglyph", "0.1"}, {"orthographic"});
  for (const char* option : {"--save-maps=maps", "--show-maps"})
    EXPECT_NE(envmap({"view", "scene.gltf", "a.png", "--width", "8", "--height", "8", "--mirror", "mirror:off", option})
                  .err.find("scene.gltf: has no mirrors"),
              std::string::npos);
  fails(4, {"view", "scene.gltf", "nowhere/a.png", "--width", "8", "--height", "8"}, {"nowhere"});
}

// A floor under a sun: the light of the map by --suns, and that of the file of `lights --gltf` under the remainder.
TEST_F(View, SunsLightAsTheirTexelsDidAndAsTheGltfFileHasThem) {
  succeeds({"generate", "sun", "sun.exr", "--to", "latlong", "--size", "256", "--radius", "1", "--value", "10000",
            "--direction", "0.2,1,0.1", "--depth", "float", "-q"});
  succeeds({"lights", "sun.exr", "--gltf", "suns.gltf", "--remainder", "rest.exr", "-q"});
  auto floor = nlohmann::json::parse(read("scene.gltf")), lit = floor;
  floor["nodes"] = {{{"mesh", 0}, {"rotation", {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)}}, {"scale", {9, 9, 9}}}};
  floor["scenes"] = {{{"nodes", {0}}}};
  floor["materials"][0] = {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 1}}}};
  floor.erase("cameras");
  write("floor.gltf", floor.dump());
  const auto suns = nlohmann::json::parse(read("suns.gltf"));
  lit = floor;
  for (const char* key : {"extensions", "extensionsUsed"}) lit[key] = suns[key];
  lit["nodes"].push_back(suns["nodes"][0]);
  lit["scenes"][0]["nodes"].push_back(1);
  write("lit.gltf", lit.dump());
  const auto brightness = [&](const std::string& scene, const std::string& more) {
    const Result r =
        envmap(split("view " + scene + " a.exr --camera 0,2,0.1 --look-at 0,0,0 --width 9 --height 9 " + more));
    EXPECT_EQ(r.status, 0) << r.err;
    return load(path("a.exr")).at(4, 4)[1];
  };
  const double texels = brightness("floor.gltf", "--environment sun.exr --method raycast --lobe-samples 4096");
  EXPECT_NEAR(brightness("floor.gltf", "--environment sun.exr --suns --method raycast") / texels, 1, 0.02);
  EXPECT_NEAR(brightness("lit.gltf", "--environment rest.exr --method raycast") / texels, 1, 0.02);
  EXPECT_NEAR(brightness("floor.gltf", "--environment sun.exr --suns") / texels, 1, 0.02);
  EXPECT_NEAR(brightness("lit.gltf", "--environment rest.exr") / texels, 1, 0.02);
  fails(2, {"view", "floor.gltf", "a.exr", "--suns"}, {"--environment"});
  succeeds({"generate", "sky", "sky.exr", "--to", "latlong", "--size", "64", "-q"});
  const Result none = envmap({"view", "floor.gltf", "a.exr", "--environment", "sky.exr", "--suns", "--width", "8"});
  EXPECT_EQ(none.status, 0);
  EXPECT_NE(none.err.find("no light for --suns"), std::string::npos);
}

}  // namespace
}  // namespace command_tests::view_test

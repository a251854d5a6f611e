// What `tradeoff` says of methods, against what the commands themselves do.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <vector>

#include "picture.h"
#include "run.h"

namespace command_tests::tradeoff_test {
namespace {

using nlohmann::json;

class Tradeoff : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    succeeds({"generate", "sun", "in.exr", "--size", "16", "--direction", "3,2,1", "--radius", "12", "--value",
              "40,30,20", "--depth", "float"});
  }
  json trials(const std::string& task, const std::string& by = "rms") const {
    const Result r = envmap({"tradeoff", "in.exr", "--task", task, "--by", by, "--json", "--budget", "1000"});
    EXPECT_EQ(r.status, 0) << r.err;
    return json::parse(r.out)["trials"];
  }
  static json trial(const json& all, const std::string& method, const std::string& setting) {
    for (const json& t : all)
      if (t["method"] == method && t["setting"] == setting) return t;
    ADD_FAILURE() << method << " " << setting;
    return {};
  }
  // What `compare` says of two files.
  void expect_as_compared(const json& t, const std::string& file, const std::string& reference) const {
    const json compared = json::parse(envmap({"compare", file, reference, "--json"}).out);
    EXPECT_NEAR(t["rms"].get<double>(), compared["rms"].get<double>(), 1e-3 * compared["rms"].get<double>() + 1e-9);
    EXPECT_NEAR(t["max"].get<double>(), compared["max"].get<double>(), 1e-3 * compared["max"].get<double>() + 1e-9);
  }
};

TEST_F(Tradeoff, ErrorsAreThoseOfTheFilesThatConvertWrites) {
  const json all = trials("convert:cube:8");
  succeeds({"convert", "in.exr", "truth.exr", "--to", "cube", "--size", "8", "--filter", "area", "--area-error", "1e-6",
            "-q"});
  for (const std::string filter : {"nearest", "ewa"}) {
    succeeds({"convert", "in.exr", "out.exr", "--to", "cube", "--size", "8", "--filter", filter, "-q"});
    expect_as_compared(trial(all, filter, ""), "out.exr", "truth.exr");
  }
  succeeds(
      {"convert", "in.exr", "out.exr", "--to", "cube", "--size", "8", "--filter", "bilinear", "--samples", "4", "-q"});
  expect_as_compared(trial(all, "bilinear", "--samples 4"), "out.exr", "truth.exr");
}

TEST_F(Tradeoff, PrefiltersKeepToTheirError) {
  const json all = trials("ggx:0.5:cube:6", "max");
  for (const json& t : all) {
    const std::string setting = t["setting"];
    EXPECT_LE(t["max"].get<double>(), std::stod(setting.substr(setting.find(' ')))) << t;
    EXPECT_GT(t["seconds"].get<double>(), 0);
  }
}

// 512 x 256 texels are too many to be summed for 1536 directions: the tree stands in, and says how far it is off.
TEST_F(Tradeoff, OfLargeMapsTheReferenceStatesItsError) {
  succeeds({"generate", "sun", "large.exr", "--size", "256", "--radius", "12", "--value", "40,30,20"});
  const Result r = envmap({"tradeoff", "large.exr", "--task", "ggx:0.6:cube:16", "--json", "--budget", "0", "--only",
                           "treecode --max-error 0.1"});
  ASSERT_EQ(r.status, 0) << r.err;
  const json all = json::parse(r.out);
  EXPECT_NE(all["reference"]["what"].get<std::string>().find("within 1e-5"), std::string::npos) << all;
  EXPECT_LE(all["trials"][0]["max"].get<double>(), 0.1);
  const Result small = envmap({"tradeoff", "in.exr", "--task", "ggx:0.6:cube:4", "--json", "--budget", "0", "--only",
                               "treecode --max-error 0.1"});
  EXPECT_EQ(json::parse(small.out)["reference"]["what"], "--method exact");
}

TEST_F(Tradeoff, FilesAreAsLargeAsTheyAreWritten) {
  const json all = trials("depth");
  const json half = trial(all, ".exr", "--depth half --compression zip");
  succeeds({"convert", "in.exr", "half.exr", "--depth", "half", "--compression", "zip", "-q"});
  EXPECT_NEAR(half["bytes"].get<double>(), double(std::filesystem::file_size(path("half.exr"))), 400);  // Attributes.
  expect_as_compared(half, "half.exr", "in.exr");
  EXPECT_EQ(trial(all, ".ktx2", "--depth float")["max"], 0);
}

// Stars by the definition: no other is at most as dear and as far off, and better in one.
TEST_F(Tradeoff, TheFrontIsWhatNothingBeats) {
  const json all = trials("depth");
  std::size_t stars = 0;
  for (const json& t : all) {
    const bool beaten = std::ranges::any_of(all, [&](const json& o) {
      return o["bytes"] <= t["bytes"] && o["rms"] <= t["rms"] && (o["bytes"] < t["bytes"] || o["rms"] < t["rms"]);
    });
    EXPECT_FALSE(t["front"] && beaten) << t;
    stars += t["front"] ? 1 : 0;
  }
  EXPECT_GE(stars, 2U);
}

TEST_F(Tradeoff, LevelsAreThoseOfMipmap) {
  const json all = trials("mipmap:3");
  EXPECT_LT(trial(all, "levels", "--weights solid-angle")["rms"].get<double>(), 1e-6);
  for (const std::string weights : {"uniform", "solid-angle"}) {
    succeeds({"mipmap", "in.exr", weights + ".exr", "--weights", weights, "-q"});
    succeeds({"convert", weights + ".exr", weights + "-3.exr", "--level", "3", "--filter", "nearest", "-q"});
  }
  expect_as_compared(trial(all, "levels", "--weights uniform"), "uniform-3.exr", "solid-angle-3.exr");
  fails(2, {"tradeoff", "in.exr", "--task", "mipmap:9"}, {"mipmap:9"});
  succeeds({"generate", "sky", "small.exr", "--size", "2"});
  EXPECT_EQ(envmap({"tradeoff", "small.exr", "--task", "mipmap:2"}).status, 0);
  fails(2, {"tradeoff", "small.exr", "--task", "mipmap:3"}, {"mipmap:3"});
}

// As 'convert' to a smaller map and back, and 'compare', say.
TEST_F(Tradeoff, SizesAreThoseOfMapsConvertedBack) {
  const json all = trials("sizes:4,8");
  EXPECT_EQ(all.size(), 14);
  for (const std::string to : {"cube", "sphere", "equal-area"}) {
    const std::int64_t faces = to == "cube" ? 6 : 1;
    EXPECT_EQ(trial(all, to, "--size 8")["bytes"], 6 * faces * 64);
    EXPECT_LT(trial(all, to, "--size 8")["rms"], trial(all, to, "--size 4")["rms"]);
    succeeds({"convert", "in.exr", to + ".exr", "--to", to, "--size", "8", "-q"});
    succeeds({"convert", to + ".exr", to + "-back.exr", "--to", "latlong", "--size", "16", "-q"});
    expect_as_compared(trial(all, to, "--size 8"), to + "-back.exr", "in.exr");
  }
  fails(2, {"tradeoff", "in.exr", "--task", "sizes:0"}, {"sizes:0"});
}

// Rays meet the triangles themselves, as 'exact' does; straight sides are far off in a room of few triangles.
TEST_F(Tradeoff, ScenesAreDrawnByEveryMethod) {
  ASSERT_EQ(shell("python3 " ENVMAP_SCENES "/make.py scenes").status, 0);
  const Result r =
      envmap({"tradeoff", "scenes/room-2.glb", "--task", "render:sphere:64", "--json", "--budget", "1000"});
  ASSERT_EQ(r.status, 0) << r.err;
  const json all = json::parse(r.out)["trials"];
  EXPECT_EQ(trial(all, "raycast", "")["max"], 0);
  EXPECT_LT(trial(all, "exact", "")["rms"].get<double>(), 0.05);
  EXPECT_GT(trial(all, "distort", "")["rms"].get<double>(), 4 * trial(all, "exact", "")["rms"].get<double>());
  // The fastest way is no answer if it lacks a wall.
  EXPECT_GT(trial(all, "distort", "")["missing_solid_angle"].get<double>(), 0.1);
  EXPECT_FALSE(trial(all, "distort", "")["front"]);
  EXPECT_EQ(trial(all, "exact", "")["missing_solid_angle"], 0);
  fails(2, {"tradeoff", "in.exr", "--task", "depth", "--at", "0,0,0"}, {"--at"});
}

// Errors of pictures, from what `view` writes.
TEST_F(Tradeoff, PicturesAreThoseThatViewDraws) {
  ASSERT_EQ(shell("python3 " ENVMAP_SCENES "/make.py scenes").status, 0);
  const auto view = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"view", "scenes/ball.glb", "out.exr", "-q", "--width", "48", "--height", "48"});
    succeeds(words);
    return load(path("out.exr"));
  };
  const Picture truth = view({"--method", "raycast"});
  const auto rms = [&](const Picture& seen) {
    double error = 0, power = 0;
    for (std::size_t k = 0; k < truth.values.size(); ++k) {
      const double b = truth.values[k], off = seen.values[k] - b;
      error += off * off, power += b * b;
    }
    return std::sqrt(error / power);
  };
  const auto expect = [&](const std::string& method, const std::string& setting,
                          const std::vector<std::string>& words) {
    const Result r = envmap({"tradeoff", "scenes/ball.glb", "--task", "view:48", "--json", "--budget", "0", "--only",
                             method + " " + setting});
    ASSERT_EQ(r.status, 0) << r.err;
    const json t = trial(json::parse(r.out)["trials"], method, setting);
    const double expected = rms(view(words));
    EXPECT_GT(expected, 1e-3);
    EXPECT_NEAR(t["rms"].get<double>(), expected, 1e-2 * expected) << t;  // Files hold half floats.
  };
  expect("--maps sphere", "--size 64", {"--maps", "sphere", "--size", "64"});
  expect("--maps cube", "--lookup direction --size 64", {"--maps", "cube", "--lookup", "direction", "--size", "64"});
  fails(2, {"tradeoff", "scenes/room-2.glb", "--task", "view:16"}, {"no mirror"});
  fails(2, {"tradeoff", "scenes/ball.glb", "--task", "view:16", "--at", "0,0,0"}, {"--at"});
  fails(2, {"tradeoff", "scenes/ball.glb", "--task", "view:16", "--only", "oval"}, {"oval", "--maps cube"});
}

// What is read back of a baked folder, against what `convert` and `prefilter` make of the probe.
TEST_F(Tradeoff, BakedMapsAreJudgedAsTheyAreReadBack) {
  const Result r = envmap({"tradeoff", "in.exr", "--task", "bake:three-latlong", "--json", "--budget", "0", "--only",
                           "draft --depth half"});
  ASSERT_EQ(r.status, 0) << r.err;
  succeeds({"bake", "in.exr", "three", "--for", "three-latlong", "--quality", "draft", "--depth", "half", "-q"});
  succeeds({"convert", "in.exr", "truth.exr", "--for", "three", "--size", "8", "--filter", "area", "--area-error",
            "1e-6", "--depth", "float", "-q"});
  const json t = json::parse(r.out)["trials"][0];
  expect_as_compared(t, "three/background.exr", "truth.exr");
  EXPECT_NEAR(t["bytes"].get<double>(), double(std::filesystem::file_size(path("three/background.exr"))), 400);
  for (const std::string task : {"bake", "bake:quake", "bake:three:8"})
    fails(2, {"tradeoff", "in.exr", "--task", task}, {"bake"});
}

// Every mark of the SVG is in the PNG, twice as large and in its colour; labels are clear of each other.
TEST_F(Tradeoff, BothPicturesShowTheSame) {
  const std::vector<std::string> depth{"tradeoff", "in.exr", "--task", "depth",  "--csv", "-q",
                                       "--budget", "0.5",    "--only", "--zstd", "--plot"};
  const auto plot = [&](const std::string& to) {
    std::vector<std::string> words = depth;
    words.push_back(to);
    const Result r = envmap(words);
    EXPECT_EQ(r.status, 0) << r.err;
  };
  plot("out.svg"), plot("out.png");
  const std::string svg = read("out.svg");
  const Picture png = load(path("out.png"));
  ASSERT_EQ(png.width, 1800);
  ASSERT_EQ(png.height, 1120);
  const std::regex mark("<path d=\"M([^\"]*)Z\" fill=\"#(\\w+)\""), place("([0-9.]+),([0-9.]+)");
  int marks = 0, shown = 0;
  for (std::sregex_iterator m(svg.begin(), svg.end(), mark), end; m != end; ++m, ++marks) {
    const std::string points = (*m)[1];
    double x = 0, y = 0, count = 0;
    for (std::sregex_iterator p(points.begin(), points.end(), place); p != end; ++p, ++count)
      x += std::stod((*p)[1]), y += std::stod((*p)[2]);
    const float* pixel = png.at(int(2 * x / count), int(2 * y / count));
    const long colour = std::stol((*m)[2], nullptr, 16);
    const bool same =
        std::abs(pixel[0] * 255 - float(colour >> 16)) < 2 && std::abs(pixel[2] * 255 - float(colour & 255)) < 2;
    shown += same ? 1 : 0;
  }
  EXPECT_GE(marks, 5);
  EXPECT_GE(shown, marks - 1);  // One may lie under another.

  const std::regex label("<text x=\"([0-9.]+)\" y=\"([0-9.]+)\" font-size=\"11\" text-anchor=\"(\\w+)\"[^>]*>([^<]*)<");
  std::vector<std::array<double, 3>> lines;  // Left, right, baseline.
  for (std::sregex_iterator m(svg.begin(), svg.end(), label), end; m != end; ++m) {
    const double y = std::stod((*m)[2]), wide = 0.5 * 11 * double((*m)[4].length());
    const double x = std::stod((*m)[1]) - ((*m)[3] == "end" ? wide : (*m)[3] == "middle" ? 0.5 * wide : 0);
    lines.push_back({x, x + wide, y});
    bool written = false;
    for (int j = int(2 * y) - 20; j < int(2 * y); ++j)
      for (int i = int(2 * x); i < int(2 * lines.back()[1]); ++i) written |= png.at(i, j)[0] < 0.4F;
    EXPECT_TRUE(written) << (*m)[4];
  }
  ASSERT_GE(lines.size(), 3U);
  for (const auto& a : lines)
    for (const auto& b : lines)
      EXPECT_TRUE(&a == &b || a[1] < b[0] || b[1] < a[0] || std::abs(a[2] - b[2]) >= 11) << a[0] << " " << a[2];
}

TEST_F(Tradeoff, PlotsAndRefuses) {
  const Result csv = envmap({"tradeoff", "in.exr", "--task", "mipmap:1", "--csv"});
  EXPECT_TRUE(csv.out.starts_with("method,setting,seconds")) << csv.out;
  EXPECT_EQ(std::ranges::count(csv.out, '\n'), 3);

  succeeds({"tradeoff", "in.exr", "--task", "depth", "--plot", "out.svg", "-q"});
  const std::string svg = bytes_of(path("out.svg"));
  EXPECT_TRUE(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
  EXPECT_NE(svg.find(">bytes<"), std::string::npos);
  EXPECT_NE(svg.find(">.hdr<"), std::string::npos);
  const Result hurried = envmap({"tradeoff", "in.exr", "--task", "convert:cube:8", "--budget", "0"});
  EXPECT_EQ(hurried.status, 0);
  EXPECT_NE(hurried.err.find("raise --budget"), std::string::npos) << hurried.err;
  for (const std::string task :
       {"convert", "convert:oval", "convert:cube:x", "ggx", "ggx:2", "ggx:0.5:cube", "depth:1", "paint"})
    fails(2, {"tradeoff", "in.exr", "--task", task}, {});
  fails(2, {"tradeoff", "--task", "depth"}, {"INPUT"});
  fails(2, {"tradeoff", "s.obj", "--task", "view", "--from", "sphere"}, {"s.obj: is a scene: remove --from"});
  fails(2, {"tradeoff", "in.exr", "--task", "depth", "--plot", "out.gif"}, {".svg", ".png"});
}

}  // namespace
}  // namespace command_tests::tradeoff_test

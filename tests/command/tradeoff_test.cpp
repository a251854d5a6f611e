// What `tradeoff` says of methods, against what the commands themselves do.
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <string>

#include "run.h"

namespace command_tests {
namespace {

using nlohmann::json;

class Tradeoff : public CommandTest {
 protected:
  void SetUp() override {
    CommandTest::SetUp();
    succeeds({"generate", "sun", "in.exr", "--size", "16", "--direction", "3,2,1", "--radius", "12", "--value", "40,30,20", "--depth", "float"});
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
  succeeds({"convert", "in.exr", "truth.exr", "--to", "cube", "--size", "8", "--filter", "area", "--area-error", "1e-6", "-q"});
  for (const std::string filter : {"nearest", "ewa"}) {
    succeeds({"convert", "in.exr", "out.exr", "--to", "cube", "--size", "8", "--filter", filter, "-q"});
    expect_as_compared(trial(all, filter, ""), "out.exr", "truth.exr");
  }
  succeeds({"convert", "in.exr", "out.exr", "--to", "cube", "--size", "8", "--filter", "bilinear", "--samples", "4", "-q"});
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

TEST_F(Tradeoff, FilesAreAsLargeAsTheyAreWritten) {
  const json all = trials("depth");
  const json half = trial(all, ".exr", "--depth half --compression zip");
  succeeds({"convert", "in.exr", "half.exr", "--depth", "half", "--compression", "zip", "-q"});
  EXPECT_NEAR(half["bytes"].get<double>(), static_cast<double>(std::filesystem::file_size(path("half.exr"))), 400);  // Attributes.
  expect_as_compared(half, "half.exr", "in.exr");
  EXPECT_EQ(trial(all, ".ktx2", "--depth float")["max"], 0);
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::temp_directory_path()))
    EXPECT_FALSE(entry.path().filename().string().starts_with("envmap-") && entry.path().extension() == ".ktx2") << entry.path();
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
}

// Rays meet the triangles themselves, as 'exact' does; straight sides are far off in a room of few triangles.
TEST_F(Tradeoff, ScenesAreDrawnByEveryMethod) {
  ASSERT_EQ(shell("python3 " ENVMAP_SCENES "/make.py scenes").status, 0);
  const Result r = envmap({"tradeoff", "scenes/room-2.glb", "--task", "render:sphere:64", "--json", "--budget", "1000"});
  ASSERT_EQ(r.status, 0) << r.err;
  const json all = json::parse(r.out)["trials"];
  EXPECT_EQ(trial(all, "raycast", "")["max"], 0);
  EXPECT_LT(trial(all, "exact", "")["rms"].get<double>(), 0.05);
  EXPECT_GT(trial(all, "distort", "")["rms"].get<double>(), 4 * trial(all, "exact", "")["rms"].get<double>());
  fails(2, {"tradeoff", "in.exr", "--task", "depth", "--at", "0,0,0"}, {"--at"});
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
  EXPECT_NE(hurried.err.find("say --budget"), std::string::npos) << hurried.err;
  for (const std::string task : {"convert", "convert:oval", "convert:cube:x", "ggx", "ggx:2", "ggx:0.5:cube", "depth:1", "paint"})
    fails(2, {"tradeoff", "in.exr", "--task", task}, {});
  fails(2, {"tradeoff", "in.exr", "--task", "depth", "--plot", "out.png"}, {".svg"});
}

}  // namespace
}  // namespace command_tests

// --for of convert, mipmap and prefilter, beside the folders that bake writes; and what bake promises of errors.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "run.h"

namespace command_tests::engine_option_test {
namespace {

class EngineOption : public CommandTest {
 protected:
  void make_probe() const {
    succeeds({"generate", "sun", "probe.exr", "--to", "latlong", "--size", "32", "--radius", "12", "--direction",
              "1,2,3", "--value", "20"});
  }
};

struct File {
  std::string engine, name;
};
std::string out_of(const File& f) { return f.engine + f.name.substr(f.name.rfind('.')); }

TEST_F(EngineOption, ConvertMakesTheEnvironmentThatBakeWrites) {
  make_probe();
  for (const File& f : {File{"babylon", "background.dds"},
                        {"bevy", "skybox.ktx2"},
                        {"blender", "background.exr"},
                        {"filament", "sky.ktx"},
                        {"godot", "background.exr"},
                        {"pbrt", "background.exr"},
                        {"playcanvas", "background.hdr"},
                        {"three", "background.ktx2"},
                        {"unity", "background.exr"},
                        {"unreal", "background.hdr"},
                        {"usd", "background.exr"}}) {
    SCOPED_TRACE(f.engine);
    succeeds({"bake", "probe.exr", f.engine, "--for", f.engine, "--chain-size", "16", "--quality", "draft", "--size",
              "16", "-q"});
    std::vector<std::string> convert{"convert", "probe.exr", out_of(f), "--size", "16", "--for", f.engine, "-q"};
    if (f.engine == "three") convert.emplace_back("--zstd");
    succeeds(convert);
    EXPECT_TRUE(read(f.engine + "/" + f.name) == read(out_of(f)));
  }
}

TEST_F(EngineOption, PrefilterMakesTheLevelsThatBakeWrites) {
  make_probe();
  for (const File& f : {File{"babylon", "environment.dds"},
                        {"babylon-env", "environment.env"},
                        {"bevy", "specular.ktx2"},
                        {"filament", "ibl.ktx"},
                        {"gltf", "light.glb"}}) {
    SCOPED_TRACE(f.engine);
    succeeds({"bake", "probe.exr", f.engine, "--for", f.engine, "--chain-size", "16", "-q"});
    succeeds({"prefilter", "probe.exr", out_of(f), "--for", f.engine, "--size", "16", "-q"});
    EXPECT_TRUE(read(f.engine + "/" + f.name) == read(out_of(f)));
  }
  succeeds({"prefilter", "probe.exr", "diffuse.ktx2", "--for", "bevy", "--lobe", "diffuse", "-q"});
  EXPECT_TRUE(read("bevy/diffuse.ktx2") == read("diffuse.ktx2"));
}

// An engine that makes rough light itself: its frame and file, and the lobe that was asked for.
TEST_F(EngineOption, PrefilterTakesTheFrameOfEnginesWithoutLevels) {
  make_probe();
  succeeds({"prefilter", "probe.exr", "three.exr", "--for", "three", "--lobe", "ggx", "--roughness", "0.5", "--size",
            "16", "-q"});
  succeeds({"prefilter", "probe.exr", "wanted.exr", "--to", "latlong", "--forward", "+x", "--lobe", "ggx",
            "--roughness", "0.5", "--size", "16", "-q"});
  EXPECT_TRUE(read("three.exr") == read("wanted.exr"));
}

TEST_F(EngineOption, MipmapGivesThatMapLevels) {
  make_probe();
  for (const File& f : {File{"babylon", ".dds"}, {"bevy", ".ktx2"}, {"three", ".exr"}}) {
    SCOPED_TRACE(f.engine);
    succeeds({"convert", "probe.exr", "one" + f.name, "--for", f.engine, "-q"});
    succeeds({"mipmap", "probe.exr", "all" + f.name, "--for", f.engine, "-q"});
    EXPECT_GT(nlohmann::json::parse(envmap({"info", "all" + f.name, "--json"}).out)["levels"], 3);
    for (const std::string map : {"one", "all"})
      succeeds({"convert", map + f.name, map + ".pfm", "--level", "0", "--filter", "nearest", "-q"});
    EXPECT_TRUE(read("one.pfm") == read("all.pfm"));
  }
  // A mirrored cube has mirrored levels: level 1 is the mean of what level 0 shows there.
  succeeds({"mipmap", "one.exr", "again.dds", "--for", "babylon", "-q"});
  succeeds({"convert", "again.dds", "level.exr", "--level", "1", "--filter", "nearest", "--depth", "float", "-q"});
  succeeds({"convert", "again.dds", "base.exr", "--level", "0", "--filter", "nearest", "--depth", "float", "-q"});
  succeeds({"mipmap", "base.exr", "plain.exr", "-q"});
  succeeds({"convert", "plain.exr", "wanted.exr", "--level", "1", "--filter", "nearest", "--depth", "float", "-q"});
  succeeds({"compare", "level.exr", "wanted.exr", "--max-error", "2e-3"});
}

TEST_F(EngineOption, WhatContradictsIsRefused) {
  make_probe();
  fails(2, {"convert", "probe.exr", "out.exr", "--for", "three", "--to", "cube"},
        {"three.js", "latlong, +x at the centre", "--to cube"});
  fails(2, {"convert", "probe.exr", "out.exr", "--for", "three", "--forward", "-z"},
        {"--forward -z", "--from-forward"});
  fails(2, {"convert", "probe.exr", "out.exr", "--for", "usd", "--openexr-envmap"}, {"--openexr-envmap"});
  fails(2, {"convert", "probe.exr", "out.exr", "--for", "pbrt", "--border", "1"}, {"--border"});
  fails(2, {"convert", "probe.exr", "out.dds", "--for", "babylon", "--layout", "row"}, {"--layout"});
  fails(2, {"convert", "probe.exr", "out.ktx2", "--for", "filament"}, {"out.ktx2", "Filament", ".ktx files"});
  fails(2, {"convert", "probe.exr", "-", "--for", "three", "--format", "hdr"}, {"three.js", ".exr files"});
  fails(2, {"convert", "probe.exr", "out.env", "--for", "babylon-env"}, {"envmap prefilter --for babylon-env"});
  fails(2, {"mipmap", "probe.exr", "out.exr", "--for", "three", "--keep"}, {"--keep", "--for"});
  fails(2, {"prefilter", "probe.exr", "out.ktx", "--for", "filament", "--scale", "2"}, {"--scale"});
  fails(2, {"prefilter", "probe.exr", "out.ktx", "--for", "filament", "--size", "8"}, {"--size 8", "5 levels"});
  fails(2, {"convert", "probe.exr", "out.exr", "--for", "quake"}, {"'quake'", "three"});
  // A depth that was asked for is taken.
  succeeds({"convert", "probe.exr", "half.ktx2", "--for", "bevy", "--depth", "half", "-q"});
  EXPECT_EQ(nlohmann::json::parse(envmap({"info", "half.ktx2", "--json"}).out)["depth"], "half");
}

TEST_F(EngineOption, ClampingIsThatOfTheExposedLight) {
  succeeds({"generate", "constant", "bright.exr", "--size", "8", "--value", "1e5"});
  const auto says = [this](const std::string& stops) {
    return envmap({"convert", "bright.exr", "out.exr", "--for", "three", "--depth", "float", "--exposure", stops}).err;
  };
  EXPECT_EQ(says("-10").find("exceed"), std::string::npos);
  EXPECT_NE(says("10").find("128 texels exceed 65504, up to 1.02e+08"), std::string::npos) << says("10");
}

TEST_F(EngineOption, TheFrameIsPrintedAndReported) {
  make_probe();
  for (const std::string command : {"convert", "mipmap", "prefilter"}) {
    std::vector<std::string> line{command, "probe.exr", command + ".dds", "--for", "babylon", "--json"};
    if (command == "prefilter") line.insert(line.end(), {"--size", "8"});
    const Result r = envmap(line);
    EXPECT_EQ(r.status, 0) << r.err;
    EXPECT_NE(r.err.find("The file is mirrored"), std::string::npos) << r.err;
    const auto report = nlohmann::json::parse(r.out);
    EXPECT_EQ(report["engine"], "babylon");
    EXPECT_EQ(report["frame"], "cube");
  }
  const Result list = envmap({"bake", "--list"});
  EXPECT_NE(list.out.find("playcanvas "), std::string::npos);
  for (const std::string command : {"bake", "convert", "mipmap", "prefilter"}) {
    const Result r = envmap({command, "--for", "list"});
    EXPECT_EQ(r.status, 0) << r.err;
    EXPECT_EQ(r.out, list.out);
  }
}

TEST_F(EngineOption, QualitySetsSizesAndErrors) {
  succeeds({"generate", "constant", "probe.exr", "--size", "32"});
  int diffuse = 32;
  for (const std::string quality : {"draft", "normal", "high"}) {
    const Result r = envmap(
        {"bake", "probe.exr", quality, "--for", "bevy", "--chain-size", "16", "--quality", quality, "--json", "-q"});
    ASSERT_EQ(r.status, 0) << r.err;
    const auto maps = nlohmann::json::parse(r.out)["maps"];
    EXPECT_EQ(maps[0]["size"], quality == "draft" ? 8 : 16);
    EXPECT_EQ(maps[1]["size"], 16);
    EXPECT_EQ(maps[2]["size"], diffuse);
    diffuse *= 2;
  }
  EXPECT_NE(read("draft/README.txt").find("specular.ktx2: cube, 16x16 in 5 levels, rgb9e5; every texel within 0.01"),
            std::string::npos)
      << read("draft/README.txt");
  EXPECT_NE(read("draft/README.txt").find("roughness by level: 0, 0.25, 0.5, 0.75, 1."), std::string::npos);
  EXPECT_NE(read("high/README.txt").find("within 0.0001"), std::string::npos);
}

// What is read back of every level keeps to --max-error, against exact sums in float.
TEST_F(EngineOption, MaxErrorHoldsForWhatIsReadBack) {
  make_probe();
  for (const auto& [engine, error] : {std::pair<std::string, std::string>{"filament", "2e-3"}, {"bevy", "0.05"}}) {
    SCOPED_TRACE(engine);
    const std::string chain = engine + (engine == "bevy" ? "/specular.ktx2" : "/ibl.ktx");
    succeeds({"bake", "probe.exr", engine, "--for", engine, "--chain-size", "16", "--max-error", error, "-q"});
    EXPECT_NE(read(engine + "/README.txt").find("every texel read from it within"), std::string::npos);
    for (int k = 1; k < 5; ++k) {
      const double roughness = engine == "bevy" ? k / 4.0 : 1 - std::sqrt(1 - k / 4.0);
      succeeds({"convert", chain, "level.exr", "--level", std::to_string(k), "--filter", "nearest", "--depth", "float",
                "-q"});
      succeeds({"prefilter", "probe.exr", "wanted.exr", "--lobe", "ggx", "--roughness", std::to_string(roughness),
                "--size", std::to_string(16 >> k), "--method", "exact", "--depth", "float", "-q"});
      if (engine == "bevy") {  // Z is negated: a mirror's own mirror shows the world.
        succeeds({"convert", "wanted.exr", "w.ktx2", "--for", "bevy", "--depth", "float", "-q"});
        succeeds({"convert", "w.ktx2", "wanted.exr", "--filter", "nearest", "--depth", "float", "-q"});
      }
      succeeds({"compare", "level.exr", "wanted.exr", "--max-error", error});
    }
  }
}

TEST_F(EngineOption, WhatADepthCannotHoldIsRefusedWithAWayOut) {
  make_probe();
  fails(1, {"bake", "probe.exr", "lights", "--for", "filament", "--max-error", "1e-4"},
        {"lights/sky.ktx", "half", "4.9e-04", "--depth float"});
  fails(1, {"bake", "probe.exr", "lights", "--for", "babylon-env", "--max-error", "1e-3"},
        {"lights/environment.env", "rgbd", "raise --max-error"});
  fails(1, {"prefilter", "probe.exr", "ibl.ktx", "--for", "filament", "--max-error", "1e-4"},
        {"ibl.ktx", "half", "--depth float"});
}

// No error that was asked for helps against a value that the depth does not hold: the message has that value.
TEST_F(EngineOption, ValuesBeyondTheDepthAreNoMatterOfMaxError) {
  succeeds({"generate", "sun", "probe.exr", "--size", "128", "--radius", "4", "--value", "1e6"});
  const auto refused = [&](const std::vector<std::string>& command, const std::vector<std::string>& words) {
    fails(1, command, words);
    const std::string said = envmap(command).err;
    EXPECT_EQ(said.find("inf"), std::string::npos) << said;
    EXPECT_EQ(said.find("raise --max-error"), std::string::npos) << said;
    EXPECT_EQ(said.find("--depth half"), std::string::npos) << said;
  };
  const std::vector<std::string> filament{"bake",         "probe.exr", "lights",      "--for", "filament",
                                          "--chain-size", "16",        "--max-error", "0.1",   "-q"};
  refused(filament, {"lights/sky.ktx", "largest value is 1e+06", "half holds values up to 65504", "lower --exposure",
                     "--suns", "--depth float"});
  refused({"bake", "probe.exr", "lights", "--for", "three", "--max-error", "0.1"},
          {"lights/background.ktx2", "1e+06", "uastc-hdr", "65504", "lower --exposure or use --suns"});
  refused({"prefilter", "probe.exr", "ibl.ktx2", "--lobe", "ggx", "--roughness", "0.1", "--depth", "half",
           "--max-error", "0.1"},
          {"ibl.ktx2", "half holds values up to 65504", "--depth float"});
  for (const auto& more : std::vector<std::vector<std::string>>{{"--exposure", "-4"}, {"--suns"}}) {
    std::vector<std::string> command = filament;
    command.insert(command.end(), more.begin(), more.end());
    succeeds(command);
  }
}

TEST_F(EngineOption, SunsBeyondHalfAreRefusedWithWaysOutThatAreThere) {
  succeeds({"generate", "sun", "probe.exr", "--size", "32", "--radius", "20", "--value", "1e6"});
  const std::vector<std::string> bake{"bake", "probe.exr", "lights", "--for", "filament", "--chain-size", "16", "-q"};
  fails(4, bake, {"lights/sky.ktx: ", "65504", "--depth float", "--exposure", "--clamp"});
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = bake;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  succeeds(with({"--depth", "float"}));
  EXPECT_NEAR(nlohmann::json::parse(envmap({"info", "lights/sky.ktx", "--json"}).out)["maximum"][0].get<double>(), 1e6,
              1);
  succeeds(with({"--exposure", "-4"}));
  EXPECT_NEAR(nlohmann::json::parse(envmap({"info", "lights/sky.ktx", "--json"}).out)["maximum"][0].get<double>(),
              62500, 32);
  EXPECT_NE(read("lights/README.txt").find("multiplied by 2^-4"), std::string::npos);
  const Result clamped = envmap(with({"--clamp"}));
  EXPECT_EQ(clamped.status, 0);
  EXPECT_NE(clamped.err.find("lights/sky.ktx: clamped"), std::string::npos) << clamped.err;
  EXPECT_NE(clamped.err.find("% of the flux lost"), std::string::npos) << clamped.err;
}

}  // namespace
}  // namespace command_tests::engine_option_test

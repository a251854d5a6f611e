// `lights`, `bake --suns` and `convert --restore-sun` as their users run them.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "command/picture.h"
#include "command/run.h"

namespace command_tests::lights_test {
namespace {

class Lights : public CommandTest {
 protected:
  // A sky of radiance 1 to 3, and a disc of one degree.
  void make_sun(const std::string& direction = "1,2,1") const {
    succeeds({"generate", "sun", "sun.exr", "--to", "latlong", "--size", "256", "--radius", "1", "--value", "10000",
              "--direction", direction, "--depth", "float", "-q"});
  }
  [[nodiscard]] nlohmann::json flux_of(const std::string& map) const { return report({"info", map})["flux"]; }
};

constexpr double pi = 3.14159265358979323846;

TEST_F(Lights, TellWhereASunIsAndWhatItIs) {
  make_sun();
  const auto said = report({"lights", "sun.exr", "--remainder", "rest.exr"});
  ASSERT_EQ(said["lights"].size(), 1);
  const auto& sun = said["lights"][0];
  EXPECT_NEAR(sun["azimuth"].get<double>(), 45, 0.02);
  EXPECT_NEAR(sun["elevation"].get<double>(), std::atan(std::sqrt(2.0)) * 180 / pi, 0.02);
  EXPECT_NEAR(sun["radius"].get<double>(), 1, 0.01);
  const double sine = std::sin(pi / 180), lux = 10000 * pi * sine * sine;
  EXPECT_NEAR(sun["lux"].get<double>() / lux, 1, 1e-3);
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR((flux_of("rest.exr")[c].get<double>() + sun["flux"][c].get<double>()) /
                    flux_of("sun.exr")[c].get<double>(),
                1, 1e-6);
  EXPECT_LT(report({"info", "rest.exr"})["maximum"][0].get<double>(), 1.1);
  EXPECT_LT(said["error"]["irradiance"].get<double>(), 0.02);
  EXPECT_GT(said["error"]["irradiance"].get<double>(), 0.001);
}

TEST_F(Lights, SayThatThereAreNone) {
  succeeds({"generate", "sky", "sky.exr", "--to", "latlong", "--size", "64", "-q"});
  const Result none = envmap({"lights", "sky.exr", "--gltf", "none.gltf"});
  EXPECT_EQ(none.status, 1);
  EXPECT_NE(none.err.find("no light"), std::string::npos);
  EXPECT_EQ(files().count("none.gltf"), 0);
}

// KHR_lights_punctual: a light shines along the -Z of its node, and intensity x color is the irradiance.
TEST_F(Lights, OfGltfShineFromWhereTheSunIs) {
  make_sun("1,2,-0.5");
  succeeds({"lights", "sun.exr", "--gltf", "suns.gltf", "-q"});
  const auto gltf = nlohmann::json::parse(read("suns.gltf"));
  const auto& light = gltf["extensions"]["KHR_lights_punctual"]["lights"][0];
  EXPECT_EQ(light["type"], "directional");
  const double sine = std::sin(pi / 180);
  EXPECT_NEAR(light["intensity"].get<double>() / (10000 * pi * sine * sine), 1, 1e-3);
  const auto q = gltf["nodes"][0]["rotation"].get<std::vector<double>>();  // x, y, z, w
  const double x = 2 * (q[0] * q[2] + q[3] * q[1]), y = 2 * (q[1] * q[2] - q[3] * q[0]),
               z = 1 - 2 * (q[0] * q[0] + q[1] * q[1]);  // Of +Z, turned.
  const double length = std::sqrt(1 + 4 + 0.25);
  EXPECT_NEAR(x, 1 / length, 2e-4);
  EXPECT_NEAR(y, 2 / length, 2e-4);
  EXPECT_NEAR(z, -0.5 / length, 2e-4);
}

// A floor under the lights of an atmosphere, whose radiance 1 is 683 cd/m^2, and the rest of its map has the map's
// illuminance by `info`, which sums texels, and so has the map itself with its suns as lights.
TEST_F(Lights, OfGltfAreInTheUnitOfTheMapBesideThem) {
  succeeds({"generate", "atmosphere", "sky.exr", "--size", "256", "-q"});
  succeeds({"lights", "sky.exr", "--gltf", "suns.gltf", "--remainder", "rest.exr", "-q"});
  auto floor = nlohmann::json::parse(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
    "nodes":[{"mesh":0,"rotation":[-0.70710678,0,0,0.70710678]}],
    "extensionsUsed":["KHR_lights_punctual","KHR_materials_ior"],
    "materials":[{"extensions":{"KHR_materials_ior":{"ior":1}},
                  "pbrMetallicRoughness":{"metallicFactor":0,"roughnessFactor":1}}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[-1,-1,0],"max":[1,1,0]},
                 {"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}],
    "bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],
    "buffers":[{"byteLength":60,"uri":"data:;base64,)"
                                     "AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAACAPwAAgD8AAAAAAACAvwAAgD8AAAAAAAABAAIAAAACAAMA"
                                     R"("}]})");
  write("floor.gltf", floor.dump());
  const auto suns = nlohmann::json::parse(read("suns.gltf"));
  floor["extensions"] = suns["extensions"];
  floor["nodes"].push_back(suns["nodes"][0]), floor["scenes"][0]["nodes"] = {0, 1};
  write("lit.gltf", floor.dump());
  const auto lux = [&](const std::string& scene, const std::string& map, const std::vector<std::string>& more) {
    std::vector<std::string> words{"view",    scene,         "floor.exr", "--environment", map,         "--method",
                                   "raycast", "--fov",       "5",         "--camera",      "0.3,2,0.3", "--look-at",
                                   "0,0,0",   "--occlusion", "0",         "--width",       "4",         "--height",
                                   "4",       "-q"};
    words.insert(words.end(), more.begin(), more.end());
    succeeds(words);
    const Picture picture = load(path("floor.exr"));
    const float* const seen = picture.at(1, 1);
    return 683 * pi * (0.2126 * seen[0] + 0.7152 * seen[1] + 0.0722 * seen[2]);
  };
  const double of_map = report({"info", "sky.exr"})["illuminance"]["lux"].get<double>();
  EXPECT_NEAR(lux("lit.gltf", "rest.exr", {}) / of_map, 1, 0.01);
  EXPECT_NEAR(lux("floor.gltf", "sky.exr", {"--suns"}) / of_map, 1, 0.01);
  const Result said = envmap({"view", "lit.gltf", "floor.exr", "--environment", "rest.exr", "--method", "raycast",
                              "--width", "4", "--height", "4"});
  EXPECT_NE(said.err.find("rest.exr: radiance 1 is 683 cd/m^2: lights of the scene are divided by that"),
            std::string::npos)
      << said.err;
  fails(3, {"view", "suns.gltf", "floor.png"}, {"suns.gltf: holds lights alone", "copy its lights"});
}

// Shares of a sky of even radiance: their sum is its flux, and each is as large as any other.
TEST_F(Lights, OfMedianCutShareOutTheFlux) {
  succeeds({"generate", "constant", "white.exr", "--to", "latlong", "--size", "128", "-q"});
  const auto lights = report({"lights", "white.exr", "--count", "32"})["lights"];
  ASSERT_EQ(lights.size(), 32);
  double sum = 0;
  for (const auto& light : lights) {
    sum += light["irradiance"][1].get<double>();
    EXPECT_NEAR(light["share"].get<double>(), 1.0 / 32, 0.002);
  }
  EXPECT_NEAR(sum, 4 * pi, 1e-4);
}

TEST_F(Lights, LeaveTheMapsOfABakeAndStandBesideThem) {
  make_sun();
  for (const auto& [engine, file, word] : {std::array<std::string, 3>{"three", "suns.js", "DirectionalLight"},
                                           {"usd", "light.usda", "DistantLight \"Sun1\""},
                                           {"blender", "world.py", "sun_threshold = 0"},
                                           {"godot", "suns.tscn", "light_angular_distance = "},
                                           {"unreal", "suns.txt", "diameter "}}) {
    SCOPED_TRACE(engine);
    const auto said = report({"bake", "sun.exr", engine, "--for", engine, "--suns", "-q"});
    EXPECT_EQ(said["suns"].size(), 1);
    EXPECT_NE(read(engine + "/" + file).find(word), std::string::npos);
    EXPECT_NE(read(engine + "/README.txt").find("Suns: " + file), std::string::npos);
    const std::string map = engine == "unreal"  ? "background.hdr"
                            : engine == "three" ? "background.ktx2"
                                                : "background.exr";
    EXPECT_LT(report({"info", engine + "/" + map})["maximum"][0].get<double>(), 1.2);
    EXPECT_EQ(report({"bake", "sun.exr", engine, "--for", engine, "--suns", "-q"})["suns"].size(), 1);  // Replaces it.
  }
}

// Every row of the engines brings its suns in the file of the engine, whichever maps the row has: a script that adds
// them, a scene or a stage; a table only where the engine has none of these.
TEST_F(Lights, StandInTheFileOfTheEngineInEveryRow) {
  const std::map<std::string, std::array<std::string, 2>> files{{"babylon", {"suns.js", "BABYLON.DirectionalLight"}},
                                                                {"bevy", {"suns.txt", "axes of Bevy"}},
                                                                {"blender", {"world.py", "bpy.data.lights.new"}},
                                                                {"cesium", {"suns.txt", "axes of CesiumJS"}},
                                                                {"filament", {"suns.txt", "axes of Filament"}},
                                                                {"glsl", {"suns.txt", "axes of GLSL"}},
                                                                {"gltf", {"suns.gltf", "KHR_lights_punctual"}},
                                                                {"godot", {"suns.tscn", "DirectionalLight3D"}},
                                                                {"hlsl", {"suns.txt", "axes of HLSL"}},
                                                                {"pbrt", {"suns.txt", "axes of pbrt-v4"}},
                                                                {"playcanvas", {"suns.txt", "axes of PlayCanvas"}},
                                                                {"three", {"suns.js", "THREE.DirectionalLight"}},
                                                                {"unity", {"suns.txt", "axes of Unity"}},
                                                                {"unreal", {"suns.txt", "axes of Unreal"}},
                                                                {"usd", {"light.usda", "DistantLight"}}};
  make_sun();
  const auto rows = report({"bake", "--list"})["engines"];
  ASSERT_GT(rows.size(), files.size());
  for (const auto& row : rows) {
    const std::string engine = row["name"];
    SCOPED_TRACE(engine);
    const auto wanted = files.find(engine.substr(0, engine.find('-')));
    ASSERT_NE(wanted, files.end());
    const auto& [file, word] = wanted->second;
    succeeds({"bake", "sun.exr", engine, "--for", engine, "--suns", "--chain-size", "32", "--quality", "draft", "-q"});
    EXPECT_NE(read(engine + "/" + file).find(word), std::string::npos);
    EXPECT_NE(read(engine + "/README.txt").find("Suns: " + file), std::string::npos);
    for (const char* const other : {"suns.txt", "suns.js", "suns.gltf", "suns.tscn"})
      EXPECT_EQ(std::filesystem::exists(path(engine + "/" + other)), other == file) << other;
  }
}

TEST_F(Lights, ThatAreMissingAreNotInvented) {
  succeeds({"generate", "sky", "sky.exr", "--to", "latlong", "--size", "64", "-q"});
  const Result baked = envmap({"bake", "sky.exr", "lights", "--for", "three", "--suns", "-q"});
  EXPECT_EQ(baked.status, 0);
  EXPECT_NE(baked.err.find("no light for --suns"), std::string::npos);
  EXPECT_EQ(files().count("lights/suns.js"), 0);
}

TEST_F(Lights, ThatWereClippedAreRestored) {
  make_sun();
  const Result cut =
      envmap({"convert", "sun.exr", "cut.png", "--exposure", "-2", "--depth", "uint16", "--clamp", "-q"});
  ASSERT_EQ(cut.status, 0) << cut.err;
  for (const auto& [how, wanted] : {std::pair<std::string, double>{"lux=50", 50}, {"irradiance=50,50,50", 50}}) {
    const auto said = report(
        {"convert", "cut.png", "whole.exr", "--depth", "float", "--restore-sun", how, "--sun-radius", "0.8"})["sun"];
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(said["irradiance_after"][c].get<double>() / wanted, 1, 1e-4);
    const auto sun = report({"lights", "whole.exr"})["lights"][0];
    EXPECT_NEAR(sun["azimuth"].get<double>(), 45, 0.1);
    EXPECT_NEAR(sun["lux"].get<double>(), wanted, 0.02 * wanted);
    EXPECT_NEAR(flux_of("whole.exr")[0].get<double>(), said["flux_after"][0].get<double>(), 1e-3);
  }
  EXPECT_EQ(report({"convert", "cut.png", "day.exr", "--restore-sun", "atmosphere"})["sun"]["radius"], 0.2666);
  ASSERT_EQ(envmap({"generate", "sun", "low.exr", "--to", "latlong", "--size", "64", "--direction", "1,0.001,0",
                    "--value", "100,100,0", "--zenith", "1,1,0", "--ground", "0.2,0.2,0"})
                .status,
            0);
  EXPECT_EQ(report({"convert", "low.exr", "red.exr", "--restore-sun", "atmosphere", "--depth",
                    "float"})["sun"]["irradiance_after"][2]
                .get<double>(),
            0)
      << "redder than Rec. 709 has a colour for";
  fails(2, {"convert", "cut.png", "no.exr", "--restore-sun", "lots"}, {"--restore-sun"});
  fails(3, {"convert", "sun.exr", "no.exr", "--restore-sun", "lux=1e-3"}, {"no light is missing"});
}

TEST_F(Lights, ThatAreWholeAreNotRestoredTwice) {
  ASSERT_EQ(envmap({"generate", "sun", "whole.exr", "--to", "latlong", "--size", "128", "--direction", "0.3,0.5,1",
                    "--radius", "1", "--value", "5000"})
                .status,
            0);
  const double lux = report({"lights", "whole.exr"})["lights"][0]["lux"].get<double>();
  // The disc of --sun-radius holds a part of it alone.
  fails(3, {"convert", "whole.exr", "no.exr", "--restore-sun", "lux=" + std::to_string(0.9 * lux)},
        {"no light is missing"});
  ASSERT_EQ(envmap({"generate", "sky", "sky.exr", "--to", "latlong", "--size", "64"}).status, 0);
  const Result far = envmap({"convert", "sky.exr", "far.exr", "--restore-sun", "lux=80000", "--force"});
  EXPECT_NE(far.err.find("times as much as all the rest"), std::string::npos) << far.err;
}

}  // namespace
}  // namespace command_tests::lights_test

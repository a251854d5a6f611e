// What info tells of maps and scenes.
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "picture.h"
#include "run.h"

namespace command_tests::info_test {
namespace {

using nlohmann::json;

constexpr double pi = std::numbers::pi;

void expect_near(const json& values, const Vec& expected, double tolerance) {
  ASSERT_EQ(values.size(), 3U) << values;
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(values[k].get<double>(), expected.at(k), tolerance) << values;
}

class Info : public CommandTest {};

TEST_F(Info, KnowsTheFluxOfAConstantMap) {
  for (const std::string projection : {"latlong", "cube", "sphere", "paraboloid", "angular"}) {
    SCOPED_TRACE(projection);
    succeeds(
        {"generate", "constant", "map.exr", "--to", projection, "--size", "16", "--value", "1,2,4", "--depth", "half"});
    const json j = report(envmap({"info", "map.exr", "--json"}));
    EXPECT_EQ(j["projection"], projection);
    EXPECT_EQ(j["depth"], "half");
    EXPECT_EQ(j["faces"], projection == "cube" ? 6 : projection == "paraboloid" ? 2 : 1);
    EXPECT_NEAR(j["solid_angle"].get<double>(), 4 * pi, 1e-10);
    expect_near(j["flux"], {4 * pi, 8 * pi, 16 * pi}, 1e-9);
    expect_near(j["mean"], {1, 2, 4}, 1e-10);
    expect_near(j["minimum"], {1, 2, 4}, 0);
    expect_near(j["maximum"], {1, 2, 4}, 0);
  }
}

TEST_F(Info, OfSeveralFilesIsAnArray) {
  succeeds({"generate", "constant", "a.exr", "--size", "4", "--value", "1"});
  succeeds({"generate", "constant", "b.exr", "--size", "4", "--value", "2"});
  const json both = report(envmap({"info", "a.exr", "b.exr", "--json"}));
  EXPECT_EQ(both, (json{report({"info", "a.exr"}), report({"info", "b.exr"})}));
  fails(3, {"info", "a.exr", "missing.exr", "--json"}, {"missing.exr"});
}

TEST_F(Info, OfScenesListsNodesLightsAndCameras) {
  std::string triangles;
  for (int k = 0; k < 10; ++k) triangles += "o part" + std::to_string(k) + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n";
  write("parts.obj", triangles);
  const json scene = report({"info", "parts.obj"})["scene"];
  EXPECT_EQ(scene["triangles"], 10);
  EXPECT_EQ(scene["nodes"].size(), 10U);
  EXPECT_EQ(scene["nodes"][9]["name"], "part9");
  expect_near(scene["nodes"][9]["centre"], {0.5, 0.5, 0}, 0);
  EXPECT_EQ(scene["lights"], json::array());
  const std::string text = envmap({"info", "parts.obj"}).out;
  EXPECT_NE(text.find("'part3', 1 triangle, centre 0.5,0.5,0\n"), std::string::npos) << text;
  const std::string some = "the scene's nodes are part0, part1, part2, part3, part4, part5, part6, part7 and 2 more";
  fails(2, {"render", "parts.obj", "a.exr", "--at", "nosuch"}, {"parts.obj", some});
  fails(2, {"view", "parts.obj", "a.png", "--mirror", "nosuch"}, {some});
  fails(2, {"info", "parts.obj", "--levels"}, {"is a scene", "--levels"});
  fails(2, {"info", "parts.obj", "--input-space", "srgb"}, {"is a scene", "--input-space"});
  fails(2, {"info", "parts.obj", "--from-faces", "gl"}, {"is a scene", "--from-faces"});
  fails(2, {"info", "parts.obj", "--ocio", "builtin"}, {"is a scene", "--ocio"});
  EXPECT_EQ(shell("OCIO=builtin \"$ENVMAP\" info parts.obj").status, 0);
  fails(3, {"info", "missing.obj"}, {"missing.obj"});
}

TEST_F(Info, ShowsTheOtherFilesWhereOneIsMissing) {
  succeeds({"generate", "sky", "a.exr", "--size", "4"});
  succeeds({"generate", "sky", "b.exr", "--size", "4"});
  const Result r = envmap({"info", "a.exr", "gone.exr", "b.exr"});
  EXPECT_EQ(r.status, 3);
  EXPECT_EQ(r.err, "envmap info: gone.exr: no such file\n");
  EXPECT_EQ(r.out, envmap({"info", "a.exr", "b.exr"}).out);
}

TEST_F(Info, FindsTheBrightestDirectionInTheWorld) {
  // One bright texel left of the centre of a map that looks along -Z: there lies -X.
  Picture p = Picture::filled(16, 8, 0.5);
  p.at(4, 3)[0] = p.at(4, 3)[1] = p.at(4, 3)[2] = 8;
  save(path("map.exr"), p);
  const json j = report(envmap({"info", "map.exr", "--json", "--from-forward", "-z"}));
  const double longitude = (0.5 - 4.5 / 16) * 2 * pi, latitude = (0.5 - 3.5 / 8) * pi;
  expect_near(j["brightest"]["direction"],
              {-std::cos(latitude) * std::sin(longitude), std::sin(latitude),
               -std::cos(latitude) * std::cos(longitude)},
              1e-9);
  EXPECT_EQ(j["brightest"]["texel"], (json{4, 3}));
  EXPECT_NEAR(j["stops"].get<double>(), 4, 1e-9);
  EXPECT_NEAR(j["dynamic_range"].get<double>(), 16, 1e-9);
}

TEST_F(Info, OfABlackMapHasNoRange) {
  save(path("black.exr"), Picture::filled(8, 4, 0));
  const std::string text = envmap({"info", "black.exr"}).out;
  EXPECT_NE(text.find("nothing is brighter than 0"), std::string::npos);
  EXPECT_EQ(text.find("--rotate"), std::string::npos) << "convert refuses to turn the sun of a black map";
}

TEST_F(Info, TabulatesTheSampling) {
  succeeds({"generate", "sky", "map.exr", "--to", "cube", "--size", "64"});
  const json table = report(envmap({"info", "map.exr", "--json", "--sampling"}))["sampling"];
  ASSERT_GE(table.size(), 5U);
  // A texel at a cube's corner has 3^(-3/2) of the solid angle of one at the centre.
  EXPECT_NEAR(table.back()["solid_angle"].get<double>() / table.front()["solid_angle"].get<double>(), std::pow(3, -1.5),
              0.01);
}

}  // namespace
}  // namespace command_tests::info_test

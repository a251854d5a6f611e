// What the program tells: facts, differences, help, pages, completions.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <regex>
#include <sstream>

#include "picture.h"
#include "run.h"

namespace command_tests::report_test {
namespace {

using nlohmann::json;

constexpr double pi = std::numbers::pi;

void expect_near(const json& values, const Vec& expected, double tolerance) {
  ASSERT_EQ(values.size(), 3U) << values;
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(values[k].get<double>(), expected.at(k), tolerance) << values;
}

// ---- info -----------------------------------------------------------------------------------------------------------

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

// ---- compare --------------------------------------------------------------------------------------------------------

// Two latlong maps, all 1 but for one texel of the second row of the first map.
class Compare : public CommandTest {
 protected:
  static constexpr int width = 8, height = 4;
  // Solid angle of a texel of that row, and of the sphere.
  const double texel = 2 * pi / width * std::sin(pi / height), sphere = 4 * pi;

  Compare() {
    Picture p = Picture::filled(width, height, 1);
    save(path("b.exr"), p);
    p.at(5, 1)[1] = 1.5;
    save(path("a.exr"), p);
  }
};

TEST_F(Compare, MeasuresWithTheSolidAngle) {
  const json j = report(envmap({"compare", "a.exr", "b.exr", "--json"}));
  expect_near(j["flux"], {0, 0.5 * texel / sphere, 0}, 1e-9);
  EXPECT_NEAR(j["rms"].get<double>(), std::sqrt(0.25 * texel / (3 * sphere)), 1e-9);
  EXPECT_NEAR(j["max"].get<double>(), 0.5, 1e-9);
  EXPECT_EQ(j["worst"]["texel"], (json{5, 1}));
  EXPECT_NEAR(j["light_differs"].get<double>(), 0.5 * texel / (3 * sphere), 1e-9);
  EXPECT_EQ(j["resampled"], false);
  EXPECT_EQ(j["within"], true);
  // The second map is the reference.
  EXPECT_NEAR(report(envmap({"compare", "b.exr", "a.exr", "--json"}))["max"].get<double>(), 0.5 / 1.5, 1e-7);
}

// A sun that moves by three texels of sixteen, along a row; all of its light is elsewhere.
TEST_F(Compare, SaysHowFarTheSunMoved) {
  Picture p = Picture::filled(16, 8, 0), q = p;
  for (int c = 0; c < 3; ++c) p.at(3, 2)[c] = q.at(6, 2)[c] = 7;
  save(path("p.exr"), p);
  save(path("q.exr"), q);
  const json j = report(envmap({"compare", "p.exr", "q.exr", "--json"}));
  EXPECT_NEAR(j["light_differs"].get<double>(), 1, 1e-6);
  const double c = std::cos(pi / 180 * (90 - 2.5 * 22.5)), across = c * std::sin(0.5 * 3 * pi / 8);
  EXPECT_NEAR(j["brightest_moved"].get<double>(), 2 * std::asin(across) * 180 / pi, 1e-4);
  EXPECT_NE(envmap({"compare", "p.exr", "q.exr"}).out.find("100% of the reference; brightest texel moved by"),
            std::string::npos);
  EXPECT_TRUE(envmap({"compare", "p.exr", "p.exr"}).out.ends_with("\nidentical\n"));
  const json sun = report(envmap({"info", "p.exr", "--json"}));
  // Column 3 of 16: 180 - 3.5 x 22.5 degrees.
  EXPECT_NEAR(sun["brightest"]["azimuth"].get<double>(), 180 - 3.5 * 22.5, 1e-4);
  EXPECT_NEAR(sun["brightest"]["elevation"].get<double>(), 90 - 2.5 * 22.5, 1e-4);
  EXPECT_EQ(sun["texels_at_maximum"], 1);
}

// The sun is on the horizon, 18.4349 degrees from +Z, so that a turn about +Y is enough. A shift by a tenth of a degree
// at the edge of this sun has an rms of 0.13; another place of it has 1.4.
TEST_F(Compare, FindsTheSunWhereItWasRotatedTo) {
  succeeds({"generate", "sun", "low.exr", "-q", "--size", "128", "--radius", "4", "--direction", "1,0,3"});
  succeeds({"convert", "low.exr", "aimed.exr", "-q", "--rotate", "sun:+z"});
  succeeds({"convert", "low.exr", "yaw.exr", "-q", "--rotate=-18.4349488,0,0"});
  EXPECT_LT(report(envmap({"compare", "aimed.exr", "yaw.exr", "--json"}))["rms"].get<double>(), 0.2);

  succeeds({"convert", "low.exr", "high.exr", "-q", "--rotate", "sun:0,1,1"});
  const json high = report(envmap({"info", "high.exr", "--json"}))["brightest"];
  EXPECT_NEAR(high["elevation"].get<double>(), 45, 1.5);
  EXPECT_NEAR(high["azimuth"].get<double>(), 0, 1.5);

  // The printed angles are the same rotation.
  const std::string said = envmap({"convert", "low.exr", "said.exr", "--rotate", "1,0,3:1,-2,0.5"}).err;
  const std::size_t at = said.find("--rotate=");
  ASSERT_NE(at, std::string::npos) << said;
  succeeds({"convert", "low.exr", "again.exr", "-q", said.substr(at, said.find('\n', at) - at)});
  EXPECT_LT(report(envmap({"compare", "said.exr", "again.exr", "--json"}))["rms"].get<double>(), 1e-4);

  // Quarter turns move texels.
  succeeds({"convert", "low.exr", "axis.exr", "-q", "--rotate", "+x:+z"});
  succeeds({"convert", "low.exr", "quarter.exr", "-q", "--rotate=-90,0,0"});
  EXPECT_EQ(read("axis.exr"), read("quarter.exr"));

  succeeds({"generate", "constant", "black.exr", "-q", "--size", "8", "--value", "0"});
  fails(3, {"convert", "black.exr", "x.exr", "--rotate", "sun:+z"}, {"all texels are black"});
}

TEST_F(Compare, AnswersByItsExitStatus) {
  const double flux = 0.5 * texel / sphere, rms = std::sqrt(0.25 * texel / (3 * sphere));
  for (const auto& [option, value] : {std::pair{"--max-error", 0.5}, {"--max-rms", rms}, {"--max-flux", flux}}) {
    SCOPED_TRACE(option);
    EXPECT_EQ(envmap({"compare", "a.exr", "b.exr", option, std::to_string(1.01 * value)}).status, 0);
    const Result r = envmap({"compare", "a.exr", "b.exr", option, std::to_string(0.99 * value), "--json"});
    EXPECT_EQ(r.status, 1);
    const json j = json::parse(r.out);
    EXPECT_EQ(j["within"], false);
    ASSERT_EQ(j["broken"].size(), 1U);
    EXPECT_EQ(std::string("--max-") +
                  (j["broken"][0]["metric"] == "max" ? "error" : j["broken"][0]["metric"].get<std::string>()),
              option);
    EXPECT_EQ(j["limits"][std::string(option).substr(2)], j["broken"][0]["limit"]);
    EXPECT_TRUE(std::regex_match(r.err, std::regex(std::string("envmap compare: \\w+ [0-9.e-]+ > [0-9.e-]+ \\(") +
                                                   option + "\\)\n")))
        << r.err;
    EXPECT_EQ(envmap({"compare", "a.exr", "a.exr", option, "0"}).status, 0);
  }
  EXPECT_EQ(envmap({"compare", "a.exr", "b.exr"}).status, 0) << "without a limit there is no question";
}

TEST_F(Compare, SeesWhereTheTwoAreNotAlike) {
  // Levels that the reference has and nobody looked at are no success.
  succeeds({"mipmap", "b.exr", "chain.exr"});
  succeeds({"convert", "b.exr", "cube.exr", "--to", "cube", "--size", "4", "--depth", "float"});
  succeeds({"convert", "b.exr", "half.exr", "--depth", "half"});
  const auto answer = [&](std::vector<std::string> arguments, int status, const std::string& reason) {
    arguments.insert(arguments.begin(), "compare");
    const Result r = envmap(arguments);
    EXPECT_EQ(r.status, status) << r.out << r.err;
    EXPECT_NE(r.err.find(reason), std::string::npos) << r.err;
  };
  answer({"b.exr", "chain.exr", "--max-error", "1"}, 1, "b.exr has 1 level, chain.exr has 4");
  answer({"b.exr", "chain.exr", "--max-error", "1", "--level", "0"}, 0, "");
  answer({"b.exr", "chain.exr"}, 0, "chain.exr has 3 more levels, not compared");
  answer({"chain.exr", "b.exr", "--max-flux", "1e-6"}, 0, "");
  answer({"chain.exr", "b.exr", "--same-levels"}, 1, "chain.exr has 4 levels, b.exr has 1 (--same-levels)");
  answer({"cube.exr", "b.exr", "--same-shape", "-q"}, 1,
         "cube.exr is cube 4x4, b.exr latlong 8x4 forward +z (--same-shape)");
  answer({"half.exr", "b.exr", "--same-depth"}, 1, "half.exr has depth half, b.exr has float (--same-depth)");
  answer({"half.exr", "b.exr", "--golden"}, 0, "");
  answer({"a.exr", "b.exr", "--golden"}, 1, "max 0.5 > 0 (--max-error)");
  answer({"a.exr", "b.exr", "--golden", "--max-error", "0.6"}, 0, "");
  answer({"b.exr", "chain.exr", "--golden"}, 1, "(--same-levels)");
  EXPECT_EQ(
      report(envmap({"compare", "a.exr", "b.exr", "--golden", "--max-rms", "1", "--json"}))["limits"],
      json::parse(
          R"({"max-flux":null,"max-rms":1.0,"max-error":null,"same-shape":true,"same-levels":true,"same-depth":false})"));
}

TEST_F(Compare, WritesTheDifference) {
  EXPECT_EQ(envmap({"compare", "a.exr", "b.exr", "--difference", "d.exr", "--max-error", "0.1"}).status, 1);
  Picture expected = Picture::filled(width, height, 0);
  expected.at(5, 1)[1] = 0.5;
  EXPECT_EQ(load(path("d.exr")), expected);
}

// Level 0 of both is a.exr; plain means give other further levels.
TEST_F(Compare, LooksAtEveryLevel) {
  succeeds({"mipmap", "a.exr", "chain.exr", "--depth", "float"});
  succeeds({"mipmap", "a.exr", "plain.exr", "--depth", "float", "--weights", "uniform"});
  const Result r = envmap({"compare", "plain.exr", "chain.exr", "--max-error", "1e-6", "--json"});
  EXPECT_EQ(r.status, 1);
  const json j = json::parse(r.out);
  EXPECT_EQ(j["max"], 0);
  ASSERT_EQ(j["levels"].size(), 3U);
  EXPECT_NE(envmap({"compare", "plain.exr", "chain.exr"}).out.find("\nlevel 0 is identical\n"), std::string::npos);
  EXPECT_NE(envmap({"compare", "chain.exr", "chain.exr"}).out.find("\nidentical\n"), std::string::npos);
  EXPECT_GT(j["levels"][0]["max"].get<double>(), 1e-3);
  EXPECT_EQ(j["broken"][0]["level"], 1);
  EXPECT_EQ(j["broken"][0]["value"], j["levels"][0]["max"]);
  succeeds({"compare", "plain.exr", "chain.exr", "--max-error", "1e-6", "--level", "0"});
  // Levels of A alone have no texels to be held against.
  const Result longer = envmap({"compare", "chain.exr", "a.exr", "--max-error", "1"});
  EXPECT_EQ(longer.status, 1);
  EXPECT_NE(longer.err.find("chain.exr has 4 levels, a.exr has 1: use --level 0 to compare one level, or --max-flux "
                            "alone\n"),
            std::string::npos)
      << longer.err;
  const Result more = envmap({"compare", "chain.exr", "a.exr"});
  EXPECT_EQ(more.status, 0);
  EXPECT_NE(more.err.find("chain.exr has 3 more levels, compared by flux alone"), std::string::npos) << more.err;
}

TEST_F(Compare, ResamplesEveryLevel) {
  for (const auto& [to, size] : {std::pair("latlong", "64"), std::pair("cube", "32")}) {
    succeeds({"generate", "gradient", "base.exr", "-q", "--to", to, "--size", size});
    succeeds({"mipmap", "base.exr", std::string(to) + ".exr", "--depth", "float"});
  }
  const json j = report(envmap({"compare", "latlong.exr", "cube.exr", "--json"}));
  EXPECT_EQ(j["resampled"], true);
  ASSERT_EQ(j["levels"].size(), 7U);  // Those of the panorama; the cube lacks the last two.
  for (std::size_t k = 0; k < 5; ++k) EXPECT_LT(j["levels"][k]["rms"].get<double>(), 0.2) << k;
  EXPECT_TRUE(j["levels"][5]["rms"].is_null());
  EXPECT_EQ(envmap({"compare", "cube.exr", "cube.exr", "--max-error", "0"}).status, 0);
}

TEST_F(Compare, WritesTheDifferenceOfEveryLevel) {
  succeeds({"mipmap", "a.exr", "chain.exr", "--depth", "float"});
  succeeds({"mipmap", "a.exr", "plain.exr", "--depth", "float", "--weights", "uniform"});
  const json j = report(envmap({"compare", "plain.exr", "chain.exr", "--json", "--difference", "d.exr"}));
  EXPECT_EQ(report(envmap({"info", "d.exr", "--json"}))["levels"], 4);
  EXPECT_EQ(report(envmap({"info", "d.exr", "--json"}))["maximum"], (json{0, 0, 0}));
  EXPECT_GT(report(envmap({"info", "d.exr", "--level", "1", "--json"}))["maximum"][1].get<double>(), 1e-4);
  succeeds({"compare", "plain.exr", "chain.exr", "--difference", "d{level}.hdr"});
  EXPECT_FALSE(read("d3.hdr").empty());
  const Result one = envmap({"compare", "plain.exr", "chain.exr", "--difference", "d.hdr"});
  EXPECT_EQ(one.status, 0);
  EXPECT_NE(one.err.find("d.hdr holds level 0 alone"), std::string::npos) << one.err;
}

TEST_F(Compare, ResamplesTheFirstToTheSecond) {
  succeeds({"generate", "gradient", "cube.exr", "--to", "cube", "--size", "32"});
  succeeds({"generate", "gradient", "latlong.exr", "--size", "16"});
  const Result r =
      envmap({"compare", "cube.exr", "latlong.exr", "--json", "--filter", "bilinear", "--max-error", "0.01"});
  EXPECT_EQ(r.status, 0) << r.out << r.err;
  EXPECT_EQ(report(r)["resampled"], true);
}

TEST_F(Compare, TexelsThatAnAxisOnlyMovesAreTheSame) {
  succeeds({"convert", "a.exr", "turned.exr", "--forward", "+x"});
  EXPECT_NE(envmap({"compare", "turned.exr", "a.exr"}).out.find("\nidentical\n"), std::string::npos);
  // A file that cannot hold its axis.
  succeeds({"convert", "a.exr", "turned.pfm", "--forward", "-x", "-q"});
  EXPECT_NE(envmap({"compare", "a.exr", "turned.pfm", "--from-forward-b", "-x"}).out.find("\nidentical\n"),
            std::string::npos);
}

TEST_F(Compare, SaysWhichLimitIsExceededEvenWhereTheDifferenceCannotBeWritten) {
  const Result r =
      envmap({"compare", "a.exr", "b.exr", "--max-error", "0.1", "--difference", "d.exr"}, {.largest_file = 64});
  EXPECT_EQ(r.status, 4) << r.err;
  EXPECT_NE(r.err.find("(--max-error)"), std::string::npos) << r.err;
}

// ---- convert --max-error --------------------------------------------------------------------------------------------

TEST_F(Compare, JudgesTheFilterThatMaxErrorChose) {
  succeeds({"generate", "sun", "sun.exr", "--size", "64", "--direction", "1,1,2"});
  succeeds(
      {"convert", "sun.exr", "truth.exr", "--to", "cube", "--size", "8", "--filter", "area", "--area-error", "1e-5"});
  const Result chosen =
      envmap({"convert", "sun.exr", "small.exr", "--to", "cube", "--size", "8", "--max-error", "1e-2"});
  EXPECT_EQ(chosen.status, 0) << chosen.err;
  EXPECT_NE(chosen.err.find("rms"), std::string::npos) << "what was chosen, and what it does";
  EXPECT_EQ(envmap({"compare", "small.exr", "truth.exr", "--max-error", "1.5e-2", "--max-rms", "1e-2"}).status, 0);
  // At the back of a mirror ball texels span tens of degrees, and even the mean has an end.
  succeeds({"convert", "sun.exr", "ball.exr", "--to", "sphere", "--size", "32"});
  fails(1, {"convert", "ball.exr", "none.exr", "--to", "cube", "--size", "8", "--max-error", "1e-6"},
        {"cannot meet", "area"});
  // What the file rounds by counts.
  fails(1, {"convert", "sun.exr", "none.exr", "--to", "cube", "--size", "8", "--depth", "half", "--max-error", "4e-4"},
        {"half", "4.9e-04", "--depth float"});
  succeeds({"convert", "sun.exr", "half.exr", "--to", "cube", "--size", "8", "--depth", "half", "--max-error", "2e-3",
            "-q"});
  EXPECT_EQ(envmap({"compare", "half.exr", "truth.exr", "--max-error", "2.2e-3"}).status, 0);
}

// ---- help, pages, completions ---------------------------------------------------------------------------------------

TEST_F(Compare, AnAreaErrorThatTakesLongIsSaidBeforehand) {
  succeeds({"generate", "sun", "sun.exr", "--size", "16", "--direction", "1,1,2"});
  const auto made = [&](const char* error) {
    return envmap(
        {"convert", "sun.exr", "out.exr", "--to", "cube", "--size", "4", "--filter", "area", "--area-error", error});
  };
  EXPECT_NE(made("1e-6").err.find("10 times as long as 1e-4"), std::string::npos);
  EXPECT_EQ(made("1e-5").err, "");
}

class Help : public CommandTest {
 protected:
  /// Every command there is, as the pages have them.
  [[nodiscard]] std::vector<std::string> commands() const {
    succeeds({"manual", "."});
    std::vector<std::string> all;
    for (const std::string& page : names())
      if (page.starts_with("envmap-") && page.ends_with(".1")) all.push_back(page.substr(7, page.size() - 9));
    EXPECT_GE(all.size(), 5U);
    return all;
  }

  void succeeds_and_prints(const std::vector<std::string>& arguments, const std::string& file) const {
    const Result r = envmap(arguments);
    EXPECT_EQ(r.status, 0) << r.err;
    write(file, r.out);
  }
};

TEST_F(Help, OfEachCommandHasTwoExamples) {
  const std::string overview = envmap({"--help"}).out;
  for (const std::string& command : commands()) {
    SCOPED_TRACE(command);
    EXPECT_NE(overview.find("\n  " + command + " "), std::string::npos);
    const Result r = envmap({command, "--help"});
    EXPECT_EQ(r.status, 0);
    EXPECT_EQ(r.err, "");
    const std::size_t at = r.out.find("\nExamples:\n");
    ASSERT_NE(at, std::string::npos);
    // A command at an indent of 2, what it does below at an indent of 6.
    std::istringstream lines(r.out.substr(at));
    int examples = 0;
    for (std::string line, last; std::getline(lines, line); last = line)
      examples += last.starts_with("  ") && last[2] != ' ' && last.find("envmap") != std::string::npos &&
                  line.starts_with("      ");
    EXPECT_GE(examples, 2) << r.out;
  }
}

TEST_F(Help, KnowsTheVersion) {
  const Result r = envmap({"--version"});
  EXPECT_EQ(r.status, 0);
  EXPECT_TRUE(std::regex_match(
      r.out, std::regex("envmap \\d+\\.\\d+\\.\\d+( \\([0-9a-f]{7,}\\+?\\))?\nwith OpenEXR \\d[^\n]*, zstd \\d\\S*\n"
                        "draws with (EGL|OSMesa), [^\n]+, OpenGL \\d[^\n]*\n")))
      << r.out;
}

TEST_F(Help, IsWhatTheRepositorysPagesSay) {
  succeeds({"manual", "."});
  std::map<std::string, std::string> kept;
  ASSERT_TRUE(std::filesystem::is_directory(ENVMAP_MAN_DIR));
  const auto made = files();
  for (const auto& entry : std::filesystem::directory_iterator(ENVMAP_MAN_DIR))
    if (const std::string name = entry.path().filename().string(); name.ends_with(".1") || made.contains(name))
      kept[name] = bytes_of(entry.path());
  EXPECT_EQ(kept, made) << "run 'envmap manual man' in the repository";
}

// A terminal made by script(1) sees how far the work is, how fast it goes and how long it will take;
// a file sees nothing.
TEST_F(Help, LongWorkTellsATerminalHowLongItTakes) {
#ifdef ENVMAP_SANITIZED
  GTEST_SKIP() << "too slow to get anywhere in time";
#endif
  if (shell("command -v script").status != 0) GTEST_SKIP() << "script is not installed";
  succeeds({"generate", "sky", "sky.exr", "--size", "512"});
  const std::string job = "\"$ENVMAP\" prefilter sky.exr x.exr --method exact --size 24";
  const Result seen = shell("script -qec 'timeout 4 " + job + "' /dev/null");
  EXPECT_TRUE(std::regex_search(seen.out, std::regex(R"(prefilter diffuse +\d+%, [\d.e-]+%/s, [\d:]+ (s|min|h) left)")))
      << seen.out;
  EXPECT_EQ(shell("timeout 2 " + job).err, "");
  EXPECT_EQ(names(), std::vector<std::string>{"sky.exr"});
}

TEST_F(Help, HasPagesThatMandocAccepts) {
  if (shell("command -v mandoc").status != 0) GTEST_SKIP() << "mandoc is not installed";
  succeeds({"manual", "."});
  const Result r =
      shell("mandoc -T lint -W error *.1 " + std::string(ENVMAP_MAN_DIR) + "/*.3 " + ENVMAP_MAN_DIR + "/*.7");
  EXPECT_EQ(r.status, 0) << r.out << r.err;
}

// A table that is too wide, or a line that cannot be broken.
TEST_F(Help, HasPagesThatFit80Columns) {
  if (shell("command -v groff tbl").status != 0) GTEST_SKIP() << "groff is not installed";
  succeeds({"manual", "."});
  const std::string folder = ENVMAP_MAN_DIR;
  EXPECT_EQ(shell("for p in *.1 *.7 " + folder + "/*.3 " + folder +
                  "/*.7; do groff -t -man -Tutf8 -rLL=78n $p >out || echo $p; done")
                .err,
            "");
}

TEST_F(Help, CompletesInBash) {
  const Result script = envmap({"completion"});
  EXPECT_EQ(script.status, 0);
  write("envmap.bash", script.out);
  ASSERT_EQ(shell("bash -n envmap.bash").status, 0);
  const auto completed = [&](const std::string& words, int at) {
    write("try.bash", "source ./envmap.bash\nCOMP_WORDS=(" + words + ")\nCOMP_CWORD=" + std::to_string(at) +
                          "\n_envmap\necho \"${COMPREPLY[*]}\"\n");
    return shell("bash try.bash").out;
  };
  EXPECT_EQ(completed("envmap conv", 1), "convert\n");
  EXPECT_EQ(completed("envmap convert --to cu", 3), "cube\n");
  EXPECT_EQ(completed("envmap convert --repa", 2), "--repair\n");
  EXPECT_EQ(completed("envmap generate di", 2), "directions\n");
  EXPECT_EQ(completed("envmap convert --output-space ACESc", 3), "ACEScg\n");
  std::istringstream spaces(completed("envmap convert --output-space ''", 3));
  succeeds({"generate", "constant", "one.exr", "--size", "2"});
  int count = 0;
  for (std::string space; spaces >> space; ++count)
    succeeds({"convert", "one.exr", "out.exr", "--output-space", space, "--encoded"});
  EXPECT_EQ(count, 8);
  EXPECT_EQ(completed("envmap convert --size ''", 3), "\n") << "a number is expected, no option";
}

TEST_F(Help, CompletesInFish) {
  if (shell("command -v fish").status != 0) GTEST_SKIP() << "fish is not installed";
  succeeds_and_prints({"completion", "fish"}, "envmap.fish");
  const auto completed = [&](const std::string& line) {
    // One completion a line, with its description after a tab.
    return shell("HOME=$PWD fish --no-config -c 'source envmap.fish; complete -C \"" + line + "\"' | cut -f 1").out;
  };
  EXPECT_EQ(completed("envmap conv"), "convert\n");
  EXPECT_EQ(completed("envmap convert --to cu"), "cube\n");
  // fish 4 adds what holds these letters apart: --ignore-envmap-attribute.
  EXPECT_EQ(completed("envmap convert --repa").rfind("--repair\n", 0), 0U);
  EXPECT_EQ(completed("envmap generate directi"), "directions\n");
}

TEST_F(Help, CompletesInZsh) {
  if (shell("command -v zsh").status != 0) GTEST_SKIP() << "zsh is not installed";
  succeeds_and_prints({"completion", "zsh"}, "_envmap");
  // zsh completes at a terminal alone: it is given one, a line and a tab, and what stands there then is echoed.
  const auto completed = [&](const std::string& line) {
    write("try.zsh", R"(zmodload zsh/zpty
zpty shell zsh -f -i
zpty -w shell 'PS1= fpath=($PWD $fpath); unsetopt zle_bracketed_paste; autoload -U compinit; compinit -u -D; stty -echo; show() { print -r - "<$BUFFER>"; BUFFER=; zle accept-line }; zle -N show; bindkey "^X" show; echo ready'
zpty -r -m shell text $'*ready\r\n*'
zpty -w -n shell $')" + line +
                         R"(\t\C-x'
zpty -r -m shell text '*<*>*'
[[ $text =~ '<([^>]*)>' ]] && print -r - $match[1]
)");
    return shell("HOME=$PWD timeout 20 zsh -f try.zsh").out;
  };
  EXPECT_EQ(completed("envmap conv"), "envmap convert \n");
  EXPECT_EQ(completed("envmap convert --to cu"), "envmap convert --to cube \n");
  EXPECT_EQ(completed("envmap convert --repa"), "envmap convert --repair \n");
  EXPECT_EQ(completed("envmap generate directi"), "envmap generate directions \n");
}

}  // namespace
}  // namespace command_tests::report_test

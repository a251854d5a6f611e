// Differences of maps, and what --max-error of convert promises by them.
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <regex>

#include "picture.h"
#include "run.h"

namespace command_tests::compare_test {
namespace {

using nlohmann::json;

constexpr double pi = std::numbers::pi;

void expect_near(const json& values, const Vec& expected, double tolerance) {
  ASSERT_EQ(values.size(), 3U) << values;
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(values[k].get<double>(), expected.at(k), tolerance) << values;
}

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
  succeeds({"convert", "a.exr", "own.exr"});
  EXPECT_NE(envmap({"compare", "turned.pfm", "own.exr", "--from-forward", "-x"}).out.find("\nidentical\n"),
            std::string::npos)
      << "own.exr records its own axis";
}

TEST_F(Compare, SaysWhichLimitIsExceededEvenWhereTheDifferenceCannotBeWritten) {
  const Result r =
      envmap({"compare", "a.exr", "b.exr", "--max-error", "0.1", "--difference", "d.exr"}, {.largest_file = 64});
  EXPECT_EQ(r.status, 4) << r.err;
  EXPECT_NE(r.err.find("(--max-error)"), std::string::npos) << r.err;
}

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

TEST_F(Compare, AnAreaErrorThatTakesLongIsSaidBeforehand) {
  succeeds({"generate", "sun", "sun.exr", "--size", "16", "--direction", "1,1,2"});
  const auto made = [&](const char* error) {
    return envmap(
        {"convert", "sun.exr", "out.exr", "--to", "cube", "--size", "4", "--filter", "area", "--area-error", error});
  };
  EXPECT_NE(made("1e-6").err.find("10 times as long as 1e-4"), std::string::npos);
  EXPECT_EQ(made("1e-5").err, "");
}

}  // namespace
}  // namespace command_tests::compare_test

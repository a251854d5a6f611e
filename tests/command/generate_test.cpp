// envmap generate: what its report says is what another command reads from the file.
#include <nlohmann/json.hpp>

#include "picture.h"
#include "run.h"

namespace command_tests::generate_test {
namespace {

class Generate : public CommandTest {};

// info adds up the texels of the file; the report's figures are integrals over the sky.
TEST_F(Generate, AnAtmosphereSaysTheLuxThatItsFileHas) {
  for (const char* to : {"latlong", "cube"}) {
    const nlohmann::json all =
        report({"generate", "atmosphere", "all.exr", "--to", to, "--size", "256", "--elevation", "40"});
    const nlohmann::json sky =
        report({"generate", "atmosphere", "sky.exr", "--to", to, "--size", "256", "--elevation", "40", "--no-sun"});
    const double sun_lux = all["sun"]["horizontal_illuminance"], sky_lux = all["sky"]["horizontal_illuminance"];
    EXPECT_EQ(sky["sun"]["horizontal_illuminance"], sun_lux);
    const auto lux = [&](const char* file) { return report({"info", file})["illuminance"]["lux"].get<double>(); };
    EXPECT_NEAR(lux("all.exr"), sun_lux + sky_lux, 1e-3 * (sun_lux + sky_lux)) << to;
    EXPECT_NEAR(lux("sky.exr"), sky_lux, 2e-3 * sky_lux) << to;
    EXPECT_NEAR(all["sun"]["illuminance"].get<double>() * std::sin(40 * std::acos(-1) / 180), sun_lux, 0.01 * sun_lux);
  }
}

TEST_F(Generate, TheSunOfAnAtmosphereIsWhereItWasAskedFor) {
  succeeds({"generate", "atmosphere", "a.exr", "--size", "64", "--elevation", "30", "--azimuth", "90", "-q"});
  succeeds({"generate", "atmosphere", "b.exr", "--size", "64", "--direction", "1.7320508,1,0", "-q"});
  EXPECT_EQ(envmap({"compare", "a.exr", "b.exr", "--max-error", "1e-4"}).status, 0);
  const auto d = report({"info", "a.exr"})["brightest"]["direction"];
  EXPECT_GT(d[0].get<double>() * std::sqrt(0.75) + d[1].get<double>() * 0.5, 0.999);
}

TEST_F(Generate, RefusesOptionsOfOtherKinds) {
  for (const std::vector<std::string>& words : {std::vector<std::string>{"sky", "--turbidity", "3"},
                                                {"sun", "--no-sun"},
                                                {"constant", "--radius", "2"},
                                                {"sky", "--value", "2"},
                                                {"sun", "--value2", "2"},
                                                {"directions", "--value", "2"},
                                                {"faces", "--degree", "2"},
                                                {"checker", "--ground", "2"},
                                                {"atmosphere", "--no-sun", "--radius", "2"},
                                                {"atmosphere", "--zenith", "1,1,1"},
                                                {"atmosphere", "--value", "2"},
                                                {"atmosphere", "--elevation", "3", "--direction", "0,1,0"},
                                                {"atmosphere", "--elevation", "91"},
                                                {"atmosphere", "--turbidity", "nan"}}) {
    std::vector<std::string> all{"generate", words[0], "x.exr"};
    all.insert(all.end(), words.begin() + 1, words.end());
    const Result r = envmap(all);
    EXPECT_EQ(r.status, 2) << r.err;
    EXPECT_NE(r.err.find(words[1]), std::string::npos) << r.err;
    EXPECT_FALSE(std::filesystem::exists(path("x.exr")));
  }
}

TEST_F(Generate, RefusesNegativeRadiance) {
  fails(2, {"generate", "sun", "x.exr", "--value", "-1"}, {"radiance must be finite and at least 0"});
  fails(2, {"generate", "sky", "x.exr", "--ground", "0,-1,0"}, {"ground must be finite and at least 0"});
  fails(2, {"generate", "constant", "x.exr", "--value", "-1"}, {"negative"});
}

TEST_F(Generate, ANameAfterTwoDashesMayBeginWithOne) {
  succeeds({"generate", "constant", "--size", "8", "--", "-y.exr"});
  EXPECT_TRUE(std::filesystem::exists(path("-y.exr")));
}

}  // namespace
}  // namespace command_tests::generate_test

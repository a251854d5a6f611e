// prefilter and sh as their users run them: files, metadata, chains, the same bytes for any number of threads, errors.
#include <fstream>
#include <nlohmann/json.hpp>

#include "picture.h"
#include "run.h"

namespace command_tests::prefilter_test {
namespace {

constexpr int no = 1, usage = 2, bad_input = 3, not_written = 4;

class Prefilter : public CommandTest {
 protected:
  Prefilter() { succeeds({"generate", "sun", "in.exr", "--size", "16", "--radius", "8", "--value", "300"}); }

  [[nodiscard]] std::string attribute(const std::string& file, const std::string& name) const {
    const auto input = OIIO::ImageInput::open(path(file));
    return input ? std::string(input->spec().get_string_attribute(name)) : "";
  }
};

TEST_F(Prefilter, WritesADiffuseCubeOf64AndSaysHowItWent) {
  const Result r = envmap({"prefilter", "in.exr", "out.exr"});
  ASSERT_EQ(r.status, 0) << r.err;
  EXPECT_NE(r.err.find("diffuse, 64: prefix-sums"), std::string::npos) << r.err;
  EXPECT_NE(r.err.find("every texel to "), std::string::npos) << r.err;
  const Picture p = load(path("out.exr"));
  EXPECT_EQ(p.width, 64);
  EXPECT_EQ(p.height, 384);
  EXPECT_EQ(attribute("out.exr", "envmap:lobe"), "diffuse");
}

TEST_F(Prefilter, MethodsAgree) {
  // The second is what treecode was called before.
  for (const char* method : {"exact", "hierarchical"})
    succeeds({"prefilter", "in.exr", std::string(method) + ".exr", "--lobe", "phong", "--exponent", "6", "--size", "4",
              "--depth", "float", "--method", method, "--max-error", "5e-2", "-q"});
  EXPECT_EQ(envmap({"compare", "hierarchical.exr", "exact.exr", "--max-error", "5e-2"}).status, 0);
}

TEST_F(Prefilter, AMirrorsLevelSaysItsError) {
  const std::vector<std::string> chain{"prefilter", "in.exr", "chain.exr", "--lobe", "ggx",
                                       "--levels",  "2",      "--size",    "8"};
  const Result r = envmap(chain);
  EXPECT_NE(r.err.find("ggx 0, 8: area, "), std::string::npos) << r.err;
  EXPECT_NE(r.err.find("every texel to "), std::string::npos) << r.err;
  std::vector<std::string> as_json = chain;
  as_json.insert(as_json.end(), {"--json", "-q"});
  const auto level = nlohmann::json::parse(envmap(as_json).out)["levels"][0];
  EXPECT_EQ(level["method"], "area");
  EXPECT_LE(level["max"].get<double>(), 1e-3);
  EXPECT_GT(level["max"].get<double>(), 0);
}

TEST_F(Prefilter, TakesALobeOfAFile) {
  std::ofstream(path("lobe.txt")) << "degrees\n0 1\n20 0.5\n60 0\n";
  const std::vector<std::string> wanted{"prefilter", "in.exr", "out.exr", "--lobe-table", "lobe.txt", "--size", "8"};
  const Result r = envmap(wanted);
  ASSERT_EQ(r.status, 0) << r.err;
  EXPECT_NE(r.err.find("table, 8: treecode"), std::string::npos) << r.err;
  EXPECT_EQ(attribute("out.exr", "envmap:lobe"), "table");
  const auto refused = [&](std::vector<std::string> more, int status, const std::string& words) {
    more.insert(more.begin(), wanted.begin(), wanted.end());
    const Result failed = envmap(more);
    EXPECT_EQ(failed.status, status) << failed.err;
    EXPECT_NE(failed.err.find(words), std::string::npos) << failed.err;
  };
  refused({"--lobe", "ggx"}, usage, "--lobe");
  refused({"--levels", "3"}, usage, "--levels: a map of a table has one");
  refused({"--roughness", "0.5"}, usage, "--roughness is for --lobe ggx and charlie");
  refused({"--method", "exact"}, usage, "treecode");
  refused({"--for", "filament"}, usage, "remove --lobe-table");
  refused({"--brdf-table", "b.exr"}, usage, "remove --brdf-table");
  std::ofstream(path("lobe.txt")) << "1 1\n0.5\n";
  refused({}, bad_input, "lobe.txt: line 2: must be a cosine and a value");
}

// The figure is that of the file. Colours whose channels are far apart lose most under a shared exponent.
TEST_F(Prefilter, MaxErrorHoldsForWhatIsReadBack) {
  succeeds({"generate", "gradient", "orange.exr", "--size", "8", "--value", "1,0.3,0.06", "--value2", "3,0.5,0.11"});
  const auto made = [&](const std::string& file, const char* depth, const char* error) {
    return envmap({"prefilter", "orange.exr", file, "--size", "8", "--depth", depth, "--max-error", error, "-q"});
  };
  succeeds({"prefilter", "orange.exr", "exact.exr", "--size", "8", "--depth", "float", "--method", "exact", "-q"});
  for (const auto& [file, depth, error] : {std::tuple{"a.dds", "half", "6e-4"},
                                           {"b.exr", "half", "1e-3"},
                                           {"c.dds", "rgb9e5", "8e-2"},
                                           {"d.dds", "float", "1e-5"},
                                           {"e.hdr", "float", "1e-1"}}) {
    const Result r = made(file, depth, error);
    EXPECT_EQ(r.status, 0) << r.err;
    EXPECT_EQ(envmap({"compare", file, "exact.exr", "--max-error", error}).status, 0) << file;
  }
  for (const auto& [file, depth, error, better] : {std::tuple{"f.dds", "half", "4e-4", "--depth float"},
                                                   {"f.dds", "rgb9e5", "1e-3", "--depth half"},
                                                   {"f.dds", "rgb9e5", "5e-3", "--depth half"},
                                                   {"f.hdr", "float", "1e-3", ".exr"}}) {
    const Result r = made(file, depth, error);
    EXPECT_EQ(r.status, no) << file << " " << depth;
    EXPECT_NE(r.err.find(better), std::string::npos) << r.err;
    EXPECT_FALSE(std::filesystem::exists(path(file)));
  }
  // Without an error asked for, a depth is no reason to refuse; nor are samples between texels.
  succeeds({"prefilter", "orange.exr", "g.dds", "--size", "8", "--depth", "rgb9e5", "-q"});
  succeeds({"prefilter", "orange.exr", "h.exr", "--size", "8", "--openexr-envmap", "-q"});
  for (const std::vector<std::string>& command : {std::vector<std::string>{"prefilter"}, {"convert", "--to", "cube"}}) {
    std::vector<std::string> all{command[0], "orange.exr",       "i.exr",       "--size",
                                 "8",        "--openexr-envmap", "--max-error", "1e-1"};
    all.insert(all.end(), command.begin() + 1, command.end());
    const Result r = envmap(all);
    EXPECT_EQ(r.status, no) << r.err;
    EXPECT_NE(r.err.find("--openexr-envmap"), std::string::npos) << r.err;
    EXPECT_FALSE(std::filesystem::exists(path("i.exr")));
  }
}

TEST_F(Prefilter, AChainHoldsOneNumberALevel) {
  succeeds({"prefilter", "in.exr", "ggx.exr", "--lobe", "ggx", "--levels", "3", "--size", "8", "-q"});
  EXPECT_EQ(attribute("ggx.exr", "envmap:roughness"), "0,0.5,1");
  succeeds(
      {"prefilter", "in.exr", "phong_{level}.hdr", "--lobe", "phong", "--exponents", "40,10", "--size", "8", "-q"});
  EXPECT_EQ(load(path("phong_0.hdr")).width, 8);
  EXPECT_EQ(load(path("phong_1.hdr")).width, 4);
  // The second level is the map of its exponent.
  succeeds({"prefilter", "in.exr", "one.hdr", "--lobe", "phong", "--exponent", "10", "--size", "4", "-q"});
  EXPECT_EQ(difference(load(path("phong_1.hdr")), load(path("one.hdr"))), 0);
}

TEST_F(Prefilter, ASheenChainSaysItsLobe) {
  succeeds({"prefilter", "in.exr", "sheen.exr", "--lobe", "charlie", "--levels", "3", "--size", "8", "-q"});
  EXPECT_EQ(attribute("sheen.exr", "envmap:lobe"), "charlie");
  EXPECT_EQ(attribute("sheen.exr", "envmap:roughness"), "0,0.5,1");
}

TEST_F(Prefilter, APhongChainFallsByQuartersOrToLambertsCosine) {
  const auto exponents = [&](const char* first, const char* levels) {
    succeeds({"prefilter", "in.exr", "chain.exr", "--lobe", "phong", "--exponent", first, "--levels", levels, "--size",
              "16", "--max-error", "1e-2", "-q"});
    return attribute("chain.exr", "envmap:exponent");
  };
  EXPECT_EQ(exponents("64", "3"), "64,16,4");
  EXPECT_EQ(exponents("64", "4"), "64,16,4,1");
  EXPECT_EQ(exponents("64", "5"), "64,22.6274,8,2.82843,1");  // A root of 64 each.
  EXPECT_EQ(exponents("0.5", "2"), "0.5,0.5");
}

TEST_F(Prefilter, ScaleIsTheFactor) {
  succeeds({"generate", "constant", "white.exr", "--size", "4", "--value", "1"});
  succeeds({"prefilter", "white.exr", "out.exr", "--lobe", "diffuse", "--scale", "3", "--size", "2", "-q"});
  EXPECT_NEAR(load(path("out.exr")).values[0], 3, 2e-3);
  succeeds(
      {"prefilter", "white.exr", "out.exr", "--lobe", "phong", "--exponent", "3", "--scale", "1", "--size", "2", "-q"});
  EXPECT_NEAR(load(path("out.exr")).values[0], 2 * 3.14159265 / 4, 2e-3);
}

TEST_F(Prefilter, RefusesWhatMakesNoSense) {
  fails(usage, {"prefilter"}, {"INPUT", "OUTPUT"});
  fails(usage, {"prefilter", "in.exr"}, {"OUTPUT"});
  fails(usage, {"prefilter", "in.exr", "out.exr", "--lobe", "phong"}, {"--exponent"});
  fails(usage, {"prefilter", "in.exr", "out.exr", "--lobe", "ggx"}, {"--roughness"});
  fails(usage, {"prefilter", "in.exr", "out.exr", "--roughness", "0.5"}, {"--roughness", "ggx"});
  fails(usage, {"prefilter", "in.exr", "out.exr", "--lobe", "ggx", "--exponent", "5"}, {"--exponent", "phong"});
  fails(usage, {"prefilter", "in.exr", "out.exr", "--lobe", "ggx", "--roughness", "2"}, {"--roughness"});
  fails(usage, {"prefilter", "in.exr", "out.exr", "--lobe", "phong", "--exponent", "-1"}, {"--exponent"});
  fails(usage, {"prefilter", "in.exr", "out.exr", "--lobe", "velvet"}, {"velvet", "diffuse"});
  fails(usage, {"prefilter", "in.exr", "out.exr", "--levels", "3"}, {"--levels", "diffuse"});
  fails(usage, {"prefilter", "in.exr", "out.exr", "--lobe", "charlie"}, {"charlie", "--roughness"});
  fails(usage, {"prefilter", "in.exr", "out.exr", "--lobe", "charlie", "--roughness", "1", "--method", "multilevel"},
        {"multilevel", "ggx"});
  fails(usage, {"prefilter", "in.exr", "out.exr", "--lobe", "phong", "--exponents", "9,3", "--levels", "3"},
        {"--levels"});
  fails(usage, {"prefilter", "--brdf-table", "out.png"}, {"out.png", ".exr"});
  fails(bad_input, {"prefilter", "none.exr", "out.exr"}, {"none.exr"});
  fails(not_written, {"prefilter", "in.exr", "none/out.exr"}, {"none"});
}

TEST_F(Prefilter, WritesTheTableAlone) {
  succeeds({"prefilter", "--brdf-table", "brdf.exr", "--table-size", "8"});
  const Picture p = load(path("brdf.exr"));
  EXPECT_EQ(p.width, 8);
  EXPECT_EQ(p.height, 8);
  // Nearly smooth and seen from above: all of F0, next to nothing more.
  EXPECT_NEAR(p.at(7, 0)[0], 1, 5e-3);
  EXPECT_NEAR(p.at(7, 0)[1], 0, 5e-3);
  succeeds({"prefilter", "--brdf-table", "brdf.tif", "--table-size", "8"});
  for (const std::string name : {"brdf.exr", "brdf.tif"})
    fails(bad_input, {"info", name}, {name + ": is the BRDF table of ggx (8x8), not an environment map"});
}

// GGX's table would be in red and green alone; that of sheen grows with roughness straight ahead, and is grey.
TEST_F(Prefilter, TheTableIsThatOfTheLobe) {
  succeeds({"prefilter", "--lobe", "charlie", "--brdf-table", "sheen.exr", "--table-size", "8"});
  const Picture p = load(path("sheen.exr"));
  for (int j = 0; j < 8; ++j) {
    EXPECT_EQ(p.at(7, j)[0], p.at(7, j)[1]);
    EXPECT_EQ(p.at(7, j)[0], p.at(7, j)[2]);
  }
  for (int j = 1; j < 8; ++j) EXPECT_GT(p.at(7, j)[0], p.at(7, j - 1)[0]);
  succeeds({"prefilter", "--lobe", "ggx", "--brdf-table", "ggx.exr", "--table-size", "8"});
  succeeds({"prefilter", "--brdf-table", "default.exr", "--table-size", "8"});
  EXPECT_TRUE(read("ggx.exr") == read("default.exr"));
  for (const std::string lobe : {"phong", "blinn-phong"}) {
    fails(usage, {"prefilter", "--lobe", lobe, "--brdf-table", "x.exr"}, {lobe, "choose --lobe ggx or --lobe charlie"});
    fails(usage, {"prefilter", "in.exr", "out.exr", "--lobe", lobe, "--exponent", "5", "--brdf-table", "x.exr"},
          {"remove --brdf-table"});
  }
}

TEST_F(Prefilter, CoefficientsAsTextAndJson) {
  succeeds({"generate", "constant", "white.exr", "--size", "4", "--value", "1"});
  const Result text = envmap({"sh", "white.exr", "--irradiance", "--order", "1"});
  ASSERT_EQ(text.status, 0);
  EXPECT_NE(text.out.find("# irradiance to order 1"), std::string::npos);
  const Result json = envmap({"sh", "white.exr", "--json"});
  ASSERT_EQ(json.status, 0);
  const auto report = nlohmann::json::parse(json.out);
  ASSERT_EQ(report["coefficients"].size(), 9U);
  EXPECT_NEAR(report["coefficients"][0][0].get<double>(), 3.5449077, 1e-5);  // sqrt(4 pi)
  EXPECT_NEAR(report["coefficients"][4][1].get<double>(), 0, 1e-5);
  fails(usage, {"sh", "white.exr", "--order", "-1"}, {"--order"});
}

TEST_F(Prefilter, TheWindowThatWasChosenIsStated) {
  succeeds({"generate", "sun", "dark.exr", "--size", "16", "--radius", "8", "--value", "300", "--ground", "0"});
  const Result text = envmap({"sh", "dark.exr", "--irradiance", "--window", "auto"});
  ASSERT_EQ(text.status, 0) << text.err;
  EXPECT_NE(text.out.find("the weakest of no negative irradiance"), std::string::npos) << text.out;
  const Result json = envmap({"sh", "dark.exr", "--window", "auto", "--json"});
  ASSERT_EQ(json.status, 0) << json.err;
  const auto report = nlohmann::json::parse(json.out);
  EXPECT_GT(report["deringing"]["lambda"].get<double>(), 0);
  EXPECT_GT(report["deringing"]["rms"].get<double>(), 0);
  fails(usage, {"sh", "dark.exr", "--window", "auto", "--order", "21"}, {"--window auto", "20"});
  fails(usage, {"sh", "dark.exr", "--window", "blur"}, {"blur", "hann", "auto"});
  EXPECT_EQ(envmap({"sh", "dark.exr", "--window"}).out, envmap({"sh", "dark.exr", "--window", "hann"}).out);
}

TEST_F(Prefilter, SeriesComeBackAsMaps) {
  succeeds({"generate", "sh", "y.exr", "--size", "64", "--degree", "2", "--order", "1"});
  EXPECT_EQ(envmap({"sh", "y.exr", "--evaluate", "back.exr", "--to", "latlong", "--size", "64", "-q"}).status, 0);
  EXPECT_EQ(envmap({"compare", "back.exr", "y.exr", "--max-error", "1e-2"}).status, 0);
}

}  // namespace
}  // namespace command_tests::prefilter_test

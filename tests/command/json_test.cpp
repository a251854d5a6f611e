// What --json prints: the keys that the man pages list, and null for what is not finite.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "picture.h"
#include "run.h"

namespace command_tests::json_test {
namespace {

using nlohmann::json;

class Json : public CommandTest {
 protected:
  Json() {
    save(path("a.exr"), latlong_directions(8));
    save(path("black.exr"), Picture::filled(16, 8, 0));
  }
  // `levels[].flux`, and where each object begins; what lies under metadata or the pointers of not_finite is data.
  static void collect(const json& value, const std::string& path, std::set<std::string>& keys) {
    if (value.is_object())
      for (const auto& [key, member] : value.items()) {
        keys.insert(path + key);
        if (key != "metadata" && key != "not_finite")
          collect(member, path + key + (member.is_array() ? "[]." : "."), keys);
      }
    if (value.is_array())
      for (const json& element : value) collect(element, path, keys);
  }
  // In a man page's section JSON.
  static std::set<std::string> documented(const std::string& command) {
    std::string page = bytes_of(std::filesystem::path(ENVMAP_MAN_DIR) / ("envmap-" + command + ".1"));
    page = page.substr(std::min(page.find("\n.SH JSON\n"), page.size()));
    page = std::regex_replace(page.substr(0, page.find("\n.SH EXAMPLES")), std::regex(R"(\\-)"), "-");
    std::set<std::string> keys;
    static const std::regex bold(R"(\\fB(\S+)\\fR)");
    for (std::sregex_iterator k(page.begin(), page.end(), bold); k != std::sregex_iterator(); ++k) keys.insert((*k)[1]);
    return keys;
  }
};

TEST_F(Json, KeysAreThoseOfTheManPages) {
  succeeds({"mipmap", "a.exr", "levels.exr"});
  const std::vector<std::vector<std::string>> runs{{"info", "a.exr", "--levels", "--sampling"},
                                                   {"info", "black.exr"},
                                                   {"compare", "levels.exr", "levels.exr"},
                                                   {"compare", "a.exr", "black.exr", "--max-rms", "0"},
                                                   {"sh", "a.exr", "--window", "auto"},
                                                   {"convert", "a.exr", "out.exr", "--to", "cube", "--max-error", "1"},
                                                   {"convert", "a.exr", "out.exr"},
                                                   {"mipmap", "a.exr", "out.exr"},
                                                   {"prefilter", "a.exr", "out.exr", "--lobe", "ggx", "--levels", "2",
                                                    "--size", "4"}};
  std::map<std::string, std::set<std::string>> found;
  for (std::vector<std::string> run : runs) {
    run.emplace_back("--json");
    const json j = json::parse(envmap(run).out, nullptr, false);
    ASSERT_TRUE(j.is_object());
    EXPECT_EQ(j["version"], 1);
    collect(j, "", found[run[0]]);
  }
  for (const auto& [command, keys] : found) {
    SCOPED_TRACE(command);
    const std::set<std::string> known = documented(command);
    EXPECT_GE(known.size(), 8U);
    for (const std::string& key : keys) {
      // A key that holds others need not be spoken of itself.
      const bool holds = std::ranges::any_of(known, [&](const std::string& k) {
        return k.starts_with(key + ".") || k.starts_with(key + "[].");
      });
      EXPECT_TRUE(known.contains(key) || holds) << key << " is printed and not in the man page";
    }
  }
}

TEST_F(Json, WhatIsNotFiniteIsNullAndSaysWhy) {
  const json against_black = report(envmap({"compare", "a.exr", "black.exr", "--json"}));
  EXPECT_TRUE(against_black["rms"].is_null());
  EXPECT_EQ(against_black["not_finite"]["/rms"], "infinite");
  const json black = report(envmap({"info", "black.exr", "--json"}));
  EXPECT_TRUE(black["stops"].is_null());
  EXPECT_EQ(black["not_finite"]["/stops"], "nan");
  EXPECT_FALSE(report(envmap({"info", "a.exr", "--json"})).contains("not_finite"));
}

TEST_F(Json, TellsWhatWasMade) {
  const json converted =
      report(envmap({"convert", "a.exr", "out.exr", "--to", "cube", "--max-error", "0.5", "--json"}));
  EXPECT_LE(converted["error"]["max"].get<double>(), 0.5);
  EXPECT_EQ(converted["error"]["within"], true);
  EXPECT_EQ(converted["output"], "out.exr");
  EXPECT_GT(converted["seconds"].get<double>(), 0);
  const json levels = report(envmap({"mipmap", "a.exr", "out.exr", "--json"}));
  ASSERT_EQ(levels["levels"].size(), 5U);
  for (const json& level : levels["levels"])
    for (const json& off : level["flux_difference"]) EXPECT_LT(std::abs(off.get<double>()), 1e-6);
  const json filtered = report(envmap({"prefilter", "a.exr", "out.exr", "--size", "4", "--method", "exact", "--json"}));
  EXPECT_EQ(filtered["levels"][0]["method"], "exact");
  EXPECT_TRUE(filtered["levels"][0]["max"].is_null());
  for (const std::string command : {"convert", "mipmap", "prefilter"})
    fails(2, {command, "a.exr", "-", "--json"}, {"--json", "standard output"});
}

}  // namespace
}  // namespace command_tests::json_test

// Each claim of each format is honoured, refused by its name, or ignored where it cannot change a texel.
#include "claims.h"

#include <set>
#include <sstream>

#include "run.h"

namespace command_tests::claims_test {
namespace {

class Claims : public CommandTest {
 protected:
  void check(const ClaimRow& row) const {
    SCOPED_TRACE(row.format + ": " + row.claim + " in " + row.name);
    write(row.name, row.bytes);
    std::vector<std::string> command{"info", row.name, "--json"};
    command.insert(command.end(), row.options.begin(), row.options.end());
    if (row.becomes == Becomes::refused) {
      std::vector<std::string> words = row.words;
      words.push_back(row.name);
      return fails(3, command, words);
    }
    const Result run = envmap(command);
    ASSERT_EQ(run.status, 0) << run.err;
    const nlohmann::json told = nlohmann::json::parse(run.out);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(told["mean"][k].get<double>(), row.value[k], row.tolerance * std::max(1e-3, row.value[k]));
    check_told(row, told);
  }

 private:
  static void check_told(const ClaimRow& row, const nlohmann::json& told) {
    const nlohmann::json claims = told.value("claims", nlohmann::json::array());
    const auto found = std::ranges::find_if(claims, [&](const auto& c) { return c["name"] == row.claim; });
    ASSERT_NE(found, claims.end()) << claims;
    EXPECT_EQ((*found)["outcome"], row.becomes == Becomes::honoured ? "honoured" : "ignored") << claims;
    EXPECT_EQ(found->contains("reason"), row.becomes == Becomes::ignored) << claims;
    for (const std::string& word : row.words)
      EXPECT_NE((*found)["value"].get<std::string>().find(word), std::string::npos) << claims;
  }
};

std::vector<ClaimRow> all_rows() {
  std::vector<ClaimRow> rows = claims_of_colour();
  for (ClaimRow& row : claims_of_place()) rows.push_back(std::move(row));
  return rows;
}

TEST_F(Claims, AreHonouredOrNamed) {
  for (const ClaimRow& row : all_rows()) check(row);
}

TEST_F(Claims, OfColourAreOverriddenByTheCaller) {
  for (const ClaimRow& row : claims_of_colour()) {
    if (row.name != "p3.png" && row.name != "pq.png" && row.name != "prophoto.tif" && row.name != "items.jpg") continue;
    SCOPED_TRACE(row.name);
    write(row.name, row.bytes);
    const std::vector<std::string> command{"info", row.name, "--json", "--input-space", "lin_rec709"};
    if (row.claim == "gain map") {
      fails(2, command, {"gain map"});
      continue;
    }
    const nlohmann::json told = nlohmann::json::parse(envmap(command).out);
    EXPECT_EQ(told["claims"][0]["outcome"], "overridden") << told["claims"];
    EXPECT_FALSE(told.contains("white_luminance"));
  }
}

// Formats that state nothing which could change a texel, beside the depth of their samples.
const std::set<std::string> without_claims{"PNM", "SGI"};

// Formats of which not every OpenImageIO has a writer to make a test's file with.
const std::set<std::string> without_writer{"JPEG 2000", "HEIF", "AVIF", "WebP"};

// Formats whose claims other suites hold: colour_test.cpp and texture_test.cpp.
const std::set<std::string> elsewhere{"EXR", "KTX2", "Babylon.js .env"};

TEST_F(Claims, HaveARowForEachFormat) {
  write("none.bin", "no image");
  const Result run = envmap({"info", "none.bin"});
  const std::string list = run.err.substr(run.err.find("none of ") + 8);
  std::set<std::string> formats;
  std::istringstream titles(list.substr(0, list.find(" or ")));
  for (std::string title; std::getline(titles, title, ',');) formats.insert(title.substr(title.find_first_not_of(' ')));
  formats.insert(list.substr(list.find(" or ") + 4, list.find('\n') - list.find(" or ") - 4));
  ASSERT_TRUE(formats.contains("EXR")) << run.err;
  for (const ClaimRow& row : all_rows()) formats.erase(row.format);
  for (const auto* set : {&without_claims, &without_writer, &elsewhere})
    for (const std::string& title : *set) formats.erase(title);
  std::string left;
  for (const std::string& title : formats) left += title + "\n";
  EXPECT_EQ(left, "") << "formats without a row in the table of claims";
}

}  // namespace
}  // namespace command_tests::claims_test

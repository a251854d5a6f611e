// Gain maps by the formulae of their specifications.
#include "envmap/io/claims/gain_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "envmap/base/error.h"

namespace envmap::gain_map_test {
namespace {

GainMap map_of(int width, int height, int channels, std::vector<unsigned char> values) {
  GainMap map{.metadata = "test", .headroom = 4};
  map.of.fill({.least = -1, .most = 4, .gamma = 1, .base_offset = 0.25, .offset = 0.5});
  map.width = width, map.height = height, map.channels = channels, map.values = std::move(values);
  return map;
}

double light(double base, double share) { return (base + 0.25) * std::exp2(-1 + 5 * share) - 0.5; }

TEST(GainMap, LiesBetweenTheCentresOfItsTexels) {
  // Four texels over two: their centres are a quarter of a texel off those of the gain map's.
  const GainMap map = map_of(2, 1, 1, {0, 255});
  std::vector<Colour> row(4, Colour(1));
  apply_gain(map, 1, 0, 1, row);
  const double shares[] = {0, 0.25, 0.75, 1};
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(row[k].y, light(1, shares[k]), 1e-5) << k;
  // The same of rows.
  const GainMap rows = map_of(1, 2, 1, {0, 255});
  for (int y = 0; y < 4; ++y) {
    std::vector<Colour> one(1, Colour(1));
    apply_gain(rows, 1, y, 4, one);
    EXPECT_NEAR(one[0].x, light(1, shares[y]), 1e-5) << y;
  }
}

TEST(GainMap, HasAGainForEachChannel) {
  GainMap map = map_of(1, 1, 3, {0, 51, 255});
  map.of[1].gamma = 2;
  std::vector<Colour> row(1, Colour(1, 0.5F, 0.25F));
  apply_gain(map, 1, 0, 1, row);
  EXPECT_NEAR(row[0].x, light(1, 0), 1e-5);
  EXPECT_NEAR(row[0].y, light(0.5, std::sqrt(0.2)), 1e-5);
  EXPECT_NEAR(row[0].z, light(0.25, 1), 1e-5);
  std::vector<Colour> black(1, Colour(0));
  apply_gain(map, 1, 0, 1, black);
  EXPECT_EQ(black[0].x, 0) << "no light is below 0";
}

TEST(GainMap, IsGivenInPartToScreensOfLessHeadroom) {
  GainMap map = map_of(1, 1, 1, {255});
  map.base_headroom = 1;
  EXPECT_EQ(map.weight({}), 1);
  EXPECT_EQ(map.weight(0.5), 0);
  EXPECT_EQ(map.weight(2.5), 0.5);
  EXPECT_EQ(map.weight(9), 1);
}

TEST(GainMap, SaysHowCoarseItIs) {
  GainMap map = map_of(2, 3, 1, std::vector<unsigned char>(6));
  map.of.fill({.least = 0, .most = 16});
  EXPECT_NE(map.words().find("0 to 16 stops in steps of 4.4%, 2x3 texels of 1 channel"), std::string::npos)
      << map.words();
}

std::vector<unsigned char> iso(unsigned flags, const std::vector<int>& numbers) {
  std::vector<unsigned char> bytes{0, 0, 0, 0, static_cast<unsigned char>(flags)};
  for (const int n : numbers)
    for (int k = 3; k >= 0; --k) bytes.push_back(static_cast<unsigned char>(unsigned(n) >> unsigned(8 * k)));
  return bytes;
}

TEST(GainMap, OfIsoHasFractions) {
  const auto map = gain_map_of_iso(iso(0x40, {0, 1, 5, 2, -3, 2, 7, 2, 11, 5, 1, 8, -1, 4}));
  ASSERT_TRUE(map);
  EXPECT_EQ(map->headroom, 2.5);
  EXPECT_TRUE(map->of_base_colours);
  for (const GainMap::Channel& c : map->of) {
    EXPECT_EQ(c.least, -1.5);
    EXPECT_EQ(c.most, 3.5);
    EXPECT_EQ(c.gamma, 2.2);
    EXPECT_EQ(c.base_offset, 0.125);
    EXPECT_EQ(c.offset, -0.25);
  }
  // One denominator for all, as drafts had it.
  const auto common = gain_map_of_iso(iso(0x08, {10, 0, 25, -15, 35, 22, 1, -2}));
  ASSERT_TRUE(common);
  EXPECT_EQ(common->of[2].gamma, 2.2);
  EXPECT_FALSE(common->of_base_colours);
  const std::vector<unsigned char> version{0, 0, 0, 0};
  EXPECT_FALSE(gain_map_of_iso(version)) << "that of the picture";
}

TEST(GainMap, OfIsoThatIsDamagedIsRefused) {
  const std::vector<unsigned char> whole = iso(0x40, {0, 1, 5, 2, -3, 2, 7, 2, 11, 5, 1, 8, -1, 4});
  for (std::size_t size = 0; size < whole.size(); size += size == 3 ? 2 : 1)  // 4 bytes tell the version alone.
    EXPECT_THROW(gain_map_of_iso(std::span(whole).first(size)), InputError) << size;
  EXPECT_THROW(gain_map_of_iso(iso(0x40, {0, 0, 5, 2, -3, 2, 7, 2, 11, 5, 1, 8, -1, 4})), InputError) << "over 0";
  EXPECT_THROW(gain_map_of_iso(iso(0x40, {0, 1, 5, 2, 9, 2, 7, 2, 11, 5, 1, 8, -1, 4})), InputError) << "least > most";
  EXPECT_THROW(gain_map_of_iso(iso(0x44, {0, 1, 5, 2, -3, 2, 7, 2, 11, 5, 1, 8, -1, 4})), InputError) << "backward";
  std::vector<unsigned char> later = whole;
  later[1] = 1;
  EXPECT_THROW(gain_map_of_iso(later), InputError) << "of a later version";
}

// ---- XMP ------------------------------------------------------------------------------------------------------------

TEST(Xmp, PropertiesAreAttributesElementsAndLists) {
  const auto xmp = parse_xmp(
      "<?xpacket begin=''?><x:xmpmeta xmlns:x=\"adobe:ns:meta/\"><rdf:RDF "
      "xmlns:rdf='http://www.w3.org/1999/02/22-rdf-syntax-ns#'><!-- <no> --><rdf:Description xmlns:a='A/' xmlns:b='B/' "
      "a:one='1.5' b:one='2'><a:two> x &amp; y </a:two><a:three><rdf:Seq><rdf:li>1</rdf:li><rdf:li>2</rdf:li></rdf:Seq>"
      "</a:three></rdf:Description></rdf:RDF></x:xmpmeta><?xpacket end='w'?>\n\n");
  using Texts = std::vector<std::string>;
  EXPECT_EQ(xmp_values(xmp, "A/", "one"), Texts{"1.5"});
  EXPECT_EQ(xmp_values(xmp, "B/", "one"), Texts{"2"}) << "names are those of their namespace";
  EXPECT_EQ(xmp_values(xmp, "A/", "two"), Texts{"x & y"});
  EXPECT_EQ(xmp_values(xmp, "A/", "three"), (Texts{"1", "2"}));
  EXPECT_EQ(xmp_values(xmp, "A/", "four"), Texts{});
  EXPECT_EQ(xmp_number(xmp, "A/", "one"), 1.5);
  EXPECT_EQ(xmp_number(xmp, "A/", "four"), std::nullopt);
  EXPECT_THROW(xmp_number(xmp, "A/", "two"), InputError);
  EXPECT_THROW(xmp_number(xmp, "A/", "three"), InputError);
}

TEST(Xmp, ThatIsNoXmlIsRefused) {
  for (const char* text : {"<a>", "</a>", "<a></b>", "<a b></a>", "<a b=>", "<a b=1/>", "<a b='1/>", "<a><b></a>",
                           "<!DOCTYPE x>", "< a/>", "<!-- >"})
    EXPECT_THROW(parse_xmp(text), InputError) << text;
  std::string deep;
  for (int k = 0; k < 1000; ++k) deep += "<a>";
  EXPECT_THROW(parse_xmp(deep), InputError);
  EXPECT_TRUE(parse_xmp("no XML").empty());
}

}  // namespace
}  // namespace envmap::gain_map_test

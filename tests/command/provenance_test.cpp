// What a file says of its picture, carried into what is made of it as long as it is true.
#include <OpenImageIO/imageio.h>

#include "picture.h"
#include "run.h"

namespace command_tests::provenance_test {
namespace {

constexpr float rec2020[8] = {0.708F, 0.292F, 0.17F, 0.797F, 0.131F, 0.046F, 0.3127F, 0.329F};
constexpr float rec709[8] = {0.64F, 0.33F, 0.3F, 0.6F, 0.15F, 0.06F, 0.3127F, 0.329F};

class Provenance : public CommandTest {
 protected:
  Provenance() {
    OIIO::ImageSpec spec;
    spec.attribute("ImageDescription", "Shot by Ada, over the bay");
    spec.attribute("Copyright", "Ada");
    spec.attribute("whiteLuminance", 100.0F);
    spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), rec709);
    save(path("in.exr"), latlong_directions(8), OIIO::TypeDesc::FLOAT, spec);
  }
  [[nodiscard]] OIIO::ImageSpec spec(const std::string& name) const {
    const auto in = OIIO::ImageInput::open(path(name));
    return in ? in->spec() : OIIO::ImageSpec();
  }
  void expect_colours(const OIIO::ImageSpec& s, const float (&wanted)[8] = rec709) const {
    float found[8] = {};
    EXPECT_TRUE(s.getattribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), found));
    for (int k = 0; k < 8; ++k) EXPECT_EQ(found[k], wanted[k]);
  }
  static std::string comments(const OIIO::ImageSpec& s) {
    return std::string(s.get_string_attribute("ImageDescription"));
  }
};

TEST_F(Provenance, IsCarriedByEveryCommandThatMakesAMapOfAMap) {
  succeeds({"convert", "in.exr", "convert.exr", "--to", "cube"});
  succeeds({"mipmap", "in.exr", "mipmap.exr"});
  succeeds({"prefilter", "in.exr", "prefilter.exr", "--size", "4", "-q"});
  succeeds({"convert", "prefilter.exr", "again.exr", "--to", "latlong"});
  for (const char* name : {"convert.exr", "mipmap.exr", "prefilter.exr", "again.exr"}) {
    SCOPED_TRACE(name);
    const OIIO::ImageSpec s = spec(name);
    const std::string all = comments(s);
    EXPECT_TRUE(all.ends_with("Shot by Ada, over the bay")) << all;
    EXPECT_EQ(all.find("envmap:projection"), all.rfind("envmap:projection")) << all;  // Once, however often converted.
    EXPECT_EQ(s.get_string_attribute("Copyright"), "Ada");
    EXPECT_EQ(s.get_float_attribute("whiteLuminance"), 100);
    expect_colours(s);
  }
}

TEST_F(Provenance, StaysTrue) {
  succeeds({"convert", "in.exr", "brighter.exr", "--exposure", "2"});
  EXPECT_EQ(spec("brighter.exr").get_float_attribute("whiteLuminance"), 25);
  succeeds({"prefilter", "in.exr", "scaled.exr", "--size", "4", "--scale", "2", "-q"});
  EXPECT_EQ(spec("scaled.exr").get_float_attribute("whiteLuminance"), 0);
  expect_colours(spec("scaled.exr"));
  // What is converted says so.
  succeeds({"convert", "in.exr", "wide.exr", "--output-space", "Rec.2020"});
  expect_colours(spec("wide.exr"), rec2020);
  succeeds({"mipmap", "wide.exr", "levels.exr"});
  expect_colours(spec("levels.exr"));
  EXPECT_EQ(envmap({"compare", "in.exr", "brighter.exr", "--difference", "difference.exr"}).status, 0);
  EXPECT_EQ(comments(spec("difference.exr")).find("Ada"), std::string::npos);
}

TEST_F(Provenance, GoesWhereAFormatHasAPlaceForIt) {
  succeeds({"convert", "in.exr", "map.hdr", "-q"});  // Which has no place for the unit.
  EXPECT_NE(read("map.hdr").find("PRIMARIES=0.64 0.33"), std::string::npos);
  succeeds({"convert", "map.hdr", "again.exr"});
  expect_colours(spec("again.exr"));
  succeeds({"convert", "in.exr", "map.png", "--depth", "uint16"});
  EXPECT_TRUE(comments(spec("map.png")).ends_with("Shot by Ada, over the bay"));
  EXPECT_EQ(spec("map.png").get_string_attribute("Copyright"), "Ada");
  succeeds({"convert", "map.png", "back.exr"});
  EXPECT_TRUE(comments(spec("back.exr")).ends_with("Shot by Ada, over the bay"));
}

}  // namespace
}  // namespace command_tests::provenance_test

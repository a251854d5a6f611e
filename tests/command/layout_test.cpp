// Where cube faces lie in an image, and that no way there and back changes a texel.
#include <array>
#include <cmath>
#include <filesystem>

#include "picture.h"
#include "run.h"

namespace command_tests::layout_test {
namespace {

constexpr int size = 4;
constexpr std::array<const char*, 5> layouts{"column", "row", "cross", "vcross", "3x2"};
constexpr std::array<const char*, 6> face_names{"px", "nx", "py", "ny", "pz", "nz"};

class Layouts : public CommandTest {
 protected:
  /// The map in a column, as the program reads it from `input`.
  [[nodiscard]] Picture column_of(const std::string& input, const std::vector<std::string>& options = {}) const {
    std::vector<std::string> arguments{"convert", input, "column_of.exr", "--layout", "column", "--filter", "nearest"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    succeeds(arguments);
    return load(path("column_of.exr"));
  }

  void generate(const std::string& name, const std::vector<std::string>& options = {}) const {
    std::vector<std::string> arguments{"generate", "directions", name, "--to", "cube", "--size", std::to_string(size)};
    arguments.insert(arguments.end(), options.begin(), options.end());
    succeeds(arguments);
  }
};

TEST_F(Layouts, HaveEachFaceInItsPlaceAndTurn) {
  for (const std::string layout : layouts) {
    SCOPED_TRACE(layout);
    generate("cube.exr", {"--layout", layout});
    EXPECT_LT(difference(load(path("cube.exr")), cube_directions(layout, size)), 1e-6);
  }
  generate("default.exr");
  EXPECT_LT(difference(load(path("default.exr")), cube_directions("column", size)), 1e-6);
}

TEST_F(Layouts, OfProjectionsHaveTheNamesOfOtherProgramsToo) {
  generate("a.exr");
  for (const auto& [alias, ours] : {std::pair{"equirect", "latlong"},
                                    {"equirectangular", "latlong"},
                                    {"cubemap", "cube"},
                                    {"mirrorball", "sphere"},
                                    {"lightprobe", "angular"}}) {
    succeeds({"convert", "a.exr", "b.exr", "--to", alias, "-q"});
    succeeds({"convert", "a.exr", "c.exr", "--to", ours, "-q"});
    EXPECT_EQ(read("b.exr"), read("c.exr")) << alias;
  }
}

TEST_F(Layouts, OfSixFilesAreNamedByFace) {
  generate("face_{face}.exr");
  for (int face = 0; face < 6; ++face) {
    const std::string name = std::string("face_") + face_names.at(std::size_t(face)) + ".exr";
    SCOPED_TRACE(name);
    EXPECT_LT(difference(load(path(name)), face_directions(face, size)), 1e-6);
  }
  EXPECT_EQ(names().size(), 6U);
}

// Paraboloid maps have two: front (+Z) and back, as halves of one image have them.
TEST_F(Layouts, OfTwoHalvesAreNamedFrontAndBack) {
  succeeds({"generate", "directions", "both.exr", "--to", "paraboloid", "--size", "8"});
  succeeds({"generate", "directions", "a_{half}.exr", "--to", "paraboloid", "--size", "8"});
  const Picture both = load(path("both.exr")), front = load(path("a_front.exr")), back = load(path("a_back.exr"));
  ASSERT_EQ(front.width, 8);
  ASSERT_EQ(back.height, 8);
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 8; ++i)
      for (int c = 0; c < 3; ++c) {
        EXPECT_EQ(front.at(i, j)[c], both.at(i, j)[c]);
        EXPECT_EQ(back.at(i, j)[c], both.at(8 + i, j)[c]);
      }
  succeeds({"convert", "both.exr", "one.exr", "--to", "latlong"});
  succeeds({"convert", "a_{half}.exr", "two.exr", "--to", "latlong"});
  EXPECT_EQ(load(path("two.exr")), load(path("one.exr")));
  succeeds({"convert", "one.exr", "b_{half}.hdr", "--to", "paraboloid", "--depfile", "out.d"});
  EXPECT_NE(read("out.d").find("b_front.hdr b_back.hdr"), std::string::npos) << read("out.d");
  fails(2, {"convert", "one.exr", "b_{half}.exr", "--to", "cube"}, {"{half}"});
  fails(2, {"convert", "one.exr", "b_{face}.exr", "--to", "paraboloid"}, {"{face}"});
  fails(2, {"convert", "a_{half}.exr", "two.exr", "--from", "cube"}, {"{half}"});
}

TEST_F(Layouts, AreKnownByTheirShapeAlone) {
  const Picture column = cube_directions("column", size);
  for (const std::string layout : layouts)
    for (const std::string type : {"exr", "pfm"}) {
      SCOPED_TRACE(layout + " " + type);
      save(path("bare." + type), cube_directions(layout, size));
      EXPECT_EQ(column_of("bare." + type), column);
    }
  for (int face = 0; face < 6; ++face)
    save(path(std::string("bare_") + face_names.at(std::size_t(face)) + ".pfm"), face_directions(face, size));
  EXPECT_EQ(column_of("bare_{face}.pfm"), column);
}

// A smooth picture that ends at its sides, in the shapes that cameras and maps share.
TEST_F(Layouts, OfPhotosAreToldFromThoseOfMaps) {
  for (const auto& [width, height] : {std::pair{128, 96}, {96, 128}, {96, 64}, {128, 64}}) {
    Picture photo = Picture::filled(width, height);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        for (int c = 0; c < 3; ++c)
          photo.at(x, y)[c] = 0.1F + std::exp(-3 * float(x) / float(width)) + 2 * float(y) / float(height);
    save(path("photo.pfm"), photo);
    EXPECT_NE(envmap({"info", "photo.pfm"}).err.find("do not meet"), std::string::npos) << width << 'x' << height;
    EXPECT_EQ(envmap({"info", "photo.pfm", "--from", width == 2 * height ? "latlong" : "cube"}).err, "");
  }
  for (const std::string layout : layouts) {
    save(path("map.pfm"), cube_directions(layout, 32));
    EXPECT_EQ(envmap({"info", "map.pfm"}).err, "") << layout;
  }
  save(path("map.pfm"), latlong_directions(32));
  EXPECT_EQ(envmap({"info", "map.pfm"}).err, "");
}

TEST_F(Layouts, AreReadAsTheUserSays) {
  save(path("row.pfm"), cube_directions("row", size));
  EXPECT_EQ(column_of("row.pfm", {"--from", "cube", "--from-layout", "row"}), cube_directions("column", size));
  fails(3, {"info", "row.pfm", "--from-layout", "column"}, {"row.pfm", "24x4"});
}

TEST_F(Layouts, GoThereAndBackWithoutAnyChange) {
  generate("start.exr");
  const Picture start = load(path("start.exr"));
  for (const std::string filter : {"nearest", "bilinear"})
    for (const std::string layout : {"column", "row", "cross", "vcross", "3x2", "files"}) {
      SCOPED_TRACE(layout + " " + filter);
      const std::string there = layout == "files" ? "there_{face}.exr" : "there.exr";
      succeeds({"convert", "start.exr", there, "--layout", layout, "--filter", filter});
      succeeds({"convert", there, "back.exr", "--layout", "column", "--filter", filter});
      EXPECT_EQ(load(path("back.exr")), start);
    }
}

TEST_F(Layouts, AreRememberedByTheFile) {
  // Of these shapes only the first tells the projection.
  generate("cross.exr", {"--layout", "vcross"});
  EXPECT_NE(envmap({"info", "cross.exr"}).out.find("cube (vcross)"), std::string::npos);
  for (const auto& [projection, name] : {std::pair{"sphere", "a.exr"}, {"angular", "a.tif"}, {"paraboloid", "a.png"}}) {
    succeeds({"generate", "directions", name, "--to", projection, "--size", "8"});
    EXPECT_NE(envmap({"info", name}).out.find(projection), std::string::npos) << name;
  }
}

TEST_F(Layouts, KeepTheForwardAxis) {
  // Red is the part towards +X, brightest at the centre of an image that looks that way.
  succeeds({"generate", "directions", "x.exr", "--size", "8", "--forward", "+x"});
  const Picture x = load(path("x.exr"));
  EXPECT_GT(x.at(8, 4)[0], 0.95F);
  succeeds({"convert", "x.exr", "z.exr", "--to", "latlong", "--forward", "+z", "--size", "8"});
  EXPECT_LT(difference(load(path("z.exr")), latlong_directions(8)), 0.03);
  save(path("bare.pfm"), x);
  succeeds({"convert", "bare.pfm", "z.exr", "--from-forward", "+x", "--forward", "+z"});
  EXPECT_LT(difference(load(path("z.exr")), latlong_directions(8)), 0.03);
}

TEST_F(Layouts, OfOpenExrsOwnToolAreRead) {
  if (shell("exrenvmap -h >/dev/null 2>&1 || [ $? -ne 127 ]").status != 0) GTEST_SKIP() << "exrenvmap is not installed";
  // The source names this project's projection, which that tool copies into its result with everything else.
  OIIO::ImageSpec named;
  named.attribute("envmap:projection", "latlong");
  for (const OIIO::ImageSpec& spec : {OIIO::ImageSpec(), named}) {
    save(path("border.exr"), latlong_directions(65, true), OIIO::TypeDesc::FLOAT, spec);
    ASSERT_EQ(
        shell("exrenvmap -li -c -w 32 border.exr cube.exr && exrenvmap -li -l -w 128 border.exr latlong.exr").status,
        0);
    for (const std::string name : {"cube", "latlong"}) {
      SCOPED_TRACE(name);
      const Result info = envmap({"info", name + ".exr"});
      EXPECT_NE(info.out.find(name), std::string::npos) << info.out << info.err;
      EXPECT_NE(info.out.find("envmap attribute"), std::string::npos) << info.out;
      succeeds({"generate", "directions", "reference.exr", "--to", name, "--size", name == "cube" ? "32" : "64"});
      // Read as cell-centred instead, the cube would be off by up to a texel of 3 degrees: 0.025.
      EXPECT_EQ(envmap({"convert", name + ".exr", "read.exr", "--filter", "nearest", "--depth", "float"}).err, "");
      EXPECT_LT(difference(load(path("read.exr")), load(path("reference.exr"))), 0.01);
    }
  }
}

}  // namespace
}  // namespace command_tests::layout_test

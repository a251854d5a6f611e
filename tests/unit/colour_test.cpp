// Matrices against published ones and against those that OpenColorIO has built in; names; the bridge to other configs.
#include "envmap/io/claims/colour.h"

#include <OpenColorIO/OpenColorIO.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "envmap/base/error.h"

namespace envmap::colour_test {
namespace {

namespace ocio = OCIO_NAMESPACE;

// Rows, as they are printed.
void expect_matrix(const ColourMatrix& m, const double (&rows)[3][3], double within) {
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(m[c][r], rows[r][c], within) << "row " << r << ", column " << c;
}

TEST(Primaries, MakePublishedMatrices) {
  // W3C, CSS Color Module Level 4, "Sample code for color conversions".
  expect_matrix(to_xyz(rec709),
                {{0.4123907993, 0.3575843394, 0.1804807884},
                 {0.2126390059, 0.7151686788, 0.0721923154},
                 {0.0193308187, 0.1191947798, 0.9505321522}},
                1e-9);
  expect_matrix(to_xyz(p3_d65),
                {{0.4865709486, 0.2656676932, 0.1982172852},
                 {0.2289745641, 0.6917385218, 0.0792869141},
                 {0, 0.0451133819, 1.0439443689}},
                1e-9);
  expect_matrix(to_xyz(rec2020),
                {{0.6369580483, 0.1446169036, 0.1688809752},
                 {0.2627002120, 0.6779980715, 0.0593017165},
                 {0, 0.0280726930, 1.0609850577}},
                1e-9);
  // SMPTE ST 2065-1 and Academy S-2014-004.
  expect_matrix(to_xyz(aces_ap0),
                {{0.9525523959, 0, 0.0000936786}, {0.3439664498, 0.7281660966, -0.0721325464}, {0, 0, 1.0088251844}},
                1e-9);
  expect_matrix(conversion(aces_ap1, aces_ap0),
                {{0.6954522414, 0.1406786965, 0.1638690622},
                 {0.0447945634, 0.8596711185, 0.0955343182},
                 {-0.0055258826, 0.0040252103, 1.0015006723}},
                1e-9);
  // ITU-R BT.2087-0.
  expect_matrix(conversion(rec709, rec2020),
                {{0.6274, 0.3293, 0.0433}, {0.0691, 0.9195, 0.0114}, {0.0164, 0.0880, 0.8956}}, 5e-5);
}

TEST(Primaries, OfXyzAreXyzUnderAnyWhite) {
  expect_matrix(conversion(rec709, cie_xyz),
                {{0.4123907993, 0.3575843394, 0.1804807884},
                 {0.2126390059, 0.7151686788, 0.0721923154},
                 {0.0193308187, 0.1191947798, 0.9505321522}},
                1e-9);
}

TEST(Primaries, OfABlackBody) {
  const Point2 a = black_body(2855.5), day = black_body(6500);  // CIE illuminant A; Planck's law at 6500 K.
  EXPECT_NEAR(a.x, 0.44757, 5e-4);
  EXPECT_NEAR(a.y, 0.40745, 5e-4);
  EXPECT_NEAR(day.x, 0.31352, 5e-4);
  EXPECT_NEAR(day.y, 0.32363, 5e-4);
}

// What a transform makes of red, green and blue: its columns.
ColourMatrix matrix_of(const ColourTransform& transform) {
  Colour c[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  if (transform.apply) transform.apply(c);
  return {Flux(c[0]), Flux(c[1]), Flux(c[2])};
}

ColourMatrix built_in(const char* style) {
  const auto transform = ocio::BuiltinTransform::Create();
  transform->setStyle(style);
  const auto cpu =
      ocio::Config::CreateRaw()->getProcessor(transform)->getOptimizedCPUProcessor(ocio::OPTIMIZATION_LOSSLESS);
  Colour c[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  ocio::PackedImageDesc image(c, 3, 1, 3);
  cpu->apply(image);
  return {Flux(c[0]), Flux(c[1]), Flux(c[2])};
}

void expect_same(const ColourMatrix& a, const ColourMatrix& b) {
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) EXPECT_NEAR(a[c][r], b[c][r], 2e-6) << "row " << r << ", column " << c;
}

TEST(ColourSpaces, AreThoseOfOpenColorIO) {
  expect_same(matrix_of(into_working({.space = "ACEScg"}, {})), built_in("UTILITY - ACES-AP1_to_LINEAR-REC709_BFD"));
  expect_same(matrix_of(into_working({.space = "ACES2065-1", .working = "XYZ"}, {})),
              built_in("UTILITY - ACES-AP0_to_CIE-XYZ-D65_BFD"));
}

TEST(ColourSpaces, HaveSrgbsCurve) {
  // IEC 61966-2-1.
  Colour c[1] = {{0.04F, 0.5F, 1}};
  into_working({.space = "srgb"}, {}).apply(c);
  EXPECT_NEAR(c[0].x, 0.04 / 12.92, 1e-6);
  EXPECT_NEAR(c[0].y, std::pow((0.5 + 0.055) / 1.055, 2.4), 1e-6);
  out_of_working({.space = "sRGB"}).apply(c);
  EXPECT_NEAR(c[0].y, 0.5, 1e-6);
}

TEST(ColourSpaces, GoThereAndBack) {
  for (const std::string& space : colour_spaces()) {
    SCOPED_TRACE(space);
    Colour c[1] = {{0.2F, 0.5F, 0.7F}};
    const ColourTransform to = out_of_working({.space = space}), back = into_working({.space = space}, {});
    if (to.apply) to.apply(c), back.apply(c);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(c[0][k], (Colour{0.2F, 0.5F, 0.7F})[k], 1e-6);
  }
}

TEST(ColourSpaces, OfAFileAreKnownByPrimaries) {
  EXPECT_EQ(space_with(aces_ap1), "ACEScg");
  EXPECT_EQ(space_with(cie_xyz), "XYZ");
  EXPECT_EQ(space_with({{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, {0.31271, 0.32902}}), "Linear Rec.709");
  const Primaries adobe{{0.64, 0.33}, {0.21, 0.71}, {0.15, 0.06}, {0.3127, 0.3290}};
  EXPECT_EQ(space_with(adobe), "");
  expect_same(matrix_of(into_working({}, {.primaries = adobe, .by = "chromaticities"})), conversion(adobe, rec709));
  expect_same(matrix_of(into_working({.working = "ACEScg"}, {.primaries = adobe, .by = "chromaticities"})),
              conversion(adobe, aces_ap1));
}

void expect_usage(const std::string& space, const std::vector<std::string>& words) {
  try {
    (void)into_working({.space = space}, {});
    ADD_FAILURE() << space << " is known";
  } catch (const UsageError& e) {
    for (const std::string& word : words) EXPECT_NE(std::string(e.what()).find(word), std::string::npos) << e.what();
  }
}

TEST(ColourSpaces, UnknownAreRefusedWithNearNames) {
  expect_usage("ACESgc", {"'ACESgc'", "did you mean 'ACEScg'"});
  expect_usage("Rec.2O20", {"'Rec.2020'"});
  expect_usage("nonsense of any kind", {"there are Linear Rec.709, sRGB, ACEScg"});
}

class OtherConfig : public ::testing::Test {
 protected:
  // @param bridge lines of roles and spaces that say how it stands to others.
  std::string config(const std::string& roles, const std::string& spaces) {
    std::ofstream(path_) << "ocio_profile_version: 2\nroles:\n  default: half\n"
                         << roles
                         << "displays:\n  sRGB:\n    - !<View> {name: Raw, colorspace: half}\ncolorspaces:\n"
                            "  - !<ColorSpace>\n    name: half\n    to_scene_reference: !<MatrixTransform> {matrix: "
                            "[0.5,0,0,0, 0,0.5,0,0, 0,0,0.5,0, 0,0,0,1]}\n"
                         << spaces;
    return path_.string();
  }
  ~OtherConfig() override { std::filesystem::remove(path_); }

 private:
  std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("envmap-colour-" + std::to_string(::getpid()) + ".ocio");
};

TEST_F(OtherConfig, IsBridgedByItsRole) {
  const std::string file = config("  aces_interchange: reference\n", "  - !<ColorSpace>\n    name: reference\n");
  const ColourTransform t = into_working({.config = file, .space = "half"}, {});
  expect_same(matrix_of(t), 0.5 * conversion(aces_ap0, rec709));
  EXPECT_EQ(t.files, std::vector<std::string>{file});
  EXPECT_EQ(t.note, "");
  EXPECT_EQ(working_space_for(file, "half"), "half");
  EXPECT_TRUE(same(*primaries_of(file, "reference"), aces_ap0));
}

TEST_F(OtherConfig, IsBridgedByANameOrByAWord) {
  const std::string file = config("", "  - !<ColorSpace>\n    name: Utility - Linear - sRGB\n");
  EXPECT_EQ(into_working({.config = file, .space = "half"}, {}).note, "");
  expect_same(matrix_of(into_working({.config = file, .space = "half"}, {})), ColourMatrix(0.5));
  config("  scene_linear: house\n", "  - !<ColorSpace>\n    name: house\n");
  const ColourTransform t = into_working({.config = file, .space = "half"}, {});
  EXPECT_NE(t.note.find("scene_linear (house) is taken for linear Rec.709"), std::string::npos) << t.note;
  config("", "  - !<ColorSpace>\n    name: house\n");
  EXPECT_THROW((void)into_working({.config = file, .space = "half"}, {}), InputError);
  EXPECT_THROW((void)into_working({.config = "none.ocio", .space = "half"}, {}), InputError);
}

}  // namespace
}  // namespace envmap::colour_test

// Colour spaces and photometry as the program has them.
#include <OpenImageIO/imageio.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "picture.h"
#include "run.h"

namespace command_tests::colour_test {
namespace {

constexpr float ap1[8] = {0.713F, 0.293F, 0.165F, 0.83F, 0.128F, 0.044F, 0.32168F, 0.33767F};
constexpr float xyz[8] = {1, 0, 0, 1, 0, 0, 1 / 3.0F, 1 / 3.0F};

class Colours : public CommandTest {
 protected:
  void save_as(const std::string& name, const float (&chromaticities)[8], float r, float g, float b) {
    OIIO::ImageSpec spec;
    spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), chromaticities);
    Picture picture = Picture::filled(8, 4);
    for (std::size_t k = 0; k < picture.values.size(); k += 3)
      picture.values[k] = r, picture.values[k + 1] = g, picture.values[k + 2] = b;
    save(path(name), picture, OIIO::TypeDesc::FLOAT, spec);
  }
  [[nodiscard]] nlohmann::json info(const std::string& name) const {
    const Result r = envmap({"info", name, "--json"});
    EXPECT_EQ(r.status, 0) << r.err;
    return nlohmann::json::parse(r.out);
  }
  void expect_mean(const std::string& name, double r, double g, double b) const {
    const auto mean = info(name)["mean"];
    EXPECT_NEAR(mean[0].get<double>(), r, 1e-5) << name;
    EXPECT_NEAR(mean[1].get<double>(), g, 1e-5) << name;
    EXPECT_NEAR(mean[2].get<double>(), b, 1e-5) << name;
  }
};

TEST_F(Colours, OfTheFileAreBelieved) {
  // Rows of the published matrices of unit_tests, times (0.2, 0.5, 0.3).
  save_as("aces.exr", ap1, 0.2F, 0.5F, 0.3F);
  EXPECT_EQ(info("aces.exr")["space"], "ACEScg (chromaticities)");
  expect_mean("aces.exr", 0.00513648, 0.54118638, 0.27660653);
  save_as("xyz.exr", xyz, 0.9504559F, 1, 1.0890578F);  // White of D65.
  EXPECT_EQ(info("xyz.exr")["space"], "XYZ (chromaticities)");
  expect_mean("xyz.exr", 1, 1, 1);
  const Result r = envmap({"info", "aces.exr", "--json", "--input-space", "lin_rec709"});
  EXPECT_NEAR(nlohmann::json::parse(r.out)["mean"][0].get<double>(), 0.2, 1e-6);
}

TEST_F(Colours, FacesOfOneMapMustSayTheSame) {
  constexpr float unknown[8] = {0.7F, 0.3F, 0.2F, 0.7F, 0.15F, 0.05F, 0.31F, 0.33F};
  succeeds({"generate", "constant", "{face}.exr", "--to", "cube", "--size", "4"});
  const auto paint = [&](const std::string& name) {
    OIIO::ImageSpec spec;
    spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), unknown);
    save(path(name), Picture::filled(4, 4), OIIO::TypeDesc::FLOAT, spec);
  };
  paint("nx.exr");
  fails(3, {"info", "{face}.exr"}, {"nx.exr", "0.7 0.3", "assumed"});
  for (const std::string face : {"px", "py", "ny", "pz", "nz"}) paint(face + ".exr");
  succeeds({"info", "{face}.exr"});
  save(path("nx.exr"), Picture::filled(4, 4), OIIO::TypeDesc::FLOAT, {});
  fails(3, {"info", "{face}.exr"}, {"nx.exr", "assumed", "0.7 0.3"});
}

TEST_F(Colours, AreWrittenAsAskedAndSaid) {
  succeeds({"generate", "constant", "in.exr", "--size", "4", "--value", "0.2,0.5,0.7"});
  EXPECT_EQ(info("in.exr")["space"], "Linear Rec.709 (assumed, not specified in the file)");
  for (const std::string space : {"ACEScg", "ACES2065-1", "Rec.2020", "XYZ", "Linear P3-D65", "sRGB", "Display P3"})
    for (const std::string ext : {"exr", "hdr", space == "ACEScg" ? "tif" : "ktx2"}) {
      SCOPED_TRACE(space + " in ." + ext);
      const bool encoded = space == "sRGB" || space == "Display P3";
      if (encoded && ext == "hdr") {
        fails(2, {"convert", "in.exr", "x.hdr", "--output-space", space}, {"x.hdr", "choose a linear space"});
        continue;
      }
      std::vector<std::string> write{"convert", "in.exr", "out." + ext, "--output-space", space, "--depth", "float"};
      if (encoded)
        fails(2, write, {"out." + ext, space + " is encoded", "choose a linear --output-space or use --encoded"});
      if (encoded) write.emplace_back("--encoded");
      succeeds(write);
      if (ext == "ktx2") {
        const Result checked = shell("python3 " ENVMAP_KTX2_CHECK " out.ktx2");
        EXPECT_EQ(checked.status, 0) << checked.out << checked.err;
      }
      succeeds({"convert", "out." + ext, "back.exr"});
      const Result r = envmap({"compare", "back.exr", "in.exr", "--max-rms", ext == "hdr" ? "0.01" : "1e-6"});
      EXPECT_EQ(r.status, 0) << r.out << r.err;
    }
  succeeds({"convert", "in.exr", "out.exr", "--output-space", "aces2065-1"});
  EXPECT_EQ(info("out.exr")["space"], "ACES2065-1 (envmap:space)");
  fails(2, {"prefilter", "out.exr", "x.exr", "--output-space", "sRGB"}, {"--output-space"});
  succeeds({"mipmap", "out.exr", "levels.exr", "--output-space", "ACEScg"});
  EXPECT_EQ(info("levels.exr")["space"], "ACEScg (envmap:space)");
  succeeds({"prefilter", "out.exr", "diffuse.exr", "--size", "4", "-q", "--output-space", "ACEScg"});
  expect_mean("diffuse.exr", 0.2, 0.5, 0.7);
}

TEST_F(Colours, OutsideOfTheSpaceAreCountedAndKeepTheirLuminance) {
  save_as("blue.exr", xyz, 0, 0, 1);  // No light at all, but "blue".
  save_as("green.exr", ap1, 0, 1, 0);
  Result r = envmap({"convert", "green.exr", "out.exr"});
  EXPECT_EQ(r.status, 0);
  EXPECT_NE(r.err.find("32 texels of ACEScg are outside of Linear Rec.709"), std::string::npos) << r.err;
  const auto mean = info("out.exr")["mean"];
  // Luminance of AP1's green under D65, of Bradford's matrix: 0.674.
  EXPECT_NEAR(0.2126 * mean[0].get<double>() + 0.7152 * mean[1].get<double>() + 0.0722 * mean[2].get<double>(), 0.6797,
              6e-3);
  // Into a space that holds it nothing is lost, and nothing said.
  succeeds({"convert", "green.exr", "kept.exr", "--output-space", "ACEScg"});
  const Picture kept = load(path("kept.exr"));
  EXPECT_NEAR(kept.values[0], 0, 1e-6);
  EXPECT_NEAR(kept.values[1], 1, 1e-6);
}

// Without envmap:space the numbers of the data format descriptor are all that a KTX2 file says.
TEST_F(Colours, OfKtx2AreThoseOfItsDescriptor) {
  save_as("green.exr", ap1, 0, 1, 0);
  const auto written = [&](int primaries, int transfer) {
    std::string file = read("out.ktx2");
    if (const auto key = file.find("envmap:space"); key != file.npos) file.replace(key, 12, "envmap:spare");
    std::uint32_t descriptor = 0;
    std::memcpy(&descriptor, file.data() + 48, sizeof descriptor);
    file[descriptor + 13] = static_cast<char>(primaries), file[descriptor + 14] = static_cast<char>(transfer);
    write("patched.ktx2", file);
  };
  succeeds({"convert", "green.exr", "out.ktx2", "--output-space", "ACEScg", "--depth", "float"});
  written(7, 1);
  EXPECT_EQ(info("patched.ktx2")["space"], "ACEScg (data format descriptor)");
  succeeds({"convert", "patched.ktx2", "back.exr", "--output-space", "ACEScg"});
  const Result r = envmap({"compare", "back.exr", "green.exr", "--max-error", "1e-6"});
  EXPECT_EQ(r.status, 0) << r.out << r.err;
  written(10, 2);
  EXPECT_EQ(info("patched.ktx2")["space"], "Display P3 (data format descriptor)");
  written(8, 1);
  EXPECT_EQ(info("patched.ktx2")["space"],
            "primaries 0.67 0.33 0.21 0.71 0.14 0.08 0.3101 0.3162 (data format descriptor)");
  written(0, 1);
  EXPECT_EQ(info("patched.ktx2")["space"], "Linear Rec.709 (assumed, not specified in the file)");
  written(4, 10);
  fails(3, {"convert", "patched.ktx2", "x.exr"}, {"transfer function 10", "--input-space"});
  succeeds({"convert", "patched.ktx2", "x.exr", "--input-space", "ACEScg", "--output-space", "ACEScg"});
}

// Apple's "Display P3.icc" holds these: red, green and blue as XYZ under D50, and the curve of sRGB.
TEST_F(Colours, OfPngAndJpegAreInTheirProfile) {
  succeeds({"generate", "constant", "in.exr", "--size", "4", "--value", "0.2,0.5,0.7"});
  const auto profile = [&](const std::string& file) {
    const auto in = OIIO::ImageInput::open(path(file));
    const OIIO::ParamValue* icc = in->spec().find_attribute("ICCProfile");
    return icc == nullptr ? std::string()
                          : std::string(static_cast<const char*>(icc->data()), std::size_t(icc->type().size()));
  };
  const auto number = [](const std::string& bytes, std::size_t at) {
    std::uint32_t n = 0;
    for (std::size_t k = 0; k < 4; ++k) n = n << 8 | static_cast<unsigned char>(bytes.at(at + k));
    return n;
  };
  const auto tag = [&](const std::string& icc, const std::string& name) {
    for (std::size_t k = 0; k < number(icc, 128); ++k)
      if (const std::size_t at = 132 + 12 * k; icc.substr(at, 4) == name)
        return icc.substr(number(icc, at + 4), number(icc, at + 8));
    return std::string();
  };
  const auto fixed = [&](const std::string& element, std::size_t k) {
    return std::int32_t(number(element, 8 + 4 * k)) / 65536.0;
  };
  constexpr double apple[3][3] = {{0.51512, 0.24120, -0.00105},
                                  {0.29198, 0.69225, 0.04189},
                                  {0.15710, 0.06657, 0.78407}};
  for (const std::string file : {"p3.png", "p3.jpg", "p3.tif"}) {
    SCOPED_TRACE(file);
    succeeds({"convert", "in.exr", file, "--output-space", "Display P3", "--depth", "uint8"});
    const std::string icc = profile(file);
    ASSERT_GT(icc.size(), 128U);
    EXPECT_EQ(number(icc, 0), icc.size());
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(fixed(tag(icc, std::string{"rgb"[c]} + "XYZ"), k), apple[c][k], 1.5e-4) << c << " " << k;
    EXPECT_NEAR(fixed(tag(icc, "gTRC"), 1), 2.4, 1e-4);
    EXPECT_NEAR(fixed(tag(icc, "gTRC"), 5), 0.04045, 1e-4);
    EXPECT_EQ(info(file)["space"], "Display P3 (envmap:space)");
  }
  succeeds({"convert", "in.exr", "srgb.png", "--output-space", "sRGB"});
  EXPECT_EQ(profile("srgb.png"), "");
  EXPECT_NE(read("srgb.png").find("sRGB"), std::string::npos);
  EXPECT_EQ(read("p3.png").find("sRGB"), std::string::npos);
  succeeds({"convert", "in.exr", "linear.png", "--output-space", "ACEScg"});
  EXPECT_EQ(tag(profile("linear.png"), "rTRC"), std::string("curv\0\0\0\0\0\0\0\0", 12));
}

TEST_F(Colours, UnknownAreRefused) {
  succeeds({"generate", "constant", "in.exr", "--size", "4"});
  fails(2, {"convert", "in.exr", "out.exr", "--output-space", "ACESgc"}, {"'ACESgc'", "did you mean 'ACEScg'?"});
  fails(2, {"info", "in.exr", "--input-space", "srbg"}, {"'srbg'", "'sRGB'"});
  fails(3, {"convert", "in.exr", "out.exr", "--input-space", "x", "--ocio", "none.ocio"}, {"none.ocio"});
}

TEST_F(Colours, OfAConfigAreInTheDepfile) {
  succeeds({"generate", "constant", "in.exr", "--size", "4"});
  write("studio.ocio",
        "ocio_profile_version: 2\nsearch_path: .\nroles: {default: linear, scene_linear: linear}\n"
        "displays:\n  sRGB:\n    - !<View> {name: Raw, colorspace: linear}\ncolorspaces:\n  - !<ColorSpace>\n    name: "
        "lin_rec709\n"
        "  - !<ColorSpace> {name: linear}\n  - !<ColorSpace>\n    name: film\n    to_scene_reference: !<FileTransform> "
        "{src: twice.spi1d}\n");
  write("twice.spi1d", "Version 1\nFrom 0.0 1.0\nLength 2\nComponents 1\n{\n0.0\n2.0\n}\n");
  succeeds({"convert", "in.exr", "out.exr", "--input-space", "film", "--ocio", "studio.ocio", "--depfile", "out.d"});
  const std::string d = read("out.d");
  EXPECT_NE(d.find("studio.ocio"), std::string::npos) << d;
  EXPECT_NE(d.find("twice.spi1d"), std::string::npos) << d;
  const Result r = shell("OCIO=studio.ocio \"$ENVMAP\" info in.exr --input-space film --json");
  EXPECT_NEAR(nlohmann::json::parse(r.out)["mean"][0].get<double>(), 2, 1e-5) << r.err;
}

TEST_F(Colours, LightIsScaledToPhotometricUnits) {
  succeeds({"generate", "constant", "in.exr", "--size", "64", "--value", "0.2,0.5,0.7"});
  const double y = 0.2126390 * 0.2 + 0.7151687 * 0.5 + 0.0721923 * 0.7;
  EXPECT_NEAR(info("in.exr")["illuminance"]["lux"].get<double>(), 3.14159265 * y, 1e-4);
  succeeds({"convert", "in.exr", "lux.exr", "--scale-to", "lux=1000", "-q"});
  EXPECT_NEAR(info("lux.exr")["illuminance"]["lux"].get<double>(), 1000, 0.1);
  succeeds({"convert", "in.exr", "nits.exr", "--scale-to", "nits=50", "--towards", "1,0,0", "-q"});
  EXPECT_NEAR(info("nits.exr")["illuminance"]["lux"].get<double>(), 3.14159265 * 50, 0.02);
  EXPECT_EQ(info("nits.exr")["white_luminance"], 1);
  succeeds({"convert", "nits.exr", "dark.exr", "--exposure", "-3", "-q"});  // Of the same light.
  EXPECT_EQ(info("dark.exr")["white_luminance"], 8);
  for (const std::string file : {"dark.ktx2", "dark.ktx", "dark.tif"}) {
    succeeds({"convert", "dark.exr", file, "--to", "cube", "-q"});
    EXPECT_EQ(info(file)["white_luminance"], 8) << file;
    EXPECT_NEAR(info(file)["illuminance"]["lux"].get<double>(), 3.14159265 * 50, 0.1) << file;
  }
  EXPECT_NE(envmap({"convert", "dark.exr", "dark.hdr"}).err.find("radiance 1 is 8 cd/m^2"), std::string::npos);
  succeeds({"convert", "nits.exr", "sum.exr", "--add", "dark.exr"});
  EXPECT_NEAR(info("sum.exr")["illuminance"]["lux"].get<double>(), 2 * 3.14159265 * 50, 0.1);
  EXPECT_NE(envmap({"convert", "nits.exr", "sum.exr", "--add", "in.exr"}).err.find("in.exr does not state its unit"),
            std::string::npos);
  EXPECT_NE(envmap({"compare", "nits.exr", "dark.exr"}).err.find("8 in dark.exr"), std::string::npos);
  succeeds({"convert", "in.exr", "white.exr", "--white", "0,0,1"});
  expect_mean("white.exr", y, y, y);
  succeeds({"convert", "in.exr", "grey.exr", "--saturation", "0"});
  expect_mean("grey.exr", y, y, y);
  succeeds({"convert", "in.exr", "gain.exr", "--gain", "1,2,0.5"});
  expect_mean("gain.exr", 0.2, 1, 0.35);
  fails(2, {"convert", "in.exr", "x.exr", "--scale-to", "lumens=3"}, {"lumens=3", "lux=E"});
  fails(2, {"convert", "in.exr", "x.exr", "--scale-to", "lux=3", "--exposure", "1"}, {"--exposure"});
  succeeds({"convert", "in.exr", "warm.exr", "--white", "3200"});
  succeeds({"convert", "in.exr", "same.exr", "--white", "3200K"});
  EXPECT_TRUE(read("warm.exr") == read("same.exr"));
  fails(2, {"convert", "in.exr", "x.exr", "--white", "blue"}, {"'blue'"});
  fails(2, {"convert", "in.exr", "x.exr", "--white", "50"}, {"1000 to 25000"});
  fails(2, {"convert", "in.exr", "x.exr", "--gain", "1,-1,1"}, {"--gain"});
}

}  // namespace
}  // namespace command_tests::colour_test

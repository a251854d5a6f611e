// What files state of where their texels belong: KTX of 2010, lights of glTF, panoramas of cameras, faces and borders.
#include <cmath>

#include "claims.h"
#include "picture.h"
#include "run.h"

namespace command_tests::place_test {
namespace {

class Place : public CommandTest {
 protected:
  void is_toward(const std::string& file, const Vec& expected, const std::vector<std::string>& options = {}) const {
    std::vector<std::string> command{"info", file};
    command.insert(command.end(), options.begin(), options.end());
    const auto found = report(command)["brightest"]["direction"];
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(found[k].get<double>(), expected[k], 1e-6) << file << found;
  }
};

// ---- KTX 1.0, section 2 ---------------------------------------------------------------------------------------------

struct Ktx {
  unsigned type, format, internal, size, faces, levels = 1;

  [[nodiscard]] std::string bytes() const {
    std::string all("\xabKTX 11\xbb\r\n\x1a\n", 12);
    for (const unsigned word :
         {0x04030201U, type, 1U, format, internal, 0x1907U, size, size, 0U, 0U, faces, levels, 0U})
      all += little(word, 4);
    return all;
  }
};

constexpr unsigned rgb16f = 0x881b, rgba16f = 0x881a, rgb8 = 0x8051, half = 0x140b, rgb = 0x1907;

// 1, 2, 3 ... as halfs: no two texels are alike.
std::string counted(int& next, int texels) {
  std::string all;
  for (int k = 0; k < texels; ++k)
    for (int c = 0; c < 3; ++c) {
      const int value = c == 0 ? next++ : 1, exponent = int(std::log2(value));
      all += little(unsigned((exponent + 15) << 10 | ((value - (1 << exponent)) << 10) >> exponent), 2);
    }
  return all;
}

TEST_F(Place, KtxWithoutTypeIsWhatItsInternalFormatSays) {
  std::string faces;
  for (int face = 0; face < 6; ++face)
    faces += little(0x3c00, 2) + little(0x4000, 2) + little(0x4200, 2) + little(0x3c00, 2);
  write("a.ktx", Ktx{0, 0, rgba16f, 1, 6}.bytes() + little(8, 4) + faces);
  EXPECT_EQ(report({"info", "a.ktx"})["maximum"], (std::vector<double>{1, 2, 3}));
}

TEST_F(Place, KtxWithFloatsOfAHalfFormatIsReadByItsType) {
  std::string faces;
  for (int face = 0; face < 6; ++face) faces += little_float(1) + little_float(2) + little_float(3);
  write("a.ktx", Ktx{0x1406, rgb, rgb16f, 1, 6}.bytes() + little(12, 4) + faces);
  EXPECT_EQ(report({"info", "a.ktx"})["maximum"], (std::vector<double>{1, 2, 3}));
}

// Rows and faces of 3x3 half RGB: as KTX has them, without padding of rows, without any, and as cmft writes them (rows
// padded, but sizes and what pads faces are those without).
TEST_F(Place, KtxRowsArePaddedInFourWays) {
  struct Way {
    const char* name;
    unsigned size, row, face;
  };
  for (const Way& way : {Way{"as specified", 60, 2, 0}, {"images", 54, 0, 2}, {"none", 54, 0, 0}, {"cmft", 54, 2, 2}}) {
    SCOPED_TRACE(way.name);
    std::string all = Ktx{half, rgb, rgb16f, 3, 6}.bytes() + little(way.size, 4);
    int next = 1;
    for (int face = 0; face < 6; ++face) {
      for (int row = 0; row < 3; ++row) all += counted(next, 3) + std::string(way.row, '\x7c');
      all += std::string(way.face, '\x7c');
    }
    write("a.ktx", all);
    const auto told = report({"info", "a.ktx"});
    EXPECT_EQ(told["maximum"][0], 54);
    EXPECT_EQ(told["maximum"][1], 1);
    // The last texel of all, at the lower right of -Z as the API has it: (-s, -t, -1).
    is_toward("a.ktx", {-2 / std::sqrt(17.0), -2 / std::sqrt(17.0), -3 / std::sqrt(17.0)});
    write("a.ktx", all + std::string(8, '\0'));
    fails(3, {"info", "a.ktx"}, {"not supported", "leave", "bytes over"});
    write("a.ktx", all.substr(0, all.size() - 8));
    fails(3, {"info", "a.ktx"}, {"a.ktx"});
  }
}

// ---- EXT_lights_image_based -----------------------------------------------------------------------------------------

std::string base64(const std::string& bytes) {
  constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    std::uint32_t bits = 0;
    for (std::size_t j = 0; j < 3; ++j)
      bits = bits << 8 | (k + j < bytes.size() ? static_cast<unsigned char>(bytes[k + j]) : 0U);
    for (std::size_t j = 0; j < 4; ++j) text += k + j > bytes.size() ? '=' : digits[bits >> (18 - 6 * j) & 63];
  }
  return text;
}

// A light whose images are at these URIs; face 0 of a file is -X of the world, as Babylon.js shows it.
nlohmann::json light_of(const std::vector<std::string>& uris) {
  nlohmann::json images = nlohmann::json::array(), faces = nlohmann::json::array();
  for (std::size_t k = 0; k < uris.size(); ++k) images.push_back({{"uri", uris[k]}}), faces.push_back(k);
  const nlohmann::json light{{"irradianceCoefficients", nlohmann::json::array()},
                             {"specularImageSize", 4},
                             {"specularImages", nlohmann::json::array({faces})}};
  return {{"asset", {{"version", "2.0"}}},
          {"extensionsUsed", {"EXT_lights_image_based"}},
          {"extensions", {{"EXT_lights_image_based", {{"lights", nlohmann::json::array({light})}}}}},
          {"scenes", {{{"extensions", {{"EXT_lights_image_based", {{"light", 0}}}}}}}},
          {"images", images}};
}

nlohmann::json& light_in(nlohmann::json& gltf) { return gltf["extensions"]["EXT_lights_image_based"]["lights"][0]; }

TEST_F(Place, LightsOfGltfTurnAndShine) {
  const std::string white = png(4, 4, 8, {255, 255, 255}, ""), grey = png(4, 4, 8, {64, 64, 64}, "");
  write("white.png", white);
  std::vector<std::string> uris{"white.png"};
  for (int face = 1; face < 6; ++face) uris.push_back("data:image/png;base64," + base64(grey));
  nlohmann::json gltf = light_of(uris);
  write("a.gltf", gltf.dump());
  is_toward("a.gltf", {-1, 0, 0});
  EXPECT_NEAR(report({"info", "a.gltf"})["minimum"][0].get<double>(), std::pow(64 / 255.0, 2.2), 1e-6);
  const double r = std::sqrt(0.5);
  // Right-handed turns, as of nodes: 90 degrees about +Y takes -X to +Z; about +Z to -Y; 60 degrees about +Y between.
  const std::vector<std::pair<std::vector<double>, Vec>> turns{{{0, r, 0, r}, {0, 0, 1}},
                                                               {{0, 0.7071, 0, 0.7071}, {0, 0, 1}},
                                                               {{0, 0, r, r}, {0, -1, 0}},
                                                               {{0, 1, 0, 0}, {1, 0, 0}}};
  for (const auto& [quaternion, expected] : turns) {
    light_in(gltf)["rotation"] = quaternion;
    write("a.gltf", gltf.dump());
    is_toward("a.gltf", expected);
  }
  light_in(gltf)["rotation"] = {0, 0.5, 0, std::sqrt(0.75)};
  light_in(gltf)["intensity"] = 2.5;
  write("a.gltf", gltf.dump());
  succeeds({"convert", "a.gltf", "a.exr", "--to", "latlong", "--size", "64"});
  const auto told = report({"info", "a.exr"});
  EXPECT_NEAR(told["maximum"][0].get<double>(), 2.5, 2e-3);
  EXPECT_NEAR(told["brightest"]["direction"][0].get<double>(), -0.5, 0.1);
  EXPECT_NEAR(told["brightest"]["direction"][2].get<double>(), std::sqrt(0.75), 0.1);
}

TEST_F(Place, FacesOfGltfLightsMayBeJpeg) {
  save(path("white.jpg"), Picture::filled(4, 4, 1), OIIO::TypeDesc::UINT8);
  save(path("grey.jpg"), Picture::filled(4, 4, 64 / 255.0F), OIIO::TypeDesc::UINT8);
  std::vector<std::string> uris(6, "grey.jpg");
  uris[4] = "white.jpg";
  write("a.gltf", light_of(uris).dump());
  is_toward("a.gltf", {0, 0, 1});
  EXPECT_NEAR(report({"info", "a.gltf"})["minimum"][0].get<double>(), std::pow(64 / 255.0, 2.2), 1e-2);
}

TEST_F(Place, DamagedLightsOfGltfAreNamed) {
  write("white.png", png(4, 4, 8, {255, 255, 255}, ""));
  const std::vector<std::string> uris(6, "white.png");
  const auto refuse = [&](const auto& change, const std::vector<std::string>& words) {
    nlohmann::json gltf = light_of(uris);
    change(gltf);
    write("a.gltf", gltf.dump());
    fails(3, {"convert", "a.gltf", "a.exr"}, words);
  };
  refuse([](auto& g) { light_in(g)["rotation"] = {0, 1, 0}; }, {"rotation", "3 values"});
  refuse([](auto& g) { light_in(g)["rotation"] = {0, 2, 0, 0}; }, {"rotation", "no unit quaternion"});
  refuse([](auto& g) { light_in(g)["intensity"] = -1; }, {"intensity"});
  refuse([](auto& g) { light_in(g)["specularImages"][0].erase(0); }, {"specularImages[0]", "5 images"});
  refuse([](auto& g) { g["images"][3]["uri"] = "none.png"; }, {"images[3].uri", "none.png", "missing"});
  refuse([](auto& g) { g["scenes"][0]["extensions"]["EXT_lights_image_based"]["light"] = 7; }, {"light", "7"});
  refuse([](auto& g) { g.erase("extensions"); }, {"without a light of EXT_lights_image_based"});
  write("text.png", "no picture");
  refuse([](auto& g) { g["images"][0]["uri"] = "text.png"; }, {"no PNG image"});
}

// ---- GPano ----------------------------------------------------------------------------------------------------------

// XMP in a segment APP1 (ISO 16684-3).
std::string with_xmp(const std::string& jpeg, const std::string& attributes) {
  const std::string xmp = "http://ns.adobe.com/xap/1.0/" + std::string(1, '\0') +
                          R"(<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF )"
                          R"(xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#"><rdf:Description rdf:about="" )"
                          R"(xmlns:GPano="http://ns.google.com/photos/1.0/panorama/" )" +
                          attributes + "/></rdf:RDF></x:xmpmeta>";
  return jpeg.substr(0, 2) + "\xff\xe1" + big(xmp.size() + 2, 2) + xmp + jpeg.substr(2);
}

std::string crop_of(int full_width, int full_height, int width, int height, int left, int top) {
  const auto number = [](const std::string& name, int n) {
    return "GPano:" + name + "=\"" + std::to_string(n) + "\" ";
  };
  return number("FullPanoWidthPixels", full_width) + number("FullPanoHeightPixels", full_height) +
         number("CroppedAreaImageWidthPixels", width) + number("CroppedAreaImageHeightPixels", height) +
         number("CroppedAreaLeftPixels", left) + number("CroppedAreaTopPixels", top);
}

TEST_F(Place, PanoramasLieWhereTheirCameraSays) {
  save(path("plain.jpg"), Picture::filled(40, 16, 1), OIIO::TypeDesc::UINT8);
  const auto placed = [&](const std::string& crop) {
    write("a.jpg", with_xmp(read("plain.jpg"), crop));
    const Result run = envmap({"convert", "a.jpg", "a.pfm", "--to", "latlong"});
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_NE(run.err.find("what is missing is black"), std::string::npos) << run.err;
    return load(path("a.pfm"));
  };
  const auto check = [](const Picture& p, int left, int top) {
    ASSERT_EQ(p.width, 128);
    ASSERT_EQ(p.height, 64);
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 128; ++x) {
        const bool inside = x >= left && x < left + 40 && y >= top && y < top + 16;
        ASSERT_NEAR(p.at(x, y)[0], inside ? 1 : 0, 0.02) << x << ' ' << y;
      }
  };
  check(placed(crop_of(128, 64, 40, 16, 50, 30)), 50, 30);
  // Made smaller since.
  check(placed(crop_of(1280, 640, 400, 160, 500, 300)), 50, 30);
  // --from says what the image is.
  write("square.jpg", with_xmp(read("plain.jpg"), R"(GPano:ProjectionType="cylindrical")"));
  fails(3, {"info", "square.jpg"}, {"not supported", "GPano", "cylindrical"});
}

TEST_F(Place, PanoramasThatContradictThemselvesAreNamed) {
  save(path("plain.jpg"), Picture::filled(40, 16, 1), OIIO::TypeDesc::UINT8);
  const auto refuse = [&](const std::string& attributes, const std::vector<std::string>& words) {
    write("a.jpg", with_xmp(read("plain.jpg"), attributes));
    fails(3, {"info", "a.jpg"}, words);
  };
  refuse(crop_of(128, 64, 40, 16, 100, 30), {"damaged", "GPano"});
  refuse(crop_of(128, 64, 40, 17, 50, 50), {"damaged", "GPano"});
  refuse(crop_of(128, 64, 20, 16, 50, 30), {"damaged", "GPano", "shape"});
  refuse(crop_of(128, 100, 40, 16, 50, 30), {"not supported", "GPano", "2:1"});
  refuse(crop_of(0, 0, 0, 0, 0, 0), {"damaged", "GPano"});
  refuse(R"(GPano:FullPanoWidthPixels="128")", {"damaged", "FullPanoHeightPixels"});
  refuse(crop_of(128, 64, 40, 16, 50, 30) + R"(GPano:PosePitchDegrees="steep")", {"damaged", "PosePitchDegrees"});
}

// A sun in the middle of an image whose camera looked up, or was turned or tilted.
TEST_F(Place, APoseIsAppliedOnRequest) {
  Picture sun = Picture::filled(128, 64, 0);
  for (const int x : {63, 64})
    for (const int y : {31, 32})
      for (int c = 0; c < 3; ++c) sun.at(x, y)[c] = 1;
  for (int c = 0; c < 3; ++c) sun.at(31, 32)[c] = sun.at(32, 31)[c] = sun.at(31, 31)[c] = sun.at(32, 32)[c] = 0.5F;
  save(path("plain.jpg"), sun, OIIO::TypeDesc::UINT8);
  const auto look = [&](const std::string& pose) {
    write("a.jpg", with_xmp(read("plain.jpg"), pose));
    const Result run = envmap({"convert", "a.jpg", "a.exr", "--apply-pose", "-q"});
    EXPECT_EQ(run.status, 0) << run.err;
    return report({"info", "a.exr"})["brightest"]["direction"];
  };
  const auto expect = [](const nlohmann::json& found, const Vec& d) {
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(found[k].get<double>(), d[k], 0.06) << found;
  };
  expect(look(""), {0, 0, 1});
  // +Z is in the middle and -X on the right of it.
  expect(look(R"(GPano:PoseHeadingDegrees="90")"), {-1, 0, 0});
  expect(look(R"(GPano:PosePitchDegrees="30")"), {0, 0.5, std::sqrt(0.75)});
  const Result run = envmap({"info", "a.jpg", "--json"});
  EXPECT_NE(run.err.find("pitch 30"), std::string::npos) << run.err;
  EXPECT_NE(run.out.find("ignored"), std::string::npos) << run.out;
}

// The horizon stands counter-clockwise in the image, by a quarter: the sky is on its left.
TEST_F(Place, ARollTurnsTheHorizonClockwise) {
  Picture left = Picture::filled(128, 64, 0);
  for (int x = 28; x < 36; ++x)
    for (int y = 28; y < 36; ++y)
      for (int c = 0; c < 3; ++c) left.at(x, y)[c] = 1;
  save(path("plain.jpg"), left, OIIO::TypeDesc::UINT8);
  write("a.jpg", with_xmp(read("plain.jpg"), R"(GPano:PoseRollDegrees="90")"));
  succeeds({"convert", "a.jpg", "a.exr", "--apply-pose", "-q"});
  const auto d = report({"info", "a.exr"})["brightest"]["direction"];
  EXPECT_GT(d[1].get<double>(), 0.9) << d;
}

// ---- faces of one image, and borders --------------------------------------------------------------------------------

TEST_F(Place, FacesOfOneImageMayHaveAnyOrder) {
  const Picture column = cube_directions("column", 4);
  const std::array<int, 6> order{4, 5, 2, 3, 1, 0};
  for (const bool row : {false, true}) {
    Picture other = row ? Picture::filled(24, 4) : Picture::filled(4, 24);
    for (int k = 0; k < 6; ++k)
      for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 4; ++x)
          std::copy_n(column.at(x, 4 * order[std::size_t(k)] + y), 3,
                      row ? other.at(4 * k + x, y) : other.at(x, 4 * k + y));
    save(path("other.pfm"), other);
    succeeds({"convert", "other.pfm", "a.pfm", "--layout", "column", "--from-faces", "pz,nz,py,ny,nx,px"});
    EXPECT_EQ(load(path("a.pfm")), column);
    succeeds({"convert", "other.pfm", "a.pfm", "--layout", "column", "--from-faces", "+Z,-Z,+Y,-Y,-X,+X"});
    EXPECT_EQ(load(path("a.pfm")), column);
  }
  // Seen from outside, as the APIs have it: X and Z mirrored left to right, Y top to bottom.
  Picture outside = Picture::filled(4, 24);
  for (int k = 0; k < 6; ++k)
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 4; ++x) {
        const bool is_y = k == 2 || k == 3;
        std::copy_n(column.at(is_y ? x : 3 - x, 4 * k + (is_y ? 3 - y : y)), 3, outside.at(x, 4 * k + y));
      }
  save(path("outside.pfm"), outside);
  succeeds({"convert", "outside.pfm", "a.pfm", "--layout", "column", "--from-faces", "gl"});
  EXPECT_EQ(load(path("a.pfm")), column);
  fails(2, {"info", "outside.pfm", "--from-faces", "px,nx,py,ny,pz,front"}, {"'front'", "px, nx"});
  fails(2, {"info", "outside.pfm", "--from-faces", "px,nx,py,ny,pz,+X"}, {"px", "twice"});
  save(path("latlong.pfm"), latlong_directions(4));
  fails(2, {"info", "latlong.pfm", "--from-faces", "gl"}, {"no cube map"});
}

TEST_F(Place, BordersAreSaidWhereNoAttributeSaysThem) {
  save(path("border.pfm"), latlong_directions(64, true));
  save(path("centre.pfm"), latlong_directions(64));
  succeeds({"convert", "border.pfm", "a.pfm", "--border-samples", "-q"});
  EXPECT_LT(difference(load(path("a.pfm")), load(path("centre.pfm"))), 2e-3);
  EXPECT_GT(difference(load(path("border.pfm")), load(path("centre.pfm"))), 1e-2);
  fails(2, {"info", "border.pfm", "--border-samples", "--ignore-envmap-attribute"}, {"--border-samples"});
  save(path("ball.pfm"), Picture::filled(8, 8, 1));
  fails(3, {"info", "ball.pfm", "--from", "sphere", "--border-samples"}, {"latlong maps and cubes"});
}

// ---- words ----------------------------------------------------------------------------------------------------------

TEST_F(Place, SoundFilesThatAreNotReadAreNotCalledDamaged) {
  write("a.png", png(2, 1, 8, {1, 2, 3}, png_chunk("XYZz", "12")));
  fails(3, {"info", "a.png"}, {"a.png: not supported: PNG with the chunk XYZz", "save it again"});
  write("a.png", png(2, 1, 8, {1, 2, 3}, png_chunk("xYZz", "12")));
  EXPECT_EQ(envmap({"info", "a.png"}).status, 0);
}

// Double precision in separate planes, three rows a strip: OpenImageIO reads strips forward only.
TEST_F(Place, StripsOfPlanesAreReadInTheirOrder) {
  const Picture picture = latlong_directions(150);
  OIIO::ImageSpec spec;
  spec.attribute("planarconfig", "separate");
  spec.attribute("compression", "zip");
  spec.attribute("tiff:RowsPerStrip", 3);
  save(path("planes.tif"), picture, OIIO::TypeDesc::DOUBLE, spec);
  succeeds({"convert", "planes.tif", "a.pfm"});
  EXPECT_LT(difference(load(path("a.pfm")), picture), 1e-6);
}

// ---- portable float maps --------------------------------------------------------------------------------------------

TEST_F(Place, PortableFloatMapsHaveAnyHeader) {
  std::string texels;
  for (int k = 1; k <= 6; ++k) texels += little_float(float(k));
  for (const char* header :
       {"PF\n2 1\n-1.0\n", "PF\r\n2 1\r\n-1.0\r\n", "PF 2 1 -1 ", "PF\n# a comment\n2 1\n-1\n", "PF\r2 1\r-1.0\r"}) {
    write("a.pfm", header + texels);
    EXPECT_EQ(report({"info", "a.pfm"})["maximum"], (std::vector<double>{4, 5, 6})) << header;
  }
  // A first byte that looks like the end of a line.
  std::string odd = texels;
  odd[0] = '\n';
  write("a.pfm", "PF\r2 1\r-1.0\r" + odd);
  EXPECT_EQ(report({"info", "a.pfm"})["maximum"], (std::vector<double>{4, 5, 6}));
  const auto refuse = [&](const std::string& header, const std::vector<std::string>& words) {
    write("a.pfm", header + texels);
    fails(3, {"convert", "a.pfm", "a.exr", "--repair"}, words);
  };
  refuse("PF\n2 1\n0\n", {"damaged", "scale is 0"});
  refuse("PF\n2 1\nnan\n", {"damaged", "scale"});
  refuse("PF\n2 -1\n-1\n", {"damaged", "2x-1"});
  refuse("PF4\n2 1\n-1\n", {"not supported", "PF4"});
  refuse("PF\n2 x\n-1\n", {"damaged", "height"});
}

}  // namespace
}  // namespace command_tests::place_test

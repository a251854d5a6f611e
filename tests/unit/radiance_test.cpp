// Radiance pictures: made by hand as the format defines them, and what we write read by OpenImageIO.
#include "envmap/io/formats/radiance.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <random>
#include <string>

#include "envmap/base/error.h"
#include "envmap/io/formats/openimageio_module.h"
#include "envmap/io/images/exif_orientation.h"

namespace radiance_test {
namespace {

using namespace envmap;

struct Read {
  int width, height;
  std::vector<Colour> pixels;
  ImageFacts facts;
};

Read read_bytes(const std::string& bytes) {
  const InputFile file(std::vector<char>(bytes.begin(), bytes.end()));
  ImageReader reader = open_radiance(file);
  const ImageFacts facts = reader.facts;
  if (facts.orientation != Orientation::upright) reader = turned_upright(std::move(reader));
  Read r{reader.facts.width, reader.facts.height, {}, facts};
  r.pixels.resize(std::size_t(r.width * r.height));
  // In two bands, the second first: rows may be asked for in any order.
  const int half = r.height / 2;
  const std::span<float> all(&r.pixels.data()->x, 3 * r.pixels.size());
  const auto first = std::size_t(3 * half * r.width);
  reader.read(0, half, r.height, 0, 3, all.subspan(first));
  reader.read(0, 0, half, 0, 3, all.first(first));
  return r;
}

std::string why(const std::string& bytes) {
  try {
    read_bytes(bytes);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

std::string file(const std::string& variables, const std::string& resolution, const std::string& data) {
  return "#?RADIANCE\n" + variables + "FORMAT=32-bit_rle_rgbe\n\n" + resolution + "\n" + data;
}

// A texel whose value is (r, g, b) / 256: exponent 0 is 128.
std::string texel(int r, int g, int b, int e = 128) {
  return {static_cast<char>(r), static_cast<char>(g), static_cast<char>(b), static_cast<char>(e)};
}

TEST(Radiance, FlatOldAndNewRunsAreTheSamePicture) {
  // Ten texels a row: 20 20 20 20 20 20 20 20 30 40.
  const std::string a = texel(20, 40, 60, 129), b = texel(30, 0, 1), c = texel(40, 255, 7, 0);
  std::string flat, olds, news;
  for (int k = 0; k < 8; ++k) flat += a;
  flat += b + c;
  olds = a + texel(1, 1, 1, 7) + b + c;
  const auto channel = [](int eight, int ninth, int tenth) {
    return std::string{static_cast<char>(136), static_cast<char>(eight), 2, static_cast<char>(ninth),
                       static_cast<char>(tenth)};
  };
  news =
      std::string{2, 2, 0, 10} + channel(20, 30, 40) + channel(40, 0, 255) + channel(60, 1, 7) + channel(129, 128, 0);
  for (const std::string& data : {flat, olds, news}) {
    const Read r = read_bytes(file("", "-Y 2 +X 10", data + data));
    ASSERT_EQ(r.width, 10);
    for (std::size_t row = 0; row < 20; row += 10) {
      for (std::size_t k = 0; k < 8; ++k) EXPECT_EQ(r.pixels[row + k], Colour(20, 40, 60) / 128.0F);
      EXPECT_EQ(r.pixels[row + 8], Colour(30, 0, 1) / 256.0F);
      EXPECT_EQ(r.pixels[row + 9], Colour(0)) << "exponent 0";
    }
  }
}

// Old runs of more than 255 have their further digits in further texels: 300 = 44 + 256.
TEST(Radiance, LongOldRuns) {
  const std::string data = texel(128, 64, 0) + texel(1, 1, 1, 44) + texel(1, 1, 1, 1);
  const Read r = read_bytes(file("", "-Y 1 +X 301", data));
  for (const Colour& c : r.pixels) EXPECT_EQ(c, Colour(0.5F, 0.25F, 0));
}

// A picture of 3 x 2 whose texel (x, y) from the top left is 1 + x + 3 y, stored in every order the format has.
TEST(Radiance, AllEightOrientations) {
  const struct {
    const char* resolution;
    std::function<int(int scanline, int k)> value;
  } all[] = {
      {"-Y 2 +X 3", [](int s, int k) { return 1 + k + 3 * s; }},
      {"-Y 2 -X 3", [](int s, int k) { return 1 + (2 - k) + 3 * s; }},
      {"+Y 2 +X 3", [](int s, int k) { return 1 + k + 3 * (1 - s); }},
      {"+Y 2 -X 3", [](int s, int k) { return 1 + (2 - k) + 3 * (1 - s); }},
      {"+X 3 -Y 2", [](int s, int k) { return 1 + s + 3 * k; }},
      {"-X 3 -Y 2", [](int s, int k) { return 1 + (2 - s) + 3 * k; }},
      {"+X 3 +Y 2", [](int s, int k) { return 1 + s + 3 * (1 - k); }},
      {"-X 3 +Y 2", [](int s, int k) { return 1 + (2 - s) + 3 * (1 - k); }},
  };
  for (const auto& each : all) {
    const bool by_rows = each.resolution[1] == 'Y';
    std::string data;
    for (int s = 0; s < (by_rows ? 2 : 3); ++s)
      for (int k = 0; k < (by_rows ? 3 : 2); ++k) data += texel(each.value(s, k), 0, 0, 136);
    const Read r = read_bytes(file("", each.resolution, data));
    ASSERT_EQ(r.width, 3) << each.resolution;
    ASSERT_EQ(r.height, 2);
    for (std::size_t k = 0; k < 6; ++k) EXPECT_EQ(r.pixels[k].x, float(k + 1)) << each.resolution;
  }
}

TEST(Radiance, ExposuresAreDividedOut) {
  const Read r = read_bytes(file("EXPOSURE=2\nEXPOSURE= 4.0\nCOLORCORR= 1 0.5 2\n# EXPOSURE=9\nVIEW= -vp 0 0 0\n",
                                 "-Y 1 +X 1", texel(128, 128, 128, 132)));
  EXPECT_EQ(r.pixels[0], Colour(1, 2, 0.5F)) << "8 / (2 x 4) and the corrections";
  ASSERT_EQ(r.facts.details.size(), 1U);
  EXPECT_NE(r.facts.details[0].find("EXPOSURE"), std::string::npos);
}

// Equal energy is white of Radiance's primaries; 179 lumens make a watt. The luminance of red, green and blue of these
// primaries is 0.265, 0.670 and 0.065 (Radiance's color.h), so Y of white is their sum.
TEST(Radiance, XyzBecomesRgb) {
  const auto read = [](int x, int y, int z) {
    std::string bytes = file("", "-Y 1 +X 1", texel(x, y, z, 136));
    bytes.replace(bytes.find("rgbe"), 4, "xyze");
    return read_bytes(bytes).pixels[0];
  };
  const Colour white = read(179, 179, 179);
  EXPECT_NEAR(white.x, 1, 1e-6);
  EXPECT_NEAR(white.y, 1, 1e-6);
  EXPECT_NEAR(white.z, 1, 1e-6);
  const Colour some = read(150, 120, 90);
  EXPECT_NEAR(0.265 * some.x + 0.670 * some.y + 0.065 * some.z, 120.0 / 179, 1e-3);
}

TEST(Radiance, DamageIsNamed) {
  const std::string good = file("", "-Y 1 +X 9", std::string{2, 2, 0, 9});
  EXPECT_NE(why(good).find("ends too early"), std::string::npos);
  EXPECT_NE(why(good + std::string{static_cast<char>(138), 1}).find("leaves its row"), std::string::npos);
  EXPECT_NE(why(good + std::string{0, 1}).find("leaves its row"), std::string::npos);
  EXPECT_NE(why(file("", "-Y 1 +X 9", std::string{2, 2, 0, 8, 1, 1})).find("another length"), std::string::npos);
  EXPECT_NE(why(file("", "-Y 1 +X 2", texel(1, 1, 1, 1) + texel(0, 0, 0))).find("leaves its row"), std::string::npos);
  EXPECT_NE(why(file("", "-Y 1 +X 2", texel(9, 9, 9) + texel(1, 1, 1, 2))).find("leaves its row"), std::string::npos);
  EXPECT_NE(why(file("", "-Y 1 -Y 2", texel(9, 9, 9))).find("no resolution"), std::string::npos);
  EXPECT_NE(why(file("", "-Y 0 +X 2", texel(9, 9, 9))).find("no resolution"), std::string::npos);
  EXPECT_NE(why(file("", "-Y 9999999999 +X 2", texel(9, 9, 9))).find("no resolution"), std::string::npos);
  EXPECT_NE(why(file("", "-Y 2147483647 +X 2147483647", texel(9, 9, 9))).find("cannot hold"), std::string::npos);
  EXPECT_NE(why(file("EXPOSURE=-1\n", "-Y 1 +X 1", texel(9, 9, 9))).find("EXPOSURE"), std::string::npos);
  EXPECT_NE(why(file("COLORCORR=1 nan 1\n", "-Y 1 +X 1", texel(9, 9, 9))).find("COLORCORR"), std::string::npos);
  EXPECT_NE(why("#?RADIANCE\nFORMAT=what\n\n").find("FORMAT"), std::string::npos);
  EXPECT_NE(why("#?RADIANCE\n" + std::string(100000, 'x')).find("no end"), std::string::npos);
}

// Rows with runs, with noise and with both, as wide as each way of writing takes them: OpenImageIO reads the bytes that
// we meant, and so do we. Each channel is right to half a step of the largest.
TEST(Radiance, WhatIsWrittenIsReadByOthers) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> any(0, 1);
  std::string name = (std::filesystem::temp_directory_path() / "envmap-radiance-XXXXXX").string();
  const std::filesystem::path folder = ::mkdtemp(name.data());
  for (const int width : {1, 7, 8, 127, 128, 129, 400, 32768}) {
    const int height = 3;
    std::vector<Colour> picture;
    for (int k = 0; k < width * height; ++k) {
      const float scale = std::ldexp(1.0F, int(any(random) * 40) - 20);
      const bool repeat = any(random) < (k % 2000 < 1000 ? 0.9F : 0.1F) && !picture.empty();
      picture.push_back(repeat ? picture.back() : scale * Colour(any(random), any(random), any(random)));
    }
    picture[0] = Colour(0, 0, 0);
    const std::string path = (folder / "a.hdr").string();
    {
      OutputFile out(path);
      const ImageWriter writer = create_radiance(out, {.levels = {{width, height}}});
      writer.write(0, 0, 2, std::span(picture).first(std::size_t(2 * width)));
      writer.write(0, 2, 3, std::span(picture).subspan(std::size_t(2 * width)));
      writer.close();
      out.commit();
    }
    const InputFile ours(path);
    const ImageReader own = open_radiance(ours), other = formats().open("hdr", path, {}, false, false);
    std::vector<Colour> a(picture.size()), b(picture.size());
    own.read(0, 0, height, 0, 3, {&a.data()->x, 3 * a.size()});
    other.read(0, 0, height, 0, 3, {&b.data()->x, 3 * b.size()});
    for (std::size_t k = 0; k < picture.size(); ++k) {
      ASSERT_EQ(a[k], b[k]) << width << ' ' << k;
      const float most = std::max({picture[k].x, picture[k].y, picture[k].z});
      for (int c = 0; c < 3; ++c) ASSERT_LE(std::abs(a[k][c] - picture[k][c]), most / 256);
    }
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace radiance_test

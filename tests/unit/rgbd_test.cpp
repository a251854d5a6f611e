// Radiance as bytes of RGBD, by the formula of Babylon.js' fromRGBD in long double.
#include "envmap/io/texels/rgbd.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "envmap/io/formats/png.h"

namespace envmap::rgbd_test {
namespace {

using Bytes = std::array<std::byte, 4>;

Bytes bytes_of(const Colour& c) {
  Bytes b;
  encode_rgbd(std::span(&c, 1), b);
  return b;
}

Colour colour_of(const Bytes& b) {
  Colour c;
  decode_rgbd(b, std::span(&c, 1));
  return c;
}

long double meant(int byte, int alpha) { return std::pow(byte / 255.0L, 2.2L) / (alpha / 255.0L); }

TEST(Rgbd, KnownValues) {
  const auto all = [](int v) { return Bytes{std::byte(v), std::byte(v), std::byte(v), std::byte{255}}; };
  EXPECT_EQ(bytes_of(Colour(0)), all(0));
  EXPECT_EQ(bytes_of(Colour(1)), all(255));
  EXPECT_EQ(colour_of(all(255)), Colour(1));
  EXPECT_EQ(bytes_of(Colour(255, 0, 0)), (Bytes{std::byte{255}, std::byte{0}, std::byte{0}, std::byte{1}}));
  EXPECT_EQ(colour_of({std::byte{255}, std::byte{0}, std::byte{0}, std::byte{1}}), Colour(255, 0, 0));
  EXPECT_EQ(colour_of({std::byte{9}, std::byte{9}, std::byte{9}, std::byte{0}}), Colour(0));  // Not infinite.
}

TEST(Rgbd, TheNearestByteUnderTheLargestAlpha) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> stops(-12, 7.9F);
  double worst = 0;
  for (int n = 0; n < 4000; ++n) {
    const Colour c(std::exp2(stops(random)), std::exp2(stops(random)), std::exp2(stops(random)));
    const Bytes b = bytes_of(c);
    const Colour back = colour_of(b);
    const float most = std::max({c.x, c.y, c.z});
    const int alpha = std::to_integer<int>(b[3]);
    EXPECT_EQ(alpha, std::clamp(int(255 / most), 1, 255));
    for (int k = 0; k < 3; ++k) {
      const int byte = std::to_integer<int>(b[std::size_t(k)]);
      EXPECT_NEAR(back[k], meant(byte, alpha), 1e-6L * meant(byte, alpha));
      const long double off = std::abs(meant(byte, alpha) - c[k]);
      for (const int other : {std::max(0, byte - 1), std::min(255, byte + 1)})
        EXPECT_LE(off, std::abs(meant(other, alpha) - c[k]) * 1.00001L);
    }
    if (most > 1) worst = std::max(worst, double(std::abs(back[0] - c[0]) / most));
  }
  EXPECT_LT(worst, 0.006);  // What bake --list says of values above 1.
  EXPECT_GT(worst, 0.003);
}

TEST(Rgbd, PngKeepsBytesUnderAnyAlpha) {
  std::vector<std::byte> rgba(4 * 5 * 3);
  for (std::size_t k = 0; k < rgba.size(); ++k) rgba[k] = static_cast<std::byte>(k * 37 % 256);
  rgba[3] = std::byte{0};
  const std::vector<char> png = png_of_rgba(rgba, 5, 3);
  const RgbaImage back = rgba_of_png(std::as_bytes(std::span(png)));
  EXPECT_EQ(back.width, 5);
  EXPECT_EQ(back.height, 3);
  EXPECT_EQ(back.bytes, rgba);
}

}  // namespace
}  // namespace envmap::rgbd_test

// Texels as GPUs hold them, against values worked out by hand.
#include "envmap/io/texels/texels.h"

#include <gtest/gtest.h>
#include <half.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <random>

namespace envmap::texels_test {
namespace {

std::uint32_t word(const Colour& c) {
  std::uint32_t packed = 0;
  encode(Texels::rgb9e5, std::span(&c, 1), std::as_writable_bytes(std::span(&packed, 1)));
  return packed;
}

Colour colour(Texels texels, std::uint32_t packed) {
  Colour c;
  decode(texels, std::as_bytes(std::span(&packed, 1)), std::span(&c, 1));
  return c;
}

// OpenGL 4.6, 8.5.2: mantissas in bits 0, 9 and 18, exponent from bit 27; value = mantissa x 2^(exponent - 15 - 9).
TEST(Texels, SharedExponentOfKnownValues) {
  EXPECT_EQ(word({1, 1, 1}), 0x84020100U);
  EXPECT_EQ(word({0, 0, 0}), 0U);
  EXPECT_EQ(word({65408, 0, 0}), 31U << 27 | 511U);
  EXPECT_EQ(word({0, std::ldexp(1.0F, -24), 0}), 1U << 9);
  EXPECT_EQ(word({1.9999F, 0, 0}), 17U << 27 | 256U);  // 512 after rounding, so the exponent goes up.
  EXPECT_EQ(colour(Texels::rgb9e5, 0x84020100U), Colour(1));
  EXPECT_EQ(colour(Texels::rgb9e5, 31U << 27 | 511U << 18), Colour(0, 0, 65408));
}

TEST(Texels, SharedExponentRoundsToNearest) {
  std::mt19937 random(1);
  for (int k = 0; k < 20000; ++k) {
    const float scale = std::ldexp(1.0F, int(random() % 38) - 22);
    const auto value = [&] { return std::min(65408.0F, scale * float(random() % 100001) / 100000); };
    const Colour c(value(), value(), value()), back = colour(Texels::rgb9e5, word(c));
    const float most = std::max({c.x, c.y, c.z}), step = std::max(std::ldexp(1.0F, -24), most / 256);
    for (int i = 0; i < 3; ++i) EXPECT_LE(std::abs(back[i] - c[i]), 0.5F * step) << c.x << " " << c.y << " " << c.z;
  }
}

TEST(Texels, SmallFloatsOfKnownValues) {
  EXPECT_EQ(colour(Texels::rg11b10f, 15U << 6 | (15U << 6) << 11 | (15U << 5) << 22), Colour(1));
  EXPECT_EQ(colour(Texels::rg11b10f, (30U << 6 | 63U)), Colour(65024, 0, 0));          // The largest of 11 bits.
  EXPECT_EQ(colour(Texels::rg11b10f, 1U << 22), Colour(0, 0, std::ldexp(1.0F, -19)));  // The smallest of 10.
  EXPECT_TRUE(std::isinf(colour(Texels::rg11b10f, 31U << 6).x));
}

// Against Imath: all halves, the floats at and beside the middle between two of them, and others at random.
TEST(Half, IsImaths) {
  std::vector<float> floats;
  for (std::uint32_t bits = 0; bits < 65536; ++bits) {
    const std::uint16_t here[] = {std::uint16_t(bits)};
    float value[1];
    from_half(here, value);
    const half theirs(half::FromBits, here[0]);
    if (std::isnan(value[0])) {
      EXPECT_TRUE(theirs.isNan()) << bits;
      continue;
    }
    EXPECT_EQ(value[0], float{theirs}) << bits;
    const half next(half::FromBits, std::uint16_t(bits + 1));
    const float middle = next.isFinite() ? 0.5F * (value[0] + float{next}) : value[0] < 0 ? -65520.0F : 65520.0F;
    for (const float x : {value[0], middle, std::nextafter(middle, -1e30F), std::nextafter(middle, 1e30F)})
      floats.push_back(x);
  }
  std::mt19937 random(1);
  for (int k = 0; k < 200000; ++k) floats.push_back(std::bit_cast<float>(std::uint32_t(random())));
  std::vector<std::uint16_t> halves(floats.size());
  to_half(floats, halves);
  for (std::size_t k = 0; k < floats.size(); ++k) {
    if (std::isnan(floats[k]))
      EXPECT_TRUE(half(half::FromBits, halves[k]).isNan());
    else
      EXPECT_EQ(halves[k], half(floats[k]).bits()) << floats[k];
  }
}

TEST(Texels, AlphaIsOneAndSeen) {
  const Colour c(0.25F, 2, 1000);
  for (const Texels t : {Texels::rgba16f, Texels::rgba32f}) {
    std::array<std::byte, 16> bytes{};
    const auto used = std::span(bytes).first(std::size_t(format_of(t).bytes));
    encode(t, std::span(&c, 1), used);
    Colour back;
    EXPECT_TRUE(decode(t, used, std::span(&back, 1)));
    EXPECT_EQ(back, c);
    std::memset(used.data() + used.size() - used.size() / 4, 0, used.size() / 4);
    EXPECT_FALSE(decode(t, used, std::span(&back, 1)));
  }
}

}  // namespace
}  // namespace envmap::texels_test
